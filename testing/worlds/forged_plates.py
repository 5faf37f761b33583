"""Plates painted by hand: pictures whose light, colours and noise are known, for the rows that read plates."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...verifiers.shots.sight import Sight
from ...verifiers.shots.wanted import wanted
from ...worlds.arrays import F64, U8
from ...worlds.candidate import Candidate
from ...worlds.plates import SEEDS, Plate, Plates, plate_size, plates_folder
from ...worlds.provenance import recipes

__all__ = ["Paint", "encoded", "forge_plates"]


@dataclass(frozen=True)
class Paint:
    """Colours and light of a forged plate; both are linear, white is 1."""

    subject: tuple[float, float, float] = (0.5, 0.1, 0.05)
    behind: tuple[float, float, float] = (0.3, 0.3, 0.3)
    noise: float = 0.0
    """Standard deviation of the noise of one channel of one picture, in steps of 8 bits."""
    shows: float = 1.0
    """Share of the subject's pixels that are painted in its colour; the others look as what is behind it."""
    stops: float = 0.0
    """By which the picture is exposed above what the colours say."""
    light: tuple[float, float, float] = (1.0, 1.0, 1.0)
    """Colour of the light on all of it."""


def encoded(linear: F64) -> F64:
    """Linear sRGB as 8-bit values, not yet rounded (IEC 61966-2-1)."""
    x = np.clip(linear, 0.0, 1.0)
    return 255.0 * np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 1e-12) ** (1 / 2.4) - 0.055)


def forge_plates(
    candidate: Candidate, paint: Paint, rng: np.random.Generator, *, alter: Callable[[Plates], Plates] | None = None
) -> Plates:
    """Write all plates that a candidate needs, painted.

    Args:
        candidate: of the full stage.
        paint: how.
        rng: of the noise, and of which pixels show the subject.
        alter: changes what the index says.
    """
    sight, folder, size = Sight(candidate), plates_folder(candidate), plate_size(candidate.spec.look)
    made = Plates(recipes(candidate.spec)["seen"], candidate.digest, {"source": "painted"}, size, 1)
    made.write(folder)
    for view in wanted(candidate, sight).views:
        mask = sight.mask(view.subject, view.shot, view.frame, size).visible
        made = made.added(folder, view, _painted(mask, paint, rng))
    if alter is not None:
        made = alter(made)
        made.write(folder)
    return made


def _painted(mask: np.ndarray, paint: Paint, rng: np.random.Generator) -> Plate:
    places = np.flatnonzero(mask)
    shown = rng.permutation(places)[: int(paint.shows * len(places))]
    light = np.exp2(paint.stops) * np.array(paint.light)
    bare = np.broadcast_to(encoded(light * np.array(paint.behind)), (*mask.shape, 3)).copy()
    full = bare.copy()
    full.reshape(-1, 3)[shown] = encoded(light * np.array(paint.subject))
    return Plate(_noisy(full, paint.noise, rng), _noisy(bare, paint.noise, rng))


def _noisy(picture: F64, noise: float, rng: np.random.Generator) -> U8:
    values = picture + rng.normal(0.0, noise, (SEEDS, *picture.shape)) if noise else np.stack([picture] * SEEDS)
    return np.clip(np.round(values), 0, 255).astype(np.uint8)
