"""Seeded defects of loose matter at frame 0: water that hangs in the air, and water that lies, comes in or is told to fall."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np

from ...verifiers.support.bounds import HANGING_SHARE, LOOSE_REACH
from ...worlds.predicates import BodyEvent
from ...worlds.spec import Beat
from ..worlds import small_worlds as sw
from ..worlds.liquid_worlds import Flow, stream
from . import _liquid_scenes as scenes
from ._liquid_scenes import SPACING
from ._support_worlds import RNG
from .cases import Mechanism, World

__all__ = ["LOOSE_MECHANISMS"]

REACH = LOOSE_REACH * SPACING
"""Height above a floor up to which water lies on it [m]."""


def _block(m: float, rng: RNG) -> Flow:
    """Water whose underside is `m` [m] above the ground, in free fall."""
    size = tuple(SPACING * float(n) for n in rng.integers(4, 8, 3))
    return scenes.block(size, (0.0, 0.0, size[2] / 2 + m), frames=4)


def _lifted(flow: Flow, share: float) -> Flow:
    """A copy in which the last `share` of the particles hang together 0.8 m higher."""
    rows = np.arange(len(flow.position[0]))[-max(1, round(share * len(flow.position[0]))) :]
    made = flow.edited()
    for points in made.position:
        points[rows, 2] += 0.8
    return made


def _hanging_water(folder: Path, m: float, rng: RNG) -> World:
    return World(_block(m, rng).candidate(folder), ("pool",))


def _hanging_part(folder: Path, m: float, rng: RNG) -> World:
    return World(_lifted(scenes.pool(rng, frames=4), m).candidate(folder), ("pool",))


def _untold(folder: Path, m: float, rng: RNG) -> World:
    """A beat speaks of the ground, which stays where it is."""
    return World(_told_by("ground", _block(m, rng)).candidate(folder), ("pool",))


def _told_by(subject: str, flow: Flow) -> Flow:
    last = flow.frames - 1
    beat = Beat(
        text="It falls.", owner="water", subject=subject, frames=(0, last), predicate=BodyEvent(kind="falls", entity=subject)
    )
    story = flow.spec.story.model_copy(update={"beats": {"fall": beat}})
    return flow.edited(spec=flow.spec.model_copy(update={"story": story}))


def _at_a_wall(folder: Path, m: float, rng: RNG, *, ledge: bool = False) -> World:
    """Water whose underside is `m` [m] above the ground and whose side touches a wall, with a ledge of the wall under it or without."""
    size = tuple(SPACING * float(n) for n in rng.integers(4, 8, 3))
    thick = float(rng.uniform(0.02, 0.1))
    beside = {"wall": sw.box(thick, 0.6, 2.0, at=(-0.5 * (size[0] + thick), 0.0, 1.0))}
    if ledge:
        beside["ledge"] = sw.box(size[0], size[1], 0.02, at=(0.0, 0.0, m - 0.01))
    flow = scenes.block(size, (0.0, 0.0, size[2] / 2 + m), frames=4, beside=beside)
    return World(flow.candidate(folder), () if ledge else ("pool",))


def _lying(folder: Path, m: float, rng: RNG) -> World:
    return World(_block(m, rng).candidate(folder))


def _drops(folder: Path, m: float, rng: RNG) -> World:
    return World(_lifted(scenes.pool(rng, frames=4), m).candidate(folder))


def _told(folder: Path, m: float, rng: RNG) -> World:
    return World(_told_by("pool", _block(m, rng)).candidate(folder))


def _fed(folder: Path, m: float, rng: RNG) -> World:
    """Under a tap that is `m` [m] above the ground, and open."""
    return World(stream(height=m, frames=4).candidate(folder))


LOOSE_MECHANISMS = (
    Mechanism("hanging-water", "water above the ground, and no beat tells of its fall", True, _hanging_water, 1.05 * REACH, 1.0, "m", REACH),
    Mechanism("hanging-part", "a share of the water in a tank hangs over it", True, _hanging_part, 0.012, 0.6, "1", HANGING_SHARE),
    Mechanism("hanging-untold", "the same, and the only beat tells of the ground", True, _untold, 1.05 * REACH, 1.0, "m", REACH),
    Mechanism("hanging-at-a-wall", "water above the ground that touches a wall from the side", True, _at_a_wall, 1.5 * REACH, 1.0, "m", REACH),
    Mechanism("on-a-ledge", "water above the ground, beside a wall and on its ledge", False, partial(_at_a_wall, ledge=True), 1.5 * REACH, 1.0, "m"),
    Mechanism("lying-water", "water that lies on the ground", False, _lying, 1e-3, 0.4 * REACH, "m"),
    Mechanism("drops", "drops over the water in a tank", False, _drops, 1e-3, 0.95 * HANGING_SHARE, "1"),
    Mechanism("told-fall", "water in the air whose fall a beat tells", False, _told, 1.05 * REACH, 1.0, "m"),
    Mechanism("under-a-tap", "water in the air under an open tap", False, _fed, 0.3, 1.0, "m"),
)  # fmt: skip
