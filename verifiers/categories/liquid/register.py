"""Lines of the approximation register about liquids (R68)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ....physics.capillarity import is_felt
from ....worlds.categories.liquid.facts import spacing_of
from ....worlds.errors import EvidenceError
from ....worlds.instances import coupled_groups
from ....worlds.spec import LiquidPhysics

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.spec import WorldSpec

__all__ = ["liquid_lines"]

MENDED = 0.02
"""Compression that the second solve of the particle engine takes back in one step, as a share of the volume, at most."""
MEASURED_EVERY = 5
"""Steps after which that engine looks how particles are packed."""
FULL = (0.9, 1.02)
"""Within which it takes what it finds, in fills of a lattice."""
WETTED = 0.1
"""[cells] The grid engine gives gaps under free bodies at least this width."""
KEPT_OUT = 0.25
"""[spacings] Nearer than this it lets no particle to a surface."""
SKIN = 0.05
"""[cells] The same of the grid engine."""


def liquid_lines(candidate: Candidate) -> list[dict[str, str]]:
    """Lines of every liquid: its resolution, and bodies that it does not push."""
    spec = candidate.spec
    found: list[dict[str, str]] = []
    for name, instance in spec.simulation.liquid.items():
        spacing = spacing_of(spec, name)
        kind = "particles" if instance.engine == "dfsph" else "cells"
        found.append(
            {
                "what": f"{kind} of {spacing:g} m for the liquid {name!r}",
                "effect": f"films, jets and gaps thinner than about {spacing:g} m are not resolved"
                + ("; what lies closely on something is not lifted there" if instance.engine == "dfsph" else ""),
            }
        )
        found.append(
            {
                "what": f"the drawn surface of {name!r} is moved by up to {0.15 * spacing:g} m so that it holds the particles' volume",
                "effect": "where particles lie unevenly the level is right and single ripples are not",
            }
        )
        found += _particles(candidate, name, spacing) if instance.engine == "dfsph" else _grid(candidate, name, spacing)
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


def _particles(candidate: Candidate, name: str, spacing: float) -> list[dict[str, str]]:
    """Lines about what the particle engine adds and leaves out by its method."""
    return [
        {
            "what": f"numerical dissipation of motion of {name!r} smaller than a particle's surroundings, about {2 * spacing:g} m",
            "effect": f"eddies and ripples of that size die out; waves in water {10 * spacing:g} m deep lose some two fifths of their height in three periods",
        },
        {
            "what": f"walls bear particles of {name!r} beside them along themselves too, at most 0.15 of the outermost ones' weight",
            "effect": "floor and sides of one tank share its weight otherwise than they should; their sum is exact",
        },
        {
            "what": f"a second solve moves particles of {name!r} apart without speed, by at most {MENDED:.0%} of compression in a step",
            "effect": f"ways that no momentum explains; {_compressed(candidate, name)}",
        },
        {
            "what": f"what counts as full of {name!r} is measured anew every {MEASURED_EVERY} steps, deep in the liquid",
            "effect": f"the same mass may take other room, by {FULL[0]:g} to {FULL[1]:g} of what a lattice of it takes",
        },
        {
            "what": f"particles of {name!r} are kept {KEPT_OUT * spacing:.2g} m from surfaces: of their velocity, what leads nearer is taken away",
            "effect": "narrower joints hold the liquid, nothing lifts a body that stands flat from below; the impulse is booked to the body",
        },
    ]


def _grid(candidate: Candidate, name: str, spacing: float) -> list[dict[str, str]]:
    """Lines about moves of particles by the grid engine that no law of motion explains."""
    settings = candidate.spec.simulation.liquid[name].settings
    affine = getattr(settings, "transfer", "flip") == "apic"
    ratio = 0.0 if affine else float(getattr(settings, "flip_ratio", 1.0))
    share = float(getattr(settings, "volume_correction", 0.0))
    how = (
        "all of the particles' velocity is the grid's, and how that changes across a cell,"
        if affine
        else f"{1 - ratio:.2%} of the particles' velocity is the grid's"
    )
    found = [
        {
            "what": f"numerical dissipation of {name!r}: {how} in every step",
            "effect": f"what is finer than two cells, {2 * spacing:g} m, loses "
            + ("all its own motion in a step" if affine else f"{1 - ratio:.2%} of its own speed in a step"),
        },
        {
            "what": f"particles of {name!r} that stand in solids, or nearer than {SKIN * spacing:.2g} m, are put outside",
            "effect": "ways that no momentum explains; drops lose the speed that leads into the solid",
        },
    ]
    if any(e.motion == "dynamic" and e.physics.shape == "solid" for e in candidate.spec.entities.values()):
        found.append(
            {
                "what": f"gaps thinner than a cell between a free body and what it lies on count as wetted by {name!r}, and as {WETTED * spacing:.2g} m wide or more",
                "effect": "a body sealed to its bed is lifted like one over a gap, and let go sooner; no liquid passes such a gap into air",
            }
        )
    if share > 0:
        found.append(
            {
                "what": f"particles of {name!r} are moved apart without speed, by {share:.0%} of the compression in a step",
                "effect": f"ways that no momentum explains; {_compressed(candidate, name)}",
            }
        )
    return found


def _compressed(candidate: Candidate, name: str) -> str:
    """Sentence about the recorded compression that is left; says so where it is not known."""
    cache = candidate.liquid_caches.get(name)
    if cache is None:
        return "how much compression is left is known after a probe"
    try:
        mean, most = (np.asarray(cache.series(f"record/density_error_{n}"), dtype=np.float64) for n in ("mean", "max"))
    except EvidenceError as error:
        return f"how much compression is left is not known: {error}"
    frame = int(mean.argmax()) if np.isfinite(mean).all() else 0
    return f"what is left is {mean[frame]:.2g} of the volume in the mean at most, at frame {frame}, and {most.max():.2g} anywhere"


def _tension(spec: WorldSpec, name: str, spacing: float) -> dict[str, str]:
    """Line about how the surface tension of a liquid is simulated, or that it is not."""
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
