"""The approximation register (R68, R123): what a candidate simplifies, and by how much."""

from __future__ import annotations

import math

from ..worlds.candidate import Candidate
from ..worlds.capillarity import is_felt
from ..worlds.instances import coupled_groups
from ..worlds.liquids import spacing_of
from ..worlds.spec import Fastened, LiquidPhysics, WorldSpec
from .apart import apart_lines
from .cloth_register import cloth_lines
from .elastic_register import elastic_lines
from .field_ledger import field_lines
from .fracture_register import fracture_lines
from .ground_stems import plant_lines
from .held import afloat_lines
from .initial_state import start_lines
from .joined import anchor_lines
from .particle_lines import particle_lines
from .rigid_register import rigid_lines
from .scene_register import scene_lines
from .shot_rows import unseen_text

__all__ = ["approximations"]


def _declared(spec: WorldSpec) -> list[dict[str, str]]:
    """What the specification itself departs by: bodies made one, beats that no camera shows, overlaps; see `scene_register.py` for bounds."""
    found = []
    for name, joint in spec.simulation.joints.items():
        if joint.kind == "weld":
            held = f"{joint.child!r} and {joint.parent!r}" if joint.parent else f"{joint.child!r} and the world"
            found.append({"what": f"weld {name!r}", "effect": f"{held} move as one body, however hard they are hit"})
    for name, beat in spec.story.beats.items():
        if beat.mandatory and not beat.observe:
            found.append(
                {"what": unseen_text(name, beat), "effect": "no picture is asked to show it: numbers alone tell that it happens"}
            )
    for relation in spec.graph.relations.values():
        if isinstance(relation, Fastened):
            small = min((relation.a, relation.b), key=lambda n: math.hypot(*spec.entities[n].dimensions.size))
            share = relation.max_depth / max(spec.entities[small].dimensions.size)
            found.append(
                {
                    "what": f"overlap of {relation.a!r} and {relation.b!r} declared intended: {relation.reason}",
                    "effect": f"their surfaces may overlap by {relation.max_depth:g} m, {share:.2g} of the length of {small!r}",
                }
            )
    return found


def _liquids(spec: WorldSpec) -> list[dict[str, str]]:
    """What liquids simplify: their resolution, and bodies that they do not push."""
    found = []
    for name, instance in spec.simulation.liquid.items():
        spacing = spacing_of(spec, name)
        kind = "particles" if instance.engine == "dfsph" else "cells"
        found.append(
            {
                "what": f"{kind} of {spacing:g} m for the liquid {name!r}",
                "effect": f"films, jets and gaps thinner than about {spacing:g} m are not resolved; what lies closely on something is not lifted there",
            }
        )
        found.append(
            {
                "what": f"the drawn surface of {name!r} is moved by up to {0.15 * spacing:g} m so that it holds the particles' volume",
                "effect": "where particles lie unevenly the level is right and single ripples are not",
            }
        )
        if instance.engine == "dfsph":
            found += _particles(name, spacing)
        found.append(_tension(spec, name, spacing))
        for member in instance.members:
            physics = spec.entities[member].physics
            for key, current in physics.currents.items() if isinstance(physics, LiquidPhysics) else ():
                found.append(
                    {
                        "what": f"current {key!r} of {member!r} runs at frame 0 with {min(current.speeds):.3g} to {max(current.speeds):.3g} m/s",
                        "effect": "the same velocity all over each cross section, until bed and banks have slowed the liquid near them",
                    }
                )
        drying = {spec.materials[spec.entities[m].material].appearance.drying for m in instance.members}
        found.append(
            {
                "what": f"solids that {name!r} wetted dry by exp(-t / {', '.join(f'{d:g}' for d in sorted(drying))} s)",
                "effect": "seen only: nothing evaporates, soaks in or runs off; films split in halves where surfaces meet, with places half a spacing apart",
            }
        )
        coupled = {s for g in coupled_groups(spec) if name in g for s in g}
        free = [r for r, s in spec.simulation.rigid.items() if any(spec.entities[m].motion == "dynamic" for m in s.members)]
        for rigid in [r for r in free if r not in coupled]:
            found.append(
                {
                    "what": f"the liquid {name!r} is pushed by bodies of {rigid!r} and does not push them",
                    "effect": "omitted reaction: nothing floats or is carried",
                }
            )
    return found


