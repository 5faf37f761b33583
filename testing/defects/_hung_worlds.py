"""Seeded defects of static things that hang beside others: a slab at a thin pole, and what holds one."""

from __future__ import annotations

from pathlib import Path

from ...worlds.spec import Box, Fastened
from ._support_worlds import RNG, Scene
from .cases import Mechanism, World

__all__ = ["HUNG_MECHANISMS"]

NARROW = 2e-4
"""Gap over which the slab and the pole still touch [m]."""


def _beside_a_pole(m: float, rng: RNG, *, wide: float = 0.02, founded: bool = True) -> Scene:
    """A slab of m metres beside a pole, within what counts as contact; wood of 5 cm."""
    scene = Scene(rng)
    scene.add("pole", Box(size=(0.02, wide, 3.0)), at=(0, 0, 1.5))
    if founded:
        scene.relations["set"] = Fastened(a="floor", b="pole", max_depth=1e-3, reason="the pole is set into the floor")
    air = float(rng.uniform(0.0, 0.9 * NARROW))
    scene.add("slab", Box(size=(m, m, 0.05)), at=(0.01 + air + m / 2, 0, float(rng.uniform(0.5, 2.5))))
    return scene


def _slab_at_a_pole(folder: Path, m: float, rng: RNG) -> World:
    return _beside_a_pole(m, rng).world(folder, "slab", still=True)


def _slab_that_tips_its_pole(folder: Path, m: float, rng: RNG) -> World:
    scene = _beside_a_pole(m, rng, wide=0.5, founded=False)
    return scene.world(folder, "pole", "slab", still=True)


def _slab_at_a_wall(folder: Path, m: float, rng: RNG) -> World:
    return _beside_a_pole(m, rng, wide=m).world(folder, still=True)


def _slab_that_is_welded(folder: Path, m: float, rng: RNG) -> World:
    scene = _beside_a_pole(m, rng)
    scene.relations["weld"] = Fastened(a="pole", b="slab", max_depth=1e-3, reason="the slab is welded to the pole")
    return scene.world(folder, still=True)


def _slab_between_poles(folder: Path, m: float, rng: RNG) -> World:
    scene = _beside_a_pole(m, rng)
    at = scene.entities["slab"][1][0] + m / 2 + 0.01
    scene.add("other", Box(size=(0.02, 0.02, 3.0)), at=(at, 0, 1.5))
    scene.relations["too"] = Fastened(a="floor", b="other", max_depth=1e-3, reason="the pole is set into the floor")
    return scene.world(folder, still=True)


HUNG_MECHANISMS = (
    Mechanism("slab-at-a-pole", "static, its edge meets a thin pole from the side", True, _slab_at_a_pole, 0.8, 3.0, "m"),
    Mechanism("slab-tips-its-pole", "static, and tips with what it hangs on", True, _slab_that_tips_its_pole, 0.4, 1.0, "m"),
    Mechanism("slab-at-a-wall", "static, its whole edge meets a wall", False, _slab_at_a_wall, 0.3, 1.5, "m"),
    Mechanism("slab-welded", "at a thin pole, and a relation says that it is welded", False, _slab_that_is_welded, 0.8, 3.0, "m"),
    Mechanism("slab-between-poles", "two poles hold its two ends", False, _slab_between_poles, 0.4, 1.0, "m"),
)
"""Mechanisms of the suite `support` about static things that hang beside others."""
