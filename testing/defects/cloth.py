"""Seeded defects of cloth: stretched, torn off its pins, pushed through itself and through solids, torn without cause, forged books.

Sound worlds are small simulated ones: a flag and a cloth over a ball. A broken one is a copy changed in one way.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.candidate import Candidate
from ...worlds.patch import parse_spec
from ..worlds.simulated_worlds import edited, simulate
from ..worlds.small_cloth import CATCH_PROMPT, DRAPE_PROMPT, FLAG_PROMPT, catch_spec, drape_spec, flag_spec
from ._cloth_tears import TEARS
from ._kept import kept_folder
from .cases import Mechanism, Suite, World

__all__ = ["SUITE", "sound"]

FRAMES = 10
SOLVER = "cloth"
Frame = dict[str, Any]
Edit = Callable[[Candidate, int, Frame, float, np.random.Generator], Frame]


@cache
def sound(kind: str, number: int) -> Candidate:
    """A simulated world of a kind, kept for the process, in one of three sizes and winds."""
    folder = kept_folder(kind)
    edge = (0.1, 0.12, 0.15)[number % 3]
    if kind in ("flag", "calm", "soft"):
        spec, prompt = flag_spec(frames=FRAMES, resolution=edge), FLAG_PROMPT
        spec["simulation"]["drivers"]["breeze"]["field"]["velocity"] = [4.0 + 2.0 * number, 1.0, 0.0]
        if kind == "calm":
            spec["simulation"]["drivers"] = {}
        if kind == "soft":
            spec["entities"]["flag"]["physics"] |= {"shear_stiffness": 20.0, "bend_stiffness": 0.0, "max_stretch": 0.4}
    elif kind == "catch":
        spec, prompt = catch_spec(frames=FRAMES, resolution=edge), CATCH_PROMPT
    else:
        spec, prompt = drape_spec(frames=FRAMES, resolution=edge), DRAPE_PROMPT
        if kind == "late":
            spec["simulation"]["drivers"]["let_go"]["time"] = 0.15
        if kind == "airless":
            del spec["simulation"]["drivers"]["air"]
    return simulate(folder, parse_spec({**spec, "prompt": prompt}))


def _settled(base: Candidate, data: Frame) -> Frame:
    """Records of momentum and energy as the changed vertices have them."""
    from ...verifiers.categories.cloth.frames import cloth_run

    mass = cloth_run(base, SOLVER).mass
    x, v = data["vertex/position"], data["vertex/velocity"].astype(np.float64)
    gravity = np.array(base.spec.simulation.gravity)
    data["record/kinetic_energy"] = np.float64(0.5 * mass @ (v**2).sum(1))
    data["record/potential_energy"] = np.float64(-(mass @ (x @ gravity)))
    for k, axis in enumerate("xyz"):
        data[f"record/momentum_{axis}"] = np.float64(mass @ v[:, k])
    return data


def _defect(
    name: str, text: str, kind: str, edit: Edit, low: float, high: float, unit: str, bound: float | None = None
) -> Mechanism:
    def build(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
        base = sound(kind, int(rng.integers(3)))
        first = int(rng.integers(2, FRAMES - 1))

        def change(k: int, data: Frame) -> None:
            if k >= first:
                edit(base, k, data, magnitude, rng)

        broken = edited(base, folder, SOLVER, change)
        return World(broken, (SOLVER, "flag", "cloth"))

    return Mechanism(name, text, True, build, low, high, unit, bound)


def _stretched(base: Candidate, k: int, data: Frame, much: float, rng: np.random.Generator) -> Frame:
    del k, rng
    x: F64 = data["vertex/position"]
    pole = x[:, 0].min()
    data["vertex/position"] = np.stack([pole + (1.0 + much) * (x[:, 0] - pole), x[:, 1], x[:, 2]], axis=1)
    return _settled(base, data)


def _slipped(base: Candidate, k: int, data: Frame, much: float, rng: np.random.Generator) -> Frame:
    del k, rng
    from ...verifiers.categories.cloth.frames import cloth_run

    x = data["vertex/position"].copy()
    x[cloth_run(base, SOLVER).held[0].rows[0], 2] -= much
    data["vertex/position"] = x
    return _settled(base, data)


def _poked(base: Candidate, k: int, data: Frame, much: float, rng: np.random.Generator) -> Frame:
    """One vertex beyond a triangle that it does not belong to."""
    del k
    from ...verifiers.categories.cloth.frames import cloth_run

    piece = cloth_run(base, SOLVER).pieces[0]
    x = data["vertex/position"].copy()
    f = piece.faces[int(rng.integers(len(piece.faces)))]
    away = np.linalg.norm(x - x[f].mean(0), axis=1)
    away[f] = np.inf
    near = int(np.argmin(away))
    normal = np.cross(x[f[1]] - x[f[0]], x[f[2]] - x[f[0]])
    normal /= np.linalg.norm(normal)
    side = np.sign((x[near] - x[f].mean(0)) @ normal) or 1.0
    x[near] = x[f].mean(0) - side * much * normal
    ring = np.unique(piece.faces[(piece.faces == near).any(axis=1)])
    lifted = [i for i in ring if i != near and i not in f]
    x[lifted] += side * 0.05 * normal
    data["vertex/position"] = x
    return _settled(base, data)


def _sunk(base: Candidate, k: int, data: Frame, much: float, rng: np.random.Generator) -> Frame:
    """The cloth lower than the ball it lies on."""
    del k, rng
    x = data["vertex/position"].copy()
    middle = np.linalg.norm(x[:, :2], axis=1) < 0.2
    x[middle, 2] = np.minimum(x[middle, 2], np.sqrt(0.25**2 - (x[middle, :2] ** 2).sum(1)) + 0.25 - much)
    data["vertex/position"] = x
    return _settled(base, data)


def _collapsed(base: Candidate, k: int, data: Frame, much: float, rng: np.random.Generator) -> Frame:
    del k, rng
    from ...verifiers.categories.cloth.frames import cloth_run

    f = cloth_run(base, SOLVER).pieces[0].faces[-1]
    x = data["vertex/position"].copy()
    x[f[2]] = 0.5 * (x[f[0]] + x[f[1]]) + (1.0 - much) * (x[f[2]] - 0.5 * (x[f[0]] + x[f[1]]))
    data["vertex/position"] = x
    return _settled(base, data)


def _pushed(base: Candidate, k: int, data: Frame, much: float, rng: np.random.Generator) -> Frame:
    """It moves sideways though nothing pushed it."""
    del k, rng
    data["vertex/velocity"] = data["vertex/velocity"] + np.array([0.0, much, 0.0], dtype=np.float32)
    return _settled(base, data)


def _forged(base: Candidate, k: int, data: Frame, much: float, rng: np.random.Generator) -> Frame:
    del base, k, rng
    data["record/momentum_y"] = data["record/momentum_y"] + np.float64(much)
    return data


def _charged(base: Candidate, k: int, data: Frame, much: float, rng: np.random.Generator) -> Frame:
    """Elastic energy from nowhere, as a share of what the cloth has."""
    del base, rng
    scale = float(data["record/kinetic_energy"]) + abs(float(data["record/air_work"])) + 1.0
    data["record/stretch_energy"] = data["record/stretch_energy"] + np.float64(much * scale * (1 + 0 * k))
    return data


def _heavier(base: Candidate, k: int, data: Frame, much: float, rng: np.random.Generator) -> Frame:
    del base, k, rng
    data["record/mass"] = np.float64(float(data["record/mass"]) * (1.0 + much))
    return data


def _sound(name: str, text: str, kind: str) -> Mechanism:
    def build(folder: Path, magnitude: float, rng: np.random.Generator) -> World:
        del folder, magnitude
        return World(sound(kind, int(rng.integers(3))))

    return Mechanism(name, text, False, build, 1.0, 2.0, "1")


SUITE = Suite(
    "category",
    (
        _defect("stretched", "a flag is drawn out along its warp", "flag", _stretched, 0.25, 1.0, "1"),
        _defect("slipped", "a held vertex slips", "flag", _slipped, 2e-5, 0.05, "m", 1e-5),
        _defect("poked", "a vertex goes through the sheet", "flag", _poked, 0.005, 0.03, "m"),
        _defect("sunk", "a cloth lies in the ball beneath it", "drape", _sunk, 0.005, 0.05, "m"),
        _defect("collapsed", "a triangle has no area left", "flag", _collapsed, 0.92, 1.0, "1", 0.9),
        _defect("pushed", "it moves though nothing pushed it", "drape", _pushed, 0.01, 1.0, "m/s"),
        _defect("forged", "its momentum is recorded wrongly", "flag", _forged, 1e-4, 1.0, "N s"),
        _defect("charged", "energy comes from nowhere", "flag", _charged, 0.2, 2.0, "1"),
        _defect("heavier", "its mass is recorded wrongly", "drape", _heavier, 1e-6, 0.5, "1", 1e-9),
        _sound("flags", "flags in winds of several speeds", "flag"),
        _sound("calm", "a flag that swings down where no air is", "calm"),
        _sound("soft", "a flag that shears easily and does not resist bending", "soft"),
        _sound("drapes", "cloth that falls over a ball", "drape"),
        _sound("late", "cloth that is let go later", "late"),
        _sound("airless", "cloth that falls where no air is", "airless"),
        _sound("catch", "a ball falls into a cloth, and both push each other", "catch"),
        *TEARS,
    ),
)
