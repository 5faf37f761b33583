"""Places and motion of entities at a frame and over frames, for `inspect_world(part='state')`."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..worlds.arrays import F64
from ..worlds.candidate import Candidate
from ..worlds.errors import InputError
from ..worlds.hints import did_you_mean
from .answers import paged
from .bond_states import bonds_at, bonds_over
from .matter_states import forces_on, loose_told, reader_of_loose, rounded, stretch_told

__all__ = ["MAX_SAMPLES", "motion_over", "state_at"]

MAX_NAMED = 6
"""Bodies of one entity that a reply names."""
MAX_SAMPLES = 40
"""Frames at which one reply tells a motion."""
OFF_ORIGIN = 1e-3
"""[m] Distance from which on a centre of mass is told beside the position."""
MAX_OTHERS = 4
"""Others whose contact forces are told over frames: those that push most."""


def _one_body(candidate: Candidate, asked: str) -> tuple[str, str, dict[str, str]]:
    """Entity and body that `entity` or `entity/body` means, and, where it has several, which of them is told.

    Raises:
        InputError: the entity has no such body.
    """
    name, _, wanted = asked.partition("/")
    bodies = [b.name for b in candidate.entity(name).bodies]
    if wanted and wanted not in bodies:
        listed = ", ".join(bodies[:MAX_NAMED]) + (f", ... {bodies[-1]}" if len(bodies) > MAX_NAMED else "")
        raise InputError(
            f"{name!r} has no body {wanted!r}{did_you_mean(wanted, bodies) or ';'} its {len(bodies)} bodies are {listed}"
        )
    body = wanted or bodies[0]
    if len(bodies) == 1:
        return name, body, {}
    place = f"{body!r}, {bodies.index(body) + 1} of {len(bodies)}"
    if wanted:
        return name, body, {"body": place}
    listed = ", ".join(bodies[:MAX_NAMED])
    return name, body, {"body": f"{place}; a box holds all; entities=['{name}/{bodies[1]}'] tells of another: {listed}, ..."}


def _center_off(candidate: Candidate, name: str, body: str) -> F64 | None:
    """Centre of mass of a body in its own frame [m], shape (1, 3), where it is not where the body's position is."""
    center: F64 = next(b.center for b in candidate.entity(name).bodies if b.name == body)
    return center[None] if float(np.abs(center).max()) > OFF_ORIGIN else None


def _body_vertices(candidate: Candidate, name: str, body: str, frame: int) -> F64:
    """Visible vertices of one body in the world, shape (n, 3)."""
    return np.concatenate([candidate.surface(name, p.part, frame) for p in candidate.entity(name).parts if p.body == body])


