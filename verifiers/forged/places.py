"""Forged motions that depend on what a predicate asks: into a region, through a plane, along or about an axis, apart and together."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.errors import EvidenceError
from ...worlds.predicates import Crosses, Displacement, Reaches, Separation, StaysIn, Tilts, Topples
from ...worlds.spec import BoxRegion
from .bodies import BLOCK, GAP
from .bounds import HALF, LEANS, WAY
from .stage import FPS, Stage

if TYPE_CHECKING:
    from ...worlds.arrays import F64
    from ...worlds.spec import WorldSpec

__all__ = ["PLACES"]

FRAMES = 13


def _straight(stage: Stage, size: tuple[float, ...], start: F64, end: F64) -> None:
    """Let it go straight from one place to another."""
    stage.add("it", size, start, velocity=(end - start) * FPS / (stage.frames - 1))


def _size(spec: WorldSpec, name: str) -> tuple[float, ...]:
    return spec.entities[name].dimensions.size if name in spec.entities else BLOCK


def _into(spec: WorldSpec, atom: Reaches | StaysIn) -> Stage:
    """It goes into the middle of the region."""
    region = spec.graph.regions.get(atom.region)
    if region is None:
        raise EvidenceError(f"region {atom.region!r} is not in the scene graph")
    middle = 0.5 * np.add(region.min, region.max) if isinstance(region, BoxRegion) else np.array(region.center)
    size = _size(spec, atom.entity)
    stage = Stage(FRAMES, gravity=0.0)
    stage.regions[atom.region] = region.model_copy(update={"relative_to": None})
    wide = np.subtract(region.max, region.min).max() if isinstance(region, BoxRegion) else 2.0 * region.radius
    _straight(stage, size, np.add(middle, (wide + sum(size), 0, 0)), middle)
    return stage


def _through(spec: WorldSpec, atom: Crosses) -> Stage:
    """It goes through the plane."""
    normal = np.array(atom.normal, dtype=np.float64)
    size = _size(spec, atom.entity)
    way = normal / max(float(np.linalg.norm(normal)), 1e-300) * sum(size)
    stage = Stage(FRAMES, gravity=0.0)
    _straight(stage, size, np.array(atom.point) - way, np.array(atom.point) + way)
    return stage


def _along(spec: WorldSpec, atom: Displacement) -> Stage:
    """It goes along the axis, or against it where no more than some way is asked for."""
    axis = np.array(atom.axis or (1.0, 0.0, 0.0), dtype=np.float64)
    back = atom.min is None or atom.min < 0.0
    end = axis / max(float(np.linalg.norm(axis)), 1e-300) * (-WAY if back and atom.axis is not None else WAY)
    stage = Stage(FRAMES, gravity=0.0)
    _straight(stage, BLOCK, np.zeros(3), end)
    return stage


def _leans(spec: WorldSpec, atom: Tilts | Topples) -> Stage:
    """It leans over, and stays so."""
    axis = np.array(getattr(atom, "axis", (0.0, 0.0, 1.0)), dtype=np.float64)
    across = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    rates = np.zeros(FRAMES)
    rates[1:-2] = 1.0
    stage = Stage(FRAMES, gravity=0.0)
    turn = across / max(float(np.linalg.norm(across)), 1e-300) * LEANS * FPS / rates.sum()
    stage.add("it", BLOCK, (0, 0, 0), spin=rates[:, None] * turn)
    return stage


def _apart(spec: WorldSpec, atom: Separation) -> Stage:
    """It leaves the other, or comes to it where no more than some clearance is asked for."""
    near, far = np.array([2 * HALF + GAP, 0, 0]), np.array([2 * HALF + GAP + WAY, 0, 0])
    stage = Stage(FRAMES, gravity=0.0)
    stage.add("other", BLOCK, (0, 0, 0))
    _straight(stage, BLOCK, *((near, far) if atom.min is not None else (far, near)))
    return stage


PLACES: Mapping[str, Callable[[WorldSpec, Any], Stage]] = {
    "reaches": _into,
    "stays_in": _into,
    "crosses": _through,
    "displacement": _along,
    "tilts": _leans,
    "topples": _leans,
    "separation": _apart,
}
"""By kind of predicate."""
IN_PLACE = frozenset({"reaches", "stays_in", "crosses"})
"""Kinds that are forged at the place and in the size of the world that they are asked in."""
