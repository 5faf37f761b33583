"""Support of static things: a chain of contacts down to the ground, for every piece of every one of them (R92, R93, R154).

The ground of a world is its landscapes, its height fields, and the static things that reach lowest. Everything else that
never moves hangs together with it through visible surfaces that touch within a seam (`support/seams.py`), from whichever side: a shelf
on its wall, a beam between its posts; all seams of a chain together are no wider than the contact tolerance. Parts of one entity that touch nothing of it need a chain of their own. What stands on bodies that may
move is not held by them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from heapq import heappop, heappush
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...geometry import signed_clearance
from ...worlds.arrays import F64, RigidPose
from ...worlds.spec import HeightField, WorldSpec
from ..rows.answers import row_of, rows_of
from ..rows.corrections import correction, move_parts, pointer, say_afloat
from ..rows.findings import Finding, lacking
from ..scene.bounds import ROUNDING
from ..scene.room import in_the_way
from .bounds import LEFT
from .free_bodies import along_up, placement
from .graph import DROP_STEPS, NEAR, gravity_direction
from .questions import DERIVED, HELD
from .seams import seam, seams_between
from .stillness import is_still

if TYPE_CHECKING:
    from ...worlds.requirements import Correction, Row
    from ..scene.surfaces import Surfaces
    from .landed import Ground

__all__ = ["Held", "afloat_lines", "held_rows"]

DETAILED = 20
"""Failing rows for which the way to what lies beneath and beside is measured; a scene of floating things is mended one by one."""


class Way(NamedTuple):
    """A way of a floating piece to something."""

    distance: float
    """[m]"""
    to: str
    offset: F64
    """The move that closes it [m], shape (3,)."""


def afloat_lines(spec: WorldSpec) -> list[dict[str, str]]:
    """Lines of the approximation register: what is said to float, and why."""
    return [
        {"what": f"{name!r} floats in the air: {entity.afloat}", "effect": "nothing holds it up"}
        for name, entity in spec.entities.items()
        if entity.afloat is not None
    ]


def _is_solid(spec: WorldSpec, part: Any) -> bool:
    """True of a surface of which collisions know."""
    declared = spec.entities[part.entity].parts.get(part.part)
    return declared is None or declared.collides


class Held:
    """Parts of static things that a chain of contacts joins with the ground, at frame 0."""

    def __init__(self, surfaces: Surfaces, ground: Ground) -> None:
        self.surfaces, self.ground = surfaces, ground
        spec = surfaces.candidate.spec
        self.names = tuple(n for n in surfaces.entities if is_still(spec, n) and n not in surfaces.broken)

    @cached_property
    def _parts(self) -> tuple[int, ...]:
        return tuple(i for n in self.names for i in self.surfaces.parts_of[n])

    @cached_property
    def foundation(self) -> frozenset[int]:
        """Parts that are the ground, or touch a landscape."""
        surfaces, spec = self.surfaces, self.surfaces.candidate.spec
        down = gravity_direction(surfaces)
        if down is None or not self._parts:
            return frozenset(self._parts)
        found: set[int] = set()
        depth: dict[int, float] = {}
        for i in self._parts:
            part = surfaces.parts[i]
            declared = spec.entities[part.entity].parts.get(part.part)
            if declared is not None and isinstance(declared.shape, HeightField):
                found |= set(surfaces.parts_of[part.entity])
            depth[i] = float((surfaces.track(part.entity, part.body).at(0).apply(part.solid.vertices) @ down).max())
        lowest = max(depth.values())
        for i, value in depth.items():
            entity = surfaces.parts[i].entity
            if self.ground.over(entity):
                if self.ground.touched(entity, (i,)):
                    found.add(i)
            elif value >= lowest - seam(surfaces, entity, entity):
                found.add(i)
        return frozenset(found)

    @cached_property
    def touching(self) -> Mapping[int, dict[int, float]]:
        """Parts that touch each part, and the gap to each [m]."""
        return seams_between(self.surfaces, self.names)

    @cached_property
    def _chains(self) -> tuple[dict[int, int | None], dict[int, float]]:
        """For every part on a chain to the ground the next part on the tightest one, None for the ground, and the sum of its gaps [m]."""
        toward: dict[int, int | None] = {}
        total: dict[int, float] = {}
        waiting: list[tuple[float, int, int, int | None]] = [(0.0, 0, part, None) for part in sorted(self.foundation)]
        while waiting:
            width, links, part, before = heappop(waiting)
            if part in total:
                continue
            toward[part], total[part] = before, width
            for other, gap in self.touching[part].items():
                if other not in total and self._bears(part, other):
                    heappush(waiting, (width + gap, links + 1, other, part))
        return toward, total

    def _bears(self, part: int, other: int) -> bool:
        """True if one part can bear another: a drawn one bears nothing but what is drawn on it."""
        one, two = (self.surfaces.parts[i] for i in (part, other))
        if _is_solid(self.surfaces.candidate.spec, one):
            return True
        return one.entity == two.entity and not _is_solid(self.surfaces.candidate.spec, two)

    @cached_property
    def _toward(self) -> Mapping[int, int | None]:
        """For every part that is held the next part on its tightest chain to the ground; None for the ground itself."""
        toward, total = self._chains
        most = self.surfaces.candidate.spec.simulation.limits.contact_gap
        return {part: before for part, before in toward.items() if total[part] <= most + ROUNDING}

    def open_seams(self, parts: Sequence[int]) -> float | None:
        """Sum of the gaps on the tightest chain of some parts to the ground [m]; None where they have none."""
        return min((self._chains[1][i] for i in parts if i in self._chains[1]), default=None)

    def loose(self, entity: str) -> tuple[int, ...]:
        """Parts of one piece of the entity that nothing holds: those that touch each other; empty where all are held."""
        open_parts = [i for i in self.surfaces.parts_of[entity] if i not in self._toward]
        if not open_parts:
            return ()
        piece, waiting = {open_parts[0]}, [open_parts[0]]
        while waiting:
            for other in self.touching[waiting.pop()]:
                if other in open_parts and other not in piece:
                    piece.add(other)
                    waiting.append(other)
        return tuple(sorted(piece))

    def is_ground(self, entity: str) -> bool:
        """True if every part of the entity is ground or stands on a landscape by itself."""
        return set(self.surfaces.parts_of[entity]) <= self.foundation

    def chain(self, entity: str) -> list[str]:
        """Entities from this one to the ground, along the chain of the part that is farthest from it."""
        longest: list[str] = []
        for part in self.surfaces.parts_of[entity]:
            chain, at = [entity], self._toward.get(part)
            while at is not None:
                name = self.surfaces.parts[at].entity
                chain += [name] if chain[-1] != name else []
                at = self._toward[at]
            longest = chain if len(chain) > len(longest) else longest
        return longest


def held_rows(held: Held) -> list[Row]:
    """Rows `support:derived:<entity>` of everything that never moves and is not the ground; none without gravity."""
    surfaces = held.surfaces
    if gravity_direction(surfaces) is None:
        return []
    candidate = surfaces.candidate

    def found() -> list[Row]:
        return [row_of(candidate, DERIVED, (name,), one, entities=(name,)) for name, one in _findings(held)]

    return rows_of(candidate, HELD, (), found)


def _findings(held: Held) -> Iterator[tuple[str, Finding]]:
    surfaces, failed = held.surfaces, 0
    for name, missing in surfaces.missing.items():
        if is_still(surfaces.candidate.spec, name):
            yield name, replace(lacking(missing), **_common(surfaces, name))
    for name in held.names:
        if held.is_ground(name):
            continue
        reason = surfaces.candidate.spec.entities[name].afloat
        loose = held.loose(name)
        if loose and reason is None:
            failed += 1
            yield name, _floats(held, name, loose, detailed=failed <= DETAILED)
            continue
        chain = held.chain(name)
        text = (
            f"{name!r} is held up through {' -> '.join(chain)}"
            if not loose
            else f"{name!r} is said to float in the air: {reason}"
        )
        yield (
            name,
            Finding(
                "pass",
                text,
                evidence={"chain": chain} if not loose else {"afloat": reason},
                entities=(name, *chain[1:2]),
                **_common(surfaces, name),
            ),
        )


def _common(surfaces: Surfaces, name: str) -> dict[str, Any]:
    entity = surfaces.candidate.spec.entities[name]
    return {"predicate": HELD.predicate, "frames": (0, 0), "extra": [entity.motion, entity.afloat]}


def _floats(held: Held, name: str, loose: Sequence[int], *, detailed: bool) -> Finding:
    surfaces = held.surfaces
    whole = len(loose) == len(surfaces.parts_of[name])
    what = repr(name) if whole else f"part {name}/{surfaces.parts[loose[0]].part}"
    fall = _beneath(held, loose) if detailed else None
    near = _beside(held, loose) if detailed else None
    corrections: list[Correction] = []
    gap = _seam_of(held, name, near or fall)
    nearest = min((w.distance for w in (fall, near) if w is not None and w.distance > gap), default=None)
    seams = held.open_seams(loose)
    if seams is not None:
        nearest, gap = seams, surfaces.candidate.spec.simulation.limits.contact_gap
        text = f"{what} is held over gaps of {seams * 1e3:.4g} mm together; on a chain to the ground at most {gap * 1e3:.4g} mm are allowed"
        corrections.append(_closer(name))
    elif fall is not None and fall.distance <= gap:
        text = f"{what} touches {fall.to!r}, which nothing holds up either"
    elif fall is not None:
        text = f"{what} floats {fall.distance * 1e3:.4g} mm above {fall.to!r}, and touches nothing that is held up"
        corrections.append(_move(held, name, loose, fall, "put it down"))
    else:
        text = f"{what} floats: nothing lies beneath it, and it touches nothing that is held up"
    if near is not None and near.distance > gap and (fall is None or near.distance < 0.9 * fall.distance):
        text += f"; the nearest thing that is held up is {near.to!r}, {near.distance * 1e3:.4g} mm away"
        corrections.insert(0, _move(held, name, loose, near, f"bring it to {near.to!r}"))
    mobile = _on_mobile(held, name, loose) if detailed else None
    if mobile is not None:
        text = f"{what} touches {mobile!r}, which may move: what never moves itself is not held by that, and would stay in the air; else it {text.removeprefix(what).lstrip()}"
        corrections.insert(0, _let_move(surfaces, name, mobile))
    corrections += _others(name, what)
    return Finding(
        "fail",
        text,
        nearest,
        gap,
        hints=tuple(corrections),
        evidence={
            "beneath": None if fall is None else fall.to,
            "nearest_held": None if near is None else near.to,
            "parts": [surfaces.parts[i].part for i in loose],
        },
        entities=(name,) if fall is None else (name, fall.to),
        **_common(surfaces, name),
    )


def _seam_of(held: Held, name: str, way: Way | None) -> float:
    """Widest gap that counts as contact with what a way leads to [m]: with a landscape, the contact tolerance (S3)."""
    to = name if way is None else way.to
    if to not in held.surfaces.entities:
        return float(held.surfaces.candidate.spec.simulation.limits.contact_gap)
    return seam(held.surfaces, name, to)


def _move(held: Held, name: str, loose: Sequence[int], way: Way, what: str) -> Correction:
    surfaces = held.surfaces
    if len(loose) == len(surfaces.parts_of[name]):
        return placement(surfaces, name, way.offset, f"{name!r} is placed away from what holds it: {what}")
    parts = [surfaces.parts[i].part for i in loose]
    text, cause = ", ".join(f"{c:+.5g}" for c in way.offset), f"part {parts[0]!r} of {name!r} touches none of its other parts"
    action = f"Move it by ({text}) m in the world ({what}), or add a part that joins it with the others."
    declared = surfaces.candidate.spec.entities[name].parts
    if set(parts) <= set(declared) and in_the_way(surfaces, loose, way.offset) is None:
        return move_parts(surfaces.candidate, name, dict.fromkeys(parts, way.offset), cause, action)
    return correction(cause, "shape", action, pointers=(pointer("entities", name, "parts", parts[0], "pose"),))


def _on_mobile(held: Held, name: str, loose: Sequence[int]) -> str | None:
    """A body that may move and that some parts touch; None where there is none."""
    surfaces = held.surfaces
    low, high = (box[:, 0] for box in surfaces.boxes(np.zeros(1, dtype=np.intp)))
    still = {name, *held.names}
    for other in (n for n in surfaces.entities if n not in still and n not in surfaces.broken):
        gap = seam(surfaces, name, other)
        for i, j in ((i, j) for i in loose for j in surfaces.parts_of[other]):
            if (low[j] > high[i] + gap).any() or (high[j] < low[i] - gap).any():
                continue
            pose, there = (surfaces.track(surfaces.parts[k].entity, surfaces.parts[k].body).at(0) for k in (i, j))
            if signed_clearance(surfaces.shapes.solid(i, 0), pose, surfaces.shapes.solid(j, 0), there).distance <= gap:
                return other
    return None


def _let_move(surfaces: Surfaces, name: str, mobile: str) -> Correction:
    """Let a thing that lies on a body which may move go with it: an engine then moves it too."""
    spec = surfaces.candidate.spec
    place = pointer("entities", name, "motion")
    moved = any(name in i.members and mobile in i.members for i in spec.simulation.solvers.values())
    return correction(
        f"{name!r} is said never to move, and lies on {mobile!r}, which may",
        "shape",
        f"Let {name!r} move too (motion 'dynamic', a member of the instance that moves {mobile!r}).",
        pointers=(place,),
        patch=({"op": "replace", "path": place, "value": "dynamic"},) if moved else (),
    )


def _closer(name: str) -> Correction:
    return correction(
        f"there is air between {name!r} and the ground, a little at each thing that holds it",
        "placement",
        f"Place {name!r} and what holds it so that they touch: what never moves needs no room for collision skins.",
        pointers=(pointer("entities", name, "pose"),),
    )


def _others(name: str, what: str) -> Iterator[Correction]:
    yield correction(
        "what would hold it is not there",
        "shape",
        f"Add what holds {what}: a post, bracket, cable or wall, as a static entity or as a part of {name!r}, that touches it.",
        pointers=("/entities", pointer("entities", name, "parts")),
    )
    yield say_afloat(name, "it is meant to float in the air")


def _beneath(held: Held, loose: Sequence[int]) -> Way | None:
    """The way of some parts down to the first thing that never moves, or to a landscape; None where nothing lies beneath."""
    surfaces = held.surfaces
    down = gravity_direction(surfaces)
    assert down is not None
    low, high = (box[:, 0] for box in surfaces.boxes(np.zeros(1, dtype=np.intp)))
    reach = float(np.linalg.norm(high.max(axis=0) - low.min(axis=0)))
    best: tuple[float, str] | None = held.ground.beneath(surfaces.parts[loose[0]].entity, tuple(loose))
    others = [j for n in held.names for j in surfaces.parts_of[n] if j not in loose]
    for i in loose:
        span = np.array([[low[i], low[i] + reach * down], [high[i], high[i] + reach * down]])
        for j in others:
            if (low[j] > span[1].max(axis=0)).any() or (high[j] < span[0].min(axis=0)).any():
                continue
            fallen = _fall(surfaces, i, j, down, reach if best is None else best[0])
            if fallen is not None:
                best = (fallen, surfaces.parts[j].entity)
    if best is None:
        return None
    offset = along_up(surfaces, LEFT - best[0])
    assert offset is not None
    return Way(best[0], best[1], offset)


def _fall(surfaces: Surfaces, i: int, j: int, down: F64, most: float) -> float | None:
    """Distance that part i falls until it meets part j [m], by conservative advancement; None where that is not within `most`."""
    pose, other = (surfaces.track(surfaces.parts[k].entity, surfaces.parts[k].body).at(0) for k in (i, j))
    solids = surfaces.shapes.solid(i, 0), surfaces.shapes.solid(j, 0)
    fallen = 0.0
    for _ in range(DROP_STEPS):
        moved = RigidPose(pose.position + fallen * down, pose.quaternion)
        clearance = signed_clearance(solids[0], moved, solids[1], other).distance
        if clearance <= NEAR:
            return fallen if fallen < most else None
        fallen += clearance
        if fallen >= most:
            return None
    return None


def _beside(held: Held, loose: Sequence[int]) -> Way | None:
    """The shortest way of some parts to a part that is held; None where there is none."""
    surfaces = held.surfaces
    low, high = (box[:, 0] for box in surfaces.boxes(np.zeros(1, dtype=np.intp)))
    fixed = np.array(sorted(held._toward), dtype=np.intp)
    best: Way | None = None
    for i in loose if len(fixed) else ():
        apart = np.maximum(np.maximum(low[fixed] - high[i], low[i] - high[fixed]), 0.0)
        bound = np.linalg.norm(apart, axis=1)
        for k in np.argsort(bound, kind="stable"):
            if best is not None and bound[k] >= best.distance:
                break
            j = int(fixed[k])
            poses = [surfaces.track(surfaces.parts[n].entity, surfaces.parts[n].body).at(0) for n in (i, j)]
            found = signed_clearance(surfaces.shapes.solid(i, 0), poses[0], surfaces.shapes.solid(j, 0), poses[1])
            if found.distance > 0.0 and (best is None or found.distance < best.distance):
                way = np.asarray(found.point_b) - np.asarray(found.point_a)
                short = max(0.0, found.distance - LEFT) / found.distance
                best = Way(found.distance, surfaces.parts[j].entity, short * way)
    return best