def state_at(
    candidate: Candidate, names: list[str], frame: int, last: int, limit: int, offset: int
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Pose, box, velocity, spin and contact forces of entities at one frame, a page of them; of loose matter how much is where, of cloth the stretch."""

    def told(asked: str) -> dict[str, Any]:
        read = reader_of_loose(candidate, asked)
        if read is not None:
            return loose_told(candidate, asked, read, frame)
        name, body, which = _one_body(candidate, asked)
        pose = candidate.pose(name, frame, body)
        vertices = candidate.vertices(name, frame) if asked == name else _body_vertices(candidate, name, body, frame)
        found: dict[str, Any] = {
            **which,
            "position": rounded(pose.position),
            "quaternion": rounded(pose.quaternion),
            "box_min": rounded(vertices.min(0)),
            "box_max": rounded(vertices.max(0)),
        }
        if (center := _center_off(candidate, name, body)) is not None:
            found["centre"] = rounded(pose.apply(center)[0])
        place = candidate.cache_row(name, body)
        if place is not None:
            found["velocity"] = rounded(place[0].series("velocity")[frame, place[1]])
            found["spin"] = rounded(place[0].series("angular_velocity")[frame, place[1]])
            found |= {"asleep": True} if place[0].series("asleep")[frame, place[1]] else {}
        forces = {other: rounded(force, 3) for other, force in forces_on(candidate, asked, frame).items()}
        stretch = stretch_told(candidate, asked, frame)
        bonds = bonds_at(candidate, name, frame)
        return found | ({"forces": forces} if forces else {}) | ({"stretch": stretch} if stretch else {}) | bonds

    page, place = paged([(n, told(n)) for n in names[: offset + limit]], offset, limit)
    return {"frame": frame, "entities": dict(page)}, _of(place, len(names), offset + len(page))


def motion_over(
    candidate: Candidate, names: list[str], first: int, last: int, limit: int, offset: int
) -> tuple[dict[str, Any], dict[str, Any]]:
    """The same at evenly chosen frames, a page of entities; contact forces by their size."""
    step = max(1, -(-(last - first + 1) // MAX_SAMPLES))
    chosen = list(range(first, last + 1, step))

    def told(asked: str) -> dict[str, Any]:
        read = reader_of_loose(candidate, asked)
        if read is not None:
            return _columns([loose_told(candidate, asked, read, k) for k in chosen])
        name, body, which = _one_body(candidate, asked)
        poses = [candidate.pose(name, k, body) for k in chosen]
        found: dict[str, Any] = {
            **which,
            "position": [rounded(p.position, 4) for p in poses],
            "quaternion": [rounded(p.quaternion, 3) for p in poses],
        }
        if (center := _center_off(candidate, name, body)) is not None:
            found["centre"] = [rounded(p.apply(center)[0], 4) for p in poses]
        place = candidate.cache_row(name, body)
        if place is not None:
            velocity, spin = (place[0].series(channel)[:, place[1]] for channel in ("velocity", "angular_velocity"))
            found["speed"] = [round(float((velocity[k] ** 2).sum() ** 0.5), 4) for k in chosen]
            found["spin"] = [rounded(spin[k], 3) for k in chosen]
            still = [k for k in chosen if place[0].series("asleep")[k, place[1]]]
            found |= {"asleep_at": still} if still else {}
        bonds = bonds_over(candidate, name, chosen)
        return found | _forces(candidate, asked, chosen) | _stretched(candidate, asked, chosen) | bonds

    page, place = paged([(n, told(n)) for n in names[: offset + limit]], offset, limit)
    return {"frames": chosen, "step": step, "entities": dict(page)}, _of(place, len(names), offset + len(page))


def _columns(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Values by quantity over frames, None where there is none; of regions their counts and mean speeds."""
    names = [n for n in dict.fromkeys(key for row in rows for key in row) if n not in ("regions", "box_min", "box_max")]
    regions = dict.fromkeys(region for row in rows for region in row.get("regions", ()))
    found: dict[str, Any] = {n: [row.get(n) for row in rows] for n in names}
    for region in regions:
        inside = [row.get("regions", {}).get(region, {"count": 0, "mean_speed": 0.0}) for row in rows]
        found.setdefault("regions", {})[region] = {k: [i[k] for i in inside] for k in ("count", "mean_speed")}
    return found


def _forces(candidate: Candidate, name: str, chosen: list[int]) -> dict[str, Any]:
    """Size of the contact force by each other [N], of those that push most at the chosen frames."""
    sizes = [{other: float(np.linalg.norm(f)) for other, f in forces_on(candidate, name, k).items()} for k in chosen]
    peaks = {other: max(s.get(other, 0.0) for s in sizes) for other in dict.fromkeys(o for s in sizes for o in s)}
    most = sorted(peaks, key=lambda other: -peaks[other])[:MAX_OTHERS]
    told = {other: [float(f"{s.get(other, 0.0):.4g}") for s in sizes] for other in most}
    return {"force": told} if told else {}


def _stretched(candidate: Candidate, name: str, chosen: list[int]) -> dict[str, Any]:
    """Largest stretch of a sheet at the chosen frames, and where it is when it is largest."""
    found = {k: stretch_told(candidate, name, k) for k in chosen}
    if not all(found.values()):
        return {}
    worst = max(found, key=lambda k: float(found[k]["largest"]))
    return {"stretch": [s["largest"] for s in found.values()], "most_stretched": {"frame": worst, **found[worst]}}


def _of(place: dict[str, Any], total: int, end: int) -> dict[str, Any]:
    """The place of a page among all entities, of which only the first ones were read."""
    return (
        {k: v for k, v in place.items() if k != "next_offset"} | {"total": total} | ({"next_offset": end} if end < total else {})
    )
