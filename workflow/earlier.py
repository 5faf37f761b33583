"""Probes that a world's ledger tells of: whether there is motion of the present settings, and what is left of older ones."""

from __future__ import annotations

from typing import NamedTuple

from ..worlds.canonical import digest_of
from ..worlds.slices import motion_slice
from ..worlds.spec import WorldSpec
from .opened import OpenedWorld

__all__ = ["Probe", "has_motion", "latest_probe"]

LOOKED_AT = 20
"""Newest probes whose settings are compared with the present ones."""


class Probe(NamedTuple):
    """A probe whose frames are in the world's folder."""

    freeze: str
    revision: int


def _probes(world: OpenedWorld) -> list[Probe]:
    """Probes that are still there, newest first."""
    found = [Probe(str(f["freeze"]), int(f["revision"])) for f in world.ledger.freezes(LOOKED_AT)]
    return [p for p in found if (world.folder.candidate(p.freeze) / "probe").is_dir()]


def latest_probe(world: OpenedWorld) -> Probe | None:
    """The newest probe of any settings of this world."""
    return next(iter(_probes(world)), None)


def has_motion(world: OpenedWorld) -> bool:
    """True if a probe moved what the present specification says, told by the specifications alone: nothing is built."""
    wanted = digest_of(motion_slice(world.spec))
    for number in {p.revision for p in _probes(world)}:
        recorded = world.ledger.revision_spec(number)
        if recorded is not None and digest_of(motion_slice(WorldSpec.model_validate_json(recorded[0]))) == wanted:
            return True
    return False
