"""Plain measures of what matter does: how much of an event of a liquid, grains, cloth, an elastic body, a gas or a body that breaks is a plain one (R154).

No motion of matter is forged. What its kinds read is particles, cells, vertices and bonds in the form of an engine, and one that is written down
to spill a twentieth of a vessel would give back the twentieth that was written. What can be forged is the number: by its definition an event
of matter begins at a threshold that is named, and a plain one is `PLAIN` times that, as of bodies (`bounds.WAY`). That its kind can come true at
all is shown on recorded motions, one for every kind (`tests/verifiers/claims/test_rivals_of_matter.py`).

- *shares* (vessels, tears, bends, breaks, floats ...): of the kind's threshold; where that would be more than all, the threshold itself.
- *amounts* in a region, through an opening, at a body: of what is less than a drip of all that there is, or of what eight particles hold.
- *soot*, *power*: of what counts as arrived, or as a fire. How near to a body: one spacing, or a cell.
- *heights* that a level, a heap or a plume may reach are the prompt's own reading of a place, as regions are: what the domain holds is none too high.

A bound in a field that is not here asks for more than its kind by itself, unless it is the field's default.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from ...worlds.spec import BoxRegion
from ..categories.bounds import FILL_SHARE, FLOW_PARTICLES, FLOW_SECONDS, LEAK_SHARE, OVERFLOW_SHARE, POUR_SHARE, SPREAD
from ..categories.cloth.bounds import TEAR_SHARE
from ..categories.elastic.bounds import BEND_SHARE, STRETCH_SHARE, TURNS
from ..categories.fracture.bounds import BREAK_SHARE, CRACK_SHARE
from ..categories.gas.bounds import ARRIVED, FIRE_OUT, FIRE_POWER
from ..categories.gas.frames import box_of
from ..categories.liquid.bounds import BOB_TURNS, FLOAT_CARRIED, SINK_WAY, SPLASH_HEIGHT, SPLASH_SPACINGS
from ..categories.particles.bounds import BURY_SHARE
from ..categories.registry import judge_of
from .bounds import PLAIN, PLAIN_CYCLES, PLAIN_OPENING, PLAIN_WAVE

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["plain_measures"]


def _plain(threshold: float) -> float:
    """Share that a plain event reaches: none is more than all, and all of it would be denied by a bound that little misses."""
    return PLAIN * threshold if PLAIN * threshold <= 1.0 else threshold


SHARES: Mapping[str, float] = {
    "pours": _plain(POUR_SHARE),
    "fills": _plain(FILL_SHARE),
    "overflows": _plain(OVERFLOW_SHARE),
    "leaks": _plain(LEAK_SHARE),
    "buries": _plain(BURY_SHARE),
    "floats": _plain(FLOAT_CARRIED),
    "goes_out": 1.0 - FIRE_OUT / PLAIN,
    "breaks": _plain(BREAK_SHARE),
    "cracks": _plain(CRACK_SHARE),
    "broken": _plain(CRACK_SHARE),
    "tears": PLAIN * TEAR_SHARE,
    "bends": PLAIN * BEND_SHARE,
    "stretches": PLAIN * STRETCH_SHARE,
    "wobbles": PLAIN * TURNS,
    "bobs": PLAIN * BOB_TURNS,
    "sinks": SINK_WAY,
    "splashes": PLAIN * SPLASH_HEIGHT,
    "spreads": 1.0 + PLAIN * (SPREAD - 1.0),
    "burns": PLAIN * FIRE_POWER,
    "heat_release": PLAIN * FIRE_POWER,
    "debris": PLAIN,
}
"""By kind, the `min` that a plain one reaches, in the kind's unit. `sinks`: no more than its own height, since no bottom is lower than it is."""


def plain_measures(candidate: Candidate, atom: Any) -> Mapping[str, float]:
    """By field of an atom, the measure that a plain event of its kind reaches, in the field's unit; empty of kinds that are not of matter.

    Raises:
        EvidenceError: nothing tells how much of the matter there is.
    """
    found = _MEASURES.get(atom.kind)
    if found is not None and atom.entity in candidate.spec.entities:
        return found(candidate, atom)
    return {"min": SHARES[atom.kind]} if atom.kind in SHARES else {}


def _volume(candidate: Candidate, entity: str) -> float:
    """Most of a liquid or of grains that is there at a frame [m^3]."""
    density = candidate.spec.materials[candidate.spec.entities[entity].material].density
    return float(judge_of(candidate.spec, entity).mass(candidate, entity).max()) / density


def _particle(candidate: Candidate, entity: str) -> float:
    """Volume of one particle [m^3]: the cube of a liquid's spacing, or a grain."""
    radius = getattr(candidate.spec.entities[entity].physics, "radius", None)
    return 4.0 / 3.0 * math.pi * float(radius) ** 3 if radius is not None else _spacing(candidate, entity) ** 3


