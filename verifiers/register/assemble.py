"""The approximation register (R68, R123): what a candidate simplifies, and by how much."""

from __future__ import annotations

import math

from ...worlds.candidate import Candidate
from ...worlds.spec import Fastened, WorldSpec
from ..categories.registry import JUDGES
from ..land.ground_stems import plant_lines
from ..scene.hidden import hidden_lines
from ..scene.initial_state import start_lines
from ..scene.settled import settled_lines
from ..shots.plan import unseen_text
from ..story.branches import branch_lines
from ..support.anchored import anchor_lines
from ..support.held import afloat_lines
from ..support.lowest import ground_lines
from ..things.sizes import variant_lines
from .apart import apart_lines
from .fields import field_lines
from .initial import initial_lines
from .joints import joint_lines
from .scene import scene_lines
from .surfaces import surface_lines

__all__ = ["approximations"]


def _declared(spec: WorldSpec) -> list[dict[str, str]]:
    """Lines of what the specification declares: beats that no camera shows, intended overlaps; bounds: `register/scene.py`."""
    found = []
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


def approximations(candidate: Candidate) -> list[dict[str, str]]:
    """The approximation register (R68, R123): what the candidate simplifies, and by how much."""
    spec = candidate.spec
    found = (
        scene_lines(candidate)
        + _declared(spec)
        + joint_lines(spec)
        + branch_lines(candidate)
        + initial_lines(candidate)
        + hidden_lines(candidate)
        + variant_lines(candidate)
        + start_lines(candidate)
        + settled_lines(candidate)
    )
    for judge in JUDGES.values():
        found += judge.lines(candidate)
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
    found += afloat_lines(spec) + ground_lines(candidate) + anchor_lines(candidate)
    for name, entity in spec.entities.items():
        if entity.motion == "kinematic":
            found.append(
                {
                    "what": f"{name!r} follows an authored path",
                    "effect": "omitted reaction: nothing it touches moves it, and nothing has to hold it",
                }
            )
    found += surface_lines(candidate)
    owners = {beat.owner for beat in spec.story.beats.values()}
    for name, driver in spec.simulation.drivers.items():
        silent = "" if name in owners else "; no beat is owned by it: rows `causal:untold` tell which come without it"
        found.append(
            {
                "what": f"authored driver {name!r} ({driver.kind})",
                "effect": f"motion or force put in by hand, counted as driver work{silent}",
            }
        )
    found += field_lines(spec) + apart_lines(spec)
    for name, coupling in spec.simulation.couplings.items():
        if coupling.direction == "one_way":
            found.append(
                {"what": f"one-way coupling {name!r}", "effect": f"no reaction of {coupling.target} on {coupling.source}"}
            )
    return found
