"""Seeded defects of what liquids and the bodies of their partners tell of each other: books that begin at frame 0, work from outside.

Sound worlds are simulated once per kind and kept: a crate that floats since the preroll, and one that rises beside a springboard.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache as kept
from pathlib import Path
from typing import Any

import numpy as np

from ...construction.build import build_entity
from ...simulation.schedule import run_frames
from ...worlds.candidate import Candidate, cache_digest
from ...worlds.patch import parse_spec
from ..worlds.simulated_worlds import edited
from ..worlds.small_liquids import PROMPT, springboard_spec, tank_spec
from ._kept import kept_folder
from .cases import Mechanism, World

__all__ = ["PARTNER_MECHANISMS"]

WATER, BODIES = "water", "rigid"
FRAMES = 5
AFLOAT: tuple[dict[str, Any], ...] = (
    {"spacing": 0.04, "engine": "dfsph"},
    {"spacing": 0.03, "engine": "flip"},
)
"""Settings of tanks with a crate that floats at about its draft and settles in a preroll."""
BOARD: dict[str, Any] = {"spacing": 0.04}


@kept
def _afloat(number: int) -> Candidate:
    given = tank_spec(frames=FRAMES, crate_at=0.22, **AFLOAT[number])
    given["simulation"]["preroll"] = 0.25
    return _simulated("afloat", given)


@kept
def _board() -> Candidate:
    return _simulated("board", springboard_spec(frames=FRAMES + 1, **BOARD))


def _simulated(kind: str, given: dict[str, Any]) -> Candidate:
    spec, folder = parse_spec({**given, "prompt": PROMPT}), kept_folder(kind)
    built = {n: build_entity(spec, n, Path()) for n in spec.entities}
    caches = run_frames(spec, built, folder / "run", frames=spec.simulation.frames)
    return Candidate(folder, spec, built, "probe", caches, "run", cache_digest(caches))


def received_before(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The bodies' books begin with so much of what the crate got in its strongest frame, the liquid's begin with nothing."""
    base = _afloat(int(rng.integers(len(AFLOAT))))
    most = np.abs(base.caches[BODIES].series("exchange/impulse")).max()

    def edit(frame: int, data: dict[str, Any]) -> None:
        if frame == 0:
            data["exchange/impulse"][0, 2] += magnitude * most

    return World(edited(base, folder / "of_bodies", BODIES, edit), ("crate", WATER))


def springs_up(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The board has so much more energy from a frame on, of all that is in play, and nobody gave it."""
    base = _board()
    held = base.caches[BODIES]
    kinetic, potential = (
        held.series(f"record/{n}") + held.series(f"record/elastic_{n}") for n in ("kinetic_energy", "potential_energy")
    )
    play = kinetic.max() + np.ptp(potential + held.series("record/strain_energy"))
    first = int(rng.integers(1, FRAMES))

    def edit(frame: int, data: dict[str, Any]) -> None:
        if frame >= first:
            data["record/strain_energy"] = np.float64(data["record/strain_energy"] + magnitude * play)

    return World(edited(base, folder / "of_bodies", BODIES, edit), ("board", BODIES))


def _as_simulated(make: Callable[[int], Candidate]) -> Callable[[Path, float, np.random.Generator], World]:
    return lambda folder, magnitude, rng: World(make(round(magnitude) - 1))


PARTNER_MECHANISMS = (
    Mechanism(
        "received_before", "a body's books begin with what it got before frame 0", True, received_before, 1.1e-5, 10.0, "1",
        bound=1e-5, check="category",
    ),
    Mechanism(
        "springs_up", "a board gains energy beside a crate that water lifts", True, springs_up, 0.25, 2.0, "1", check="category"
    ),
    Mechanism(
        "afloat", "crates float since the preroll", False, _as_simulated(_afloat), 1.0, float(len(AFLOAT)), "1",
        named=tuple(range(1, len(AFLOAT) + 1)), check="category",
    ),
    Mechanism(
        "beside_a_board", "water lifts a crate beside a springboard", False, _as_simulated(lambda _: _board()), 1.0, 1.0, "1",
        named=(1,), check="category",
    ),
)  # fmt: skip