def _spacing(candidate: Candidate, entity: str) -> float:
    """Distance between the particles of a liquid [m]."""
    physics: Any = candidate.spec.entities[entity].physics
    return float(physics.resolution)


def _in_region(candidate: Candidate, atom: Any) -> dict[str, float]:
    """More than a drip of all of it, and no more than the region holds."""
    most = PLAIN * OVERFLOW_SHARE * _volume(candidate, atom.entity)
    region = candidate.spec.graph.regions.get(atom.region or "")
    if isinstance(region, BoxRegion):
        most = min(most, math.prod(b - a for a, b in zip(region.min, region.max, strict=True)))
    if atom.kind == "particle_count_in":
        return {"min": max(PLAIN, most / _particle(candidate, atom.entity))}
    return {"min" if atom.kind != "liquid_arrives" else "min_volume": max(most, PLAIN * _particle(candidate, atom.entity))}


def _liquid_arrives(candidate: Candidate, atom: Any) -> dict[str, float]:
    return {**_in_region(candidate, atom), "within": _spacing(candidate, atom.entity)}


def _through(candidate: Candidate, atom: Any) -> dict[str, float]:
    """Volume of a few times as many particles as make a flow, or that at the pace of one."""
    few = PLAIN * FLOW_PARTICLES * _particle(candidate, atom.entity)
    return {"min": few / FLOW_SECONDS if atom.kind == "flows" or getattr(atom, "measure", "") == "rate" else few}


def _splash_height(candidate: Candidate, atom: Any) -> dict[str, float]:
    owner = candidate.spec.entities[atom.entity]
    top = owner.pose.position[2] + 0.5 * owner.dimensions.size[2]
    high = PLAIN * SPLASH_SPACINGS * _spacing(candidate, atom.entity)
    return {"min": high if atom.over is None else top + high - atom.over}


def _gas_arrives(candidate: Candidate, atom: Any) -> dict[str, float]:
    solver = next((n for n, s in candidate.spec.simulation.gas.items() if atom.entity in s.members), None)
    if solver is None:
        return {}
    box = box_of(candidate, solver)
    return {"min_density": PLAIN * ARRIVED * box.dark(atom.entity), "within": box.cell}


def _gas_clears(candidate: Candidate, atom: Any) -> dict[str, float]:
    return {"max_share": float(type(atom).model_fields["max_share"].default) / PLAIN}


def _torn(candidate: Candidate, atom: Any) -> dict[str, float]:
    return {"min": PLAIN * TEAR_SHARE * _side(candidate, atom.entity)}


def _side(candidate: Candidate, entity: str) -> float:
    """Side of a square as large as a sheet [m]."""
    size = sorted(candidate.spec.entities[entity].dimensions.size)
    return math.sqrt(size[1] * size[2])


def _flutters(candidate: Candidate, atom: Any) -> dict[str, float]:
    return {"min_amplitude": PLAIN_WAVE * _side(candidate, atom.entity), "min_cycles": PLAIN_CYCLES}


def _breach(candidate: Candidate, atom: Any) -> dict[str, float]:
    opening = PLAIN_OPENING * sorted(candidate.spec.entities[atom.entity].dimensions.size)[1]
    return {"min_width": opening, "min_height": opening}


def _debris(candidate: Candidate, atom: Any) -> dict[str, float]:
    return {"min": SHARES["debris"], "min_distance": PLAIN * float(type(atom).model_fields["min_distance"].default)}


def _height(candidate: Candidate, atom: Any) -> dict[str, float]:
    """Height of the domain's top, over the base from which it is told."""
    plan: Any = candidate.spec.simulation
    for instance in (*plan.liquid.values(), *plan.gas.values()):
        if atom.entity in instance.members:
            domain = instance.settings.domain
            return {"min": domain.center[2] + 0.5 * domain.size[2] - getattr(atom, "base", 0.0)}
    return {}


_MEASURES: Mapping[str, Callable[[Candidate, Any], Mapping[str, float]]] = {
    **dict.fromkeys(("liquid_volume_in", "particle_volume_in", "particle_count_in"), _in_region),
    "liquid_arrives": _liquid_arrives,
    **dict.fromkeys(("flows", "liquid_flux_through"), _through),
    "splash_height": _splash_height,
    "gas_arrives": _gas_arrives,
    "gas_clears": _gas_clears,
    "torn": _torn,
    "flutters": _flutters,
    "breach": _breach,
    "debris": _debris,
    **dict.fromkeys(("liquid_level_at", "plume_height"), _height),
}
"""By kind whose plain measure follows from the world."""
