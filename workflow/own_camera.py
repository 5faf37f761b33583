"""Cameras that a call brings along: a place and what to look at, read with errors that name what is wrong."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ..worlds.bounds import shown
from ..worlds.errors import EvidenceError, InputError
from ..worlds.hints import did_you_mean

if TYPE_CHECKING:
    from ..geometry import Camera
    from ..worlds.arrays import F64
    from ..worlds.candidate import Candidate

__all__ = ["buried", "own_camera"]

FORM = "{'position': [x, y, z], 'look_at': 'entity id'}, or with 'target': [x, y, z] in place of look_at, or six numbers"
NAMES = ("position", "target", "look_at", "fov_deg")
FOV_DEG = 40.0
MOST_FOV_DEG = 120.0


def own_camera(candidate: Candidate, given: Mapping[str, Any] | Sequence[float], frame: int, width: int, height: int) -> Camera:
    """The camera that a caller describes.

    Args:
        candidate: what is looked at.
        given: `position` with `target` or `look_at`, and `fov_deg` [degrees]; or position and target as six numbers [m].
        frame: at which `look_at` is looked up.
        width: pixels.
        height: pixels.

    Raises:
        InputError: something is missing, unknown, out of range, or both ways of aiming are given.
    """
    import numpy as np

    from ..geometry import Camera

    if not isinstance(given, Mapping):
        numbers = _numbers("camera", given, 6)
        return Camera(np.array(numbers[:3]), np.array(numbers[3:]), FOV_DEG, width, height)
    for name in given:
        if name not in NAMES:
            raise InputError(f"camera has no {shown(name)}{did_you_mean(name, NAMES, cutoff=0.4) or ';'} give {FORM}")
    if "position" not in given:
        raise InputError(f"camera.position is missing: where the eye is, [x, y, z] in m; give {FORM}")
    aims = [name for name in ("target", "look_at") if given.get(name) is not None]
    if len(aims) != 1:
        found = (
            "both camera.target and camera.look_at are given" if aims else "camera.target is missing, and so is camera.look_at"
        )
        raise InputError(f"{found}: say where to look by one of the two; give {FORM}")
    position = np.array(_numbers("camera.position", given["position"], 3))
    if aims == ["target"]:
        target = np.array(_numbers("camera.target", given["target"], 3))
    else:
        target = _middle(candidate, given["look_at"], frame)
    fov = given.get("fov_deg", FOV_DEG)
    if isinstance(fov, bool) or not isinstance(fov, int | float) or not 5.0 < fov < MOST_FOV_DEG:
        raise InputError(f"camera.fov_deg {shown(fov)} must be a number above 5 and below {MOST_FOV_DEG:g} degrees")
    return Camera(position, target, float(fov), width, height)


def buried(candidate: Candidate, camera: Camera) -> list[str]:
    """A warning where the eye is below the land."""
    from ..worlds.landscape import open_landscape

    told = []
    for name in candidate.spec.terrains:
        try:
            land = open_landscape(candidate.folder, candidate.spec, name)
        except EvidenceError:
            continue
        rows, cols = land.shape
        row = round(float(camera.position[1]) / land.cell + 0.5 * (rows - 1))
        col = round(float(camera.position[0]) / land.cell + 0.5 * (cols - 1))
        if not (0 <= row < rows and 0 <= col < cols):
            continue
        ground = float(land.raw("height")[row, col])
        if camera.position[2] < ground:
            told.append(
                f"the camera stands {ground - camera.position[2]:.1f} m inside the land {name!r}, whose ground is at {ground:.1f} m there: "
                f"raise position[2] above it"
            )
    return told


def _numbers(name: str, given: Any, count: int) -> list[float]:
    """So many numbers.

    Raises:
        InputError: it is something else.
    """
    if not isinstance(given, Sequence) or isinstance(given, str):
        raise InputError(f"{name} = {shown(given)} must be a list of {count} numbers [m]; a camera is {FORM}")
    if len(given) != count:
        raise InputError(f"{name} = {shown(list(given))} has {len(given)} items, it needs {count}; a camera is {FORM}")
    for k, value in enumerate(given):
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(f"{name}[{k}] = {shown(value)} must be a number [m]")
    return [float(v) for v in given]


def _middle(candidate: Candidate, entity: Any, frame: int) -> F64:
    if not isinstance(entity, str) or entity not in candidate.spec.entities:
        known = sorted(candidate.spec.entities)
        if isinstance(entity, Sequence) and not isinstance(entity, str):
            raise InputError(
                f"camera.look_at {shown(list(entity))} takes the id of an entity; a point is given as target: a camera is {FORM}"
            )
        raise InputError(
            f"camera.look_at {shown(entity)} is no entity{did_you_mean(entity, known) or ';'} the world has {known[:20]}"
        )
    return candidate.center(entity, frame)
