"""Free bodies that leave the ground for good: beside it, falling, with nothing static beneath them at the last frame."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...worlds.arrays import F64
from ...worlds.spec import BoxRegion
from ..ledgers import motion
from ..rows.answers import row_of
from ..rows.corrections import correction, pointer
from ..rows.findings import Finding
from .bounds import FALLING
from .graph import gravity_direction
from .moved import atoms
from .questions import KEPT

if TYPE_CHECKING:
    from ...worlds.requirements import Correction, Row
    from ..scene.surfaces import Surfaces

__all__ = ["kept_rows"]

MOST_NAMED = 20


class _Boxes(NamedTuple):
    """Boxes of entities in a frame whose z axis points against gravity [m], shapes (n, 3)."""

    names: tuple[str, ...]
    low: F64
    high: F64


def kept_rows(surfaces: Surfaces) -> list[Row]:
    """Row `support:kept`: no body falls past all ground, unless the story sends it there. None before any simulation."""
    candidate = surfaces.candidate
    free = [n for n in surfaces.entities if candidate.spec.entities[n].motion == "dynamic"]
    fixed = [n for n in surfaces.entities if candidate.spec.entities[n].motion != "dynamic"]
    if candidate.stage == "static" or surfaces.frames < 2 or not free or not fixed or gravity_direction(surfaces) is None:
        return []
    return [row_of(candidate, KEPT, (), partial(_kept, surfaces, free, fixed))]


def _kept(surfaces: Surfaces, free: list[str], fixed: list[str]) -> Finding:
    candidate, last = surfaces.candidate, surfaces.frames - 1
    turn = _upright(surfaces)
    beneath = _boxes(surfaces, fixed, last, turn)
    bodies = _boxes(surfaces, [n for n in free if surfaces.broken.get(n, surfaces.frames) > last], last, turn)
    top = float(beneath.high[:, 2].min())
    lost: list[tuple[str, int, F64]] = []
    for name, low, high in zip(*bodies, strict=True):
        falling = low[2] < top and not _over(beneath, low, high)
        if (
            not falling
            or _speed(surfaces, name) < FALLING
            or _touches(surfaces, name, last)
            or _declared(surfaces, name, beneath, turn)
        ):
            continue
        lost.append((name, _since(surfaces, name, beneath, turn), candidate.center(name, last)))
    lost.sort(key=lambda item: item[1])
    text = f"{len(free)} free bodies stay over the ground, or are meant to leave it"
    if lost:
        name, frame, place = lost[0]
        text = f"{len(lost)} bodies leave the ground and fall: {name!r} from frame {frame} on, last at ({', '.join(f'{c:.2f}' for c in place)})"
    return Finding(
        "fail" if lost else "pass",
        text,
        float(len(lost)),
        0.0,
        frame=lost[0][1] if lost else None,
        hints=_corrections(lost[0][0]) if lost else (),
        evidence={"fallen": [{"entity": n, "frame": f, "place": p.tolist()} for n, f, p in lost[:MOST_NAMED]]},
        entities=tuple(n for n, _, _ in lost[:MOST_NAMED]),
        frames=(0, last),
    )


def _corrections(name: str) -> tuple[Correction, ...]:
    return (
        correction(
            f"{name!r} rolls, slides or is thrown past the edge of the ground",
            "shape",
            "Make the ground larger (build_terrain with a larger size), or put something there that stops it.",
            pointers=("/entities",),
        ),
        correction(
            "it moves faster or farther than meant",
            "initial_state",
            f"Lower the velocity of {name!r}, or raise friction.",
            pointers=(pointer("entities", name, "physics", "linear_velocity"), "/materials"),
        ),
        correction(
            "it is meant to fall away",
            "story",
            f"Say so: a beat in which {name!r} reaches a region, or crosses a plane, that lies beside or below all ground.",
            pointers=("/story/beats",),
        ),
    )


def _upright(surfaces: Surfaces) -> F64:
    """Rotation into a frame whose z axis points against gravity, shape (3, 3); the identity where that is z already."""
    down = gravity_direction(surfaces)
    assert down is not None
    if down[2] < -1.0 + 1e-12:
        return np.eye(3)
    side = np.linalg.svd(down[None])[2][1:]
    return np.concatenate([side, -down[None]])


def _boxes(surfaces: Surfaces, names: list[str], frame: int, turn: F64) -> _Boxes:
    low, high = [], []
    for name in names:
        corners = []
        for part in (surfaces.parts[i] for i in surfaces.parts_of[name]):
            ends = np.array([part.solid.lower, part.solid.upper])
            box = np.array([[ends[i, 0], ends[j, 1], ends[k, 2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
            points = part.solid.vertices if len(part.solid.vertices) <= 5000 else box
            corners.append(surfaces.track(name, part.body).at(frame).apply(points) @ turn.T)
        placed = np.concatenate(corners)
        low.append(placed.min(axis=0))
        high.append(placed.max(axis=0))
    return _Boxes(tuple(names), np.array(low).reshape(-1, 3), np.array(high).reshape(-1, 3))


def _over(beneath: _Boxes, low: F64, high: F64) -> bool:
    """True if something static reaches beneath a box."""
    overlaps = ((beneath.low[:, :2] <= high[:2]) & (beneath.high[:, :2] >= low[:2])).all(axis=1)
    return bool((overlaps & (beneath.low[:, 2] < low[2])).any())


def _speed(surfaces: Surfaces, name: str) -> float:
    """Speed along gravity over the last frame [m/s]."""
    down = gravity_direction(surfaces)
    assert down is not None
    way = motion.centers(surfaces.candidate, name)[-2:]
    return float((way[1] - way[0]) @ down) * surfaces.candidate.spec.simulation.fps


def _touches(surfaces: Surfaces, name: str, frame: int) -> bool:
    """True if anything that stays touches it at a frame, or a joint or driver to the world holds it."""
    spec = surfaces.candidate.spec
    if any(name in (j.parent, j.child) for j in spec.simulation.joints.values()) or spec.entities[name].generator is not None:
        return True
    others = [n for n in surfaces.neighbours.get(name, ()) if spec.entities[n].motion != "dynamic"]
    return any(surfaces.series(name, n)[frame] <= surfaces.contact_gap(name, n) for n in others)


def _since(surfaces: Surfaces, name: str, beneath: _Boxes, turn: F64) -> int:
    """First frame of the last stretch over which nothing is beneath it, by its centre and size."""
    last = surfaces.frames - 1
    box = _boxes(surfaces, [name], last, turn)
    half = 0.5 * (box.high[0] - box.low[0])
    middle = motion.centers(surfaces.candidate, name) @ turn.T
    for frame in range(last, -1, -1):
        if _over(beneath, middle[frame] - half, middle[frame] + half):
            return min(last, frame + 1)
    return 0


def _declared(surfaces: Surfaces, name: str, beneath: _Boxes, turn: F64) -> bool:
    """True if a beat asks the body to be where nothing static is beneath."""
    spec, start = surfaces.candidate.spec, surfaces.candidate.center(name, 0)
    for beat in spec.story.beats.values():
        for atom in atoms(beat.predicate.model_dump()):
            if atom["entity"] != name:
                continue
            place = _asked_place(surfaces, atom, start)
            if place is not None:
                at = turn @ place
                if not _over(beneath, at, at):
                    return True
    return False


def _asked_place(surfaces: Surfaces, atom: dict[str, Any], start: F64) -> F64 | None:
    """Place to which a predicate sends its entity [m], shape (3,); None for those that send it nowhere."""
    if atom["kind"] in ("reaches", "stays_in"):
        region = surfaces.candidate.spec.graph.regions.get(atom["region"])
        if region is None or region.relative_to is not None:
            return None
        low = np.array(region.min) if isinstance(region, BoxRegion) else np.array(region.center)
        return 0.5 * (low + np.array(region.max)) if isinstance(region, BoxRegion) else low
    if atom["kind"] == "crosses":
        return np.array(atom["point"], dtype=np.float64)
    if atom["kind"] == "displacement" and atom.get("axis") is not None:
        axis = np.array(atom["axis"], dtype=np.float64)
        least = float(atom["max"] if atom.get("min") is None else atom["min"])
        return np.asarray(start + least * axis / np.linalg.norm(axis))
    return None
