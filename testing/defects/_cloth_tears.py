"""Seeded defects of sheets that tear: tears below the strength, out of the log, mended, laid to what gave nothing, and missing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from ...worlds.candidate import Candidate
from ...worlds.patch import parse_spec
from ..worlds.simulated_worlds import edited, simulate
from ..worlds.small_cloth import PULLED_PROMPT, pulled_spec
from ._kept import kept_folder
from .cases import Mechanism, World

__all__ = ["TEARS"]

FRAMES, SOLVER, STRIP = 10, "cloth", "strip"
STRENGTHS = (20.0, 17.0, 14.0)
STRONG = 1000.0
Frame = dict[str, Any]
Edit = Callable[[Frame, float, np.random.Generator], None]


@cache
def _strip(kind: str, number: int) -> Candidate:
    """A notched strip that is drawn out: it tears, or is too strong to."""
    strength = STRONG if kind == "held" else STRENGTHS[number]
    spec = pulled_spec(stretch=0.018 + 0.002 * number, strength=strength, frames=FRAMES, notch=True)
    return simulate(kept_folder(kind), parse_spec({**spec, "prompt": PULLED_PROMPT}))


def _defect(name: str, text: str, edit: Edit, low: float, high: float, unit: str = "1", bound: float | None = None) -> Mechanism:
    """One of the frames with tears is changed."""

    def build(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
        base = _strip("torn", int(rng.integers(len(STRENGTHS))))
        torn = [k for k in range(FRAMES) if len(base.caches[SOLVER].read(k)["tear/time"])]
        which = torn[int(rng.integers(len(torn)))]

        def change(k: int, data: Frame) -> None:
            if k == which:
                edit(data, magnitude, rng)

        return World(edited(base, folder, SOLVER, change), (SOLVER, STRIP, "cloth"))

    return Mechanism(name, text, True, build, low, high, unit, bound)


def _eased(data: Frame, much: float, rng: np.random.Generator) -> None:
    """The triangles of a tear as if they had been drawn out less."""
    event = int(rng.integers(len(data["tear/time"])))
    own = data["tear/triangle"][:, 0] == event
    places = data["tear/place"][own]
    middle = places.reshape(-1, 3).mean(axis=0)
    data["tear/place"][own] = middle + (1.0 - much) * (places - middle)


def _louder(data: Frame, much: float, rng: np.random.Generator) -> None:
    event = int(rng.integers(len(data["tear/time"])))
    data["tear/tension"][event] *= 1.0 + much


def _silent(data: Frame, much: float, rng: np.random.Generator) -> None:
    """Tears that are not in the log."""
    del rng
    kept = len(data["tear/time"]) - max(1, round(much * len(data["tear/time"])))
    for name in ("time", "corner", "tension", "cause"):
        data[f"tear/{name}"] = data[f"tear/{name}"][:kept]
    if "tear/point" in data:
        data["tear/point"] = data["tear/point"][:kept]
    data["tear/side"] = data["tear/side"][data["tear/side"][:, 0] < kept]
    own = data["tear/triangle"][:, 0] < kept
    data["tear/triangle"], data["tear/place"] = data["tear/triangle"][own], data["tear/place"][own]


def _healed(data: Frame, much: float, rng: np.random.Generator) -> None:
    """Open sides that are closed again."""
    sides = np.flatnonzero(data["edge/open"])
    chosen = rng.permutation(sides)[: max(1, round(much * len(sides)))]
    data["edge/open"][chosen] = 0


def _misdated(data: Frame, much: float, rng: np.random.Generator) -> None:
    event = int(rng.integers(len(data["tear/time"])))
    data["tear/time"][event] += much


def _blamed(data: Frame, much: float, rng: np.random.Generator) -> None:
    """Laid to the post or the rod when neither was met; `much` counts nothing."""
    del much
    event = int(rng.integers(len(data["tear/time"])))
    data["tear/cause"][event] = int(rng.integers(2))
    data["exchange/impulse"][:] = 0.0


def _missing(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
    """The run of a stronger fabric, under the contract of one that bears less than it bore."""
    del folder
    base = _strip("held", int(rng.integers(len(STRENGTHS))))
    entity = base.spec.entities[STRIP]
    physics = entity.physics.model_dump(exclude_unset=True) if entity.physics is not None else {}
    pulled = 0.018 * 1000.0
    spec = base.spec.model_dump(mode="json", exclude_unset=True)
    spec["entities"][STRIP]["physics"] = {**physics, "tear": {"strength": pulled / magnitude}}
    return World(replace(base, spec=parse_spec(spec)), (SOLVER, STRIP, "cloth"))


def _sound(kind: str, text: str) -> Mechanism:
    def build(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
        del folder, magnitude
        return World(_strip(kind, int(rng.integers(len(STRENGTHS)))))

    return Mechanism(kind, text, False, build, 1.0, 2.0, "1")


TEARS = (
    _defect("eased", "a tear happens below the strength", _eased, 0.05, 0.3),
    _defect("louder", "a tear is logged with another pull", _louder, 1e-4, 1.0, bound=1e-6),
    _defect("silent", "tears are missing in the log", _silent, 0.05, 1.0),
    _defect("healed", "open edges close again", _healed, 0.05, 1.0),
    _defect("misdated", "a tear is logged for another frame", _misdated, 0.05, 1.0, "s"),
    _defect("blamed", "a tear is laid to what gave nothing", _blamed, 1.0, 2.0),
    Mechanism("unbroken", "it stays whole over its strength", True, _missing, 1.3, 3.0, "1", None),
    _sound("torn", "strips that tear from a notch"),
    _sound("held", "strips that hold"),
)