def _particles(name: str, spacing: float) -> list[dict[str, str]]:
    """What the particle engine adds and leaves out by its method."""
    return [
        {
            "what": f"numerical dissipation of motion of {name!r} smaller than a particle's surroundings, about {2 * spacing:g} m",
            "effect": f"eddies and ripples of that size die out; waves in water {10 * spacing:g} m deep lose some two fifths of their height in three periods",
        },
        {
            "what": f"walls bear particles of {name!r} beside them along themselves too, at most 0.15 of the outermost ones' weight",
            "effect": "floor and sides of one tank share its weight otherwise than they should; their sum is exact",
        },
    ]


def _tension(spec: WorldSpec, name: str, spacing: float) -> dict[str, str]:
    """What becomes of the surface tension of a liquid."""
    instance = spec.simulation.liquid[name]
    if instance.engine == "flip":
        return {
            "what": f"surface tension of the liquid {name!r} not simulated",
            "effect": "drops, menisci and films do not hold together",
        }
    gravity = math.hypot(*spec.simulation.gravity)
    members = [spec.entities[m] for m in instance.members]
    felt = any(
        isinstance(m.physics, LiquidPhysics)
        and is_felt(m.physics.surface_tension, spec.materials[m.material].density, gravity, spacing)
        for m in members
    )
    if felt:
        return {
            "what": f"surface tension of the liquid {name!r} by attractions between its particles, over four spacings",
            "effect": f"right within about 10 % for drops from {5 * spacing:.2g} m radius on; every wall is met at about 90 to 105 degrees",
        }
    return {
        "what": f"surface tension of the liquid {name!r} not simulated: at {spacing:g} m gravity leaves nothing to it",
        "effect": "drops, menisci and films do not hold together",
    }


def approximations(candidate: Candidate) -> list[dict[str, str]]:
    """The approximation register (R68, R123): what the candidate simplifies, and by how much."""
    spec = candidate.spec
    found = scene_lines(candidate) + _declared(spec) + rigid_lines(spec) + start_lines(candidate)
    found += _liquids(spec)
    found += cloth_lines(spec)
    found += fracture_lines(candidate)
    found += elastic_lines(candidate)
    for name, terrain in spec.terrains.items():
        found.append(
            {
                "what": f"water of the landscape {name!r} is a surface to look at"
                + (", outside the domains of liquids" if spec.simulation.liquid else ""),
                "effect": "nothing floats, flows or gets wet in it",
            }
        )
        if terrain.vegetation is not None:
            found += plant_lines(spec, name)
    found += afloat_lines(spec) + anchor_lines(candidate)
    for name, entity in spec.entities.items():
        if entity.motion == "kinematic":
            found.append(
                {"what": f"{name!r} follows an authored path", "effect": "omitted reaction: nothing it touches moves it"}
            )
        for part_name, part in entity.parts.items():
            if not part.collides:
                found.append({"what": f"part {name}/{part_name} is drawn only", "effect": "other bodies pass through it"})
        for made in candidate.built[name].parts if name in candidate.built else ():
            if max(made.deviation) > 0:
                found.append(
                    {
                        "what": f"proxy collider of {name}/{made.part}",
                        "effect": f"collision surface up to {made.deviation[0]:.2g} m outside and {made.deviation[1]:.2g} m inside the visible one",
                    }
                )
    for name, driver in spec.simulation.drivers.items():
        found.append(
            {
                "what": f"authored driver {name!r} ({driver.kind})",
                "effect": "motion or force put in by hand, counted as driver work",
            }
        )
    found += field_lines(spec) + particle_lines(spec) + apart_lines(spec)
    for name, coupling in spec.simulation.couplings.items():
        if coupling.direction == "one_way":
            found.append(
                {"what": f"one-way coupling {name!r}", "effect": f"no reaction of {coupling.target} on {coupling.source}"}
            )
    return found
