"""Channels of rigid instances with breakable members."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from ...channel import Channel, quantity

if TYPE_CHECKING:
    from ...spec import WorldSpec

__all__ = ["CHANNELS", "DIMENSIONS", "writers"]

DIMENSIONS: Mapping[str, str] = {
    "bonds": "bonds of the entities of `CacheIndex.breakables`, one after the other",
    "breaks": "bonds that broke in the frame",
    "cases": "load cases under which bonds broke in the frame",
    "case loads": "loads of all cases, one case after the other",
    "loaded pieces": "pieces that contacts pushed in the frame, counted through all `breakables`",
}

CHANNELS: Mapping[str, tuple[Channel, ...]] = {
    "fracture": (
        Channel("bond/broken", "u1", ("bonds",), "1", "the bond is broken"),
        Channel("bond/stress", "f4", ("bonds",), "1", "largest stress over strength found in the frame; 0: no load was solved for", "max", "+"),
        Channel("break/time", "f8", ("breaks",), "s", "end of the step in which the bond broke"),
        Channel("break/bond", "i4", ("breaks",), "1", "which bond", sign="+"),
        Channel("break/point", "f8", ("breaks", 3), "m", "middle of its face, world"),
        Channel("break/cause", "i4", ("breaks",), "1", "index into `CacheIndex.colliders` of what loaded the cluster most; -1: gravity or its own motion"),
        Channel("break/ratio", "f8", ("breaks",), "1", "stress over strength; with a toughness, no more than the root of energy over toughness", "max", "+"),
        Channel("break/energy", "f8", ("breaks",), "J", "elastic energy of the bond when the load reached its strength", "sum", "+"),
        Channel("break/case", "i4", ("breaks",), "1", "load case", sign="+"),
        Channel("case/count", "i4", ("cases",), "1", "number of loads of each case", "sum", "+"),
        Channel("case/spin", "f8", ("cases", 3), "rad/s", "angular velocity of the cluster, entity's frame; 0 where the world holds it"),
        Channel("case/piece", "i4", ("case loads",), "1", "loaded piece", sign="+"),
        Channel("case/load", "f8", ("case loads", 12), "N, N m", "smoothed contact force and torque about its centre, entity's frame: the lasting part, then the sudden rest"),
        Channel("load/piece", "i4", ("loaded pieces",), "1", "pieces that contacts pushed in the frame", sign="+"),
        Channel("load/impulse", "f8", ("loaded pieces", 6), "N s, N m s", "summed contact impulse on each, about its centre, world", "sum"),
        quantity("fracture_energy", "J", "of the bonds that broke since frame 0", sign="+"),
    ),
}  # fmt: skip
"""By kind of writer."""


def writers(spec: WorldSpec, name: str) -> Iterator[str]:
    """Further kind of writer: a rigid instance with a breakable member."""
    members = [m for m in spec.simulation.solvers[name].members if m in spec.entities]
    if name in spec.simulation.rigid and any(spec.entities[m].breakable is not None for m in members):
        yield "fracture"
