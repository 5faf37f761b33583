"""Seeded defects of the light of a film, on painted plates: black, white, painted like what is behind, lost in noise, of another look."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ...verifiers.shots.bounds import JUST_NOTICEABLE, SEEN_NOISE, SEEN_SHARE
from ...verifiers.shots.difference import lab
from ...worlds.plates import Plates
from ...worlds.spec import Box
from ..worlds.forged_plates import Paint, encoded, forge_plates
from ._shot_worlds import RNG, Rig
from .cases import Mechanism, World

__all__ = ["LIGHT"]

CODES = 1.25
"""Just over and just under a bound, where colours are rounded to 8 bits: half a step of two pictures is up to 0.5 of lightness."""
OVER = 1.05


def _plated(folder: Path, rng: RNG, paint: Paint, *culprits: str, alter: Callable[[Plates], Plates] | None = None) -> World:
    """A box in plain view that moves, and plates of it."""
    rig = Rig(rng)
    place = rig.spot(float(rng.uniform(-0.3, 0.3)), float(rng.uniform(-0.3, 0.3)))
    path = rig.still(place)
    path[12:] += 0.01 * rig.axes[1]
    rig.add("subject", Box(size=(0.1 * rig.distance,) * 3), place, path=path)
    rig.beat("event", "subject")
    rig.shot("a", covers=["event"])
    made = rig.world(folder, *culprits)
    forge_plates(made.candidate, paint, rng, alter=alter)
    return made


def _grey(value: float) -> tuple[float, float, float]:
    return value, value, value


def _lighter(value: float, by: float) -> float:
    """Luminance whose lightness differs from that of another by so much (CIELAB), towards the middle."""
    lightness = 116.0 * float(np.cbrt(value)) - 16.0
    lightness += by if lightness < 60.0 else -by
    return ((lightness + 16.0) / 116.0) ** 3


def _dark(folder: Path, rng: RNG, times: float, *culprits: str) -> World:
    """Exposed so that subject and background differ by so many times what an eye notices."""
    behind, subject = float(rng.uniform(0.02, 0.1)), float(rng.uniform(0.2, 0.5))
    stops = -math.log2(903.3 * (subject - behind) / (times * JUST_NOTICEABLE))
    return _plated(folder, rng, Paint(_grey(subject), _grey(behind), stops=stops), *culprits)


def _black(folder: Path, m: float, rng: RNG) -> World:
    """So dark that an eye notices nothing."""
    return _dark(folder, rng, 1.0 / m, "shots:seen")


def _dim(folder: Path, m: float, rng: RNG) -> World:
    return _dark(folder, rng, m)


def _bright(folder: Path, rng: RNG, brightest: float, darkest: float, *culprits: str) -> World:
    """Exposed so that the lighter of subject and background has so many times the light of white, and the other its own."""
    levels = [brightest, darkest]
    rng.shuffle(levels)
    return _plated(folder, rng, Paint(_grey(levels[0] / 8), _grey(levels[1] / 8), stops=3.0), *culprits)


def _white(folder: Path, m: float, rng: RNG) -> World:
    """Both are at least as bright as white."""
    return _bright(folder, rng, m * float(rng.uniform(1, 4)), m, "shots:seen")


def _pale(folder: Path, m: float, rng: RNG) -> World:
    return _bright(folder, rng, float(rng.uniform(1, 4)), 1.0 / m)


def _coloured(folder: Path, rng: RNG, times: float, *culprits: str) -> World:
    """Two greys that differ by so many times what an eye notices."""
    behind = float(rng.uniform(0.05, 0.6))
    return _plated(folder, rng, Paint(_grey(_lighter(behind, times * JUST_NOTICEABLE)), _grey(behind)), *culprits)


def _painted(folder: Path, m: float, rng: RNG) -> World:
    """Painted like what is behind it."""
    return _coloured(folder, rng, 1.0 / m, "shots:seen")


def _tinted(folder: Path, m: float, rng: RNG) -> World:
    return _coloured(folder, rng, m)


def _grainy(folder: Path, rng: RNG, times: float, *culprits: str) -> World:
    """A difference of so many times three times the noise."""
    behind, noise = float(rng.uniform(0.1, 0.3)), float(rng.uniform(3, 4))
    pixels = np.broadcast_to(encoded(np.array(_grey(behind))), (4, 4000, 3)) + rng.normal(0, noise, (4, 4000, 3))
    colours = lab(np.clip(np.round(pixels), 0, 255).astype(np.uint8))
    rough = float(np.sqrt(((colours[:2].mean(0) - colours[2:].mean(0)) ** 2).sum(-1).mean()))
    subject = _lighter(behind, times * SEEN_NOISE * rough)
    return _plated(folder, rng, Paint(_grey(subject), _grey(behind), noise=noise), *culprits)


def _lost(folder: Path, m: float, rng: RNG) -> World:
    """Differs by less than noise does."""
    return _grainy(folder, rng, 1.0 / m, "shots:seen")


def _clear(folder: Path, m: float, rng: RNG) -> World:
    return _grainy(folder, rng, m)


def _partly(folder: Path, m: float, rng: RNG) -> World:
    """Too small a part of it stands out."""
    return _plated(folder, rng, Paint(shows=SEEN_SHARE / m), "shots:seen")


def _enough(folder: Path, m: float, rng: RNG) -> World:
    return _plated(folder, rng, Paint(shows=SEEN_SHARE * m))


def _unproven(folder: Path, m: float, rng: RNG) -> World:
    """Plates of another look or bake, altered ones, or none of the subject."""
    changes: tuple[Callable[[Plates], Plates], ...] = (
        lambda p: dataclasses.replace(p, recipe="another"),
        lambda p: dataclasses.replace(p, cache="another"),
        lambda p: dataclasses.replace(p, digests=tuple("0" * 64 for _ in p.digests)),
        lambda p: dataclasses.replace(p, views=(), digests=(), left={"subject": "no time"}),
    )
    return _plated(folder, rng, Paint(), "shots:seen", alter=changes[min(int(m), len(changes)) - 1])


LIGHT: tuple[Mechanism, ...] = (
    Mechanism("black", "so dark that an eye notices nothing", True, _black, CODES, 50, "times too little", 1.0),
    Mechanism("white", "subject and background brighter than white", True, _white, OVER, 50, "of white", 1.0),
    Mechanism("painted", "the colour of what is behind it", True, _painted, CODES, 50, "times too little", 1.0),
    Mechanism("lost-in-noise", "differs by less than three times the noise", True, _lost, 1.5, 20, "times too little", 1.0),
    Mechanism("partly", "too little of it stands out", True, _partly, OVER, 50, "times too little", 1.0),
    Mechanism("unproven", "plates stale, altered or missing", True, _unproven, 1, 4.99, "variant", None, (1, 2, 3, 4), ("unverified",)),
    Mechanism("dim", "dark, but an eye notices it", False, _dim, CODES, 20, "times enough"),
    Mechanism("pale", "one of both is white, the other nearly", False, _pale, 1.15, 8, "times darker"),
    Mechanism("tinted", "nearly the colour of what is behind it", False, _tinted, CODES, 12, "times enough"),
    Mechanism("noisy", "noise, but less than a third of the difference", False, _clear, 1.3, 3, "times enough"),
    Mechanism("enough", "a part of it stands out", False, _enough, OVER, 3.8, "times enough"),
)  # fmt: skip
