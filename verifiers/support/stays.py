"""Free bodies stay in their places until something that moves them reaches them, whatever relations are declared (R92, R154).

What may move is what the story moves, or a driver of what it speaks of: subjects of beats and what they are asked to do, launched,
released and pushed bodies that a beat names, blown ones, authored paths, matter that deforms or flows. From there motion spreads: to what is touched by
something that has left its place, from that frame on. A body that nobody reaches and that leaves its place fell or slid by
itself, and nothing says that it should.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property, partial
from heapq import heapify, heappop, heappush
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from ...worlds.audits.story import STARTED
from ...worlds.fields import fields_of
from ...worlds.spec import DetachDriver, ForceDriver, MotorDriver, ReleaseDriver, RigidPhysics, Rope, Supports
from ..ledgers import motion
from ..ledgers.exchanged import CHANNEL
from ..rows.answers import row_of, rows_of
from ..rows.corrections import correction, let_settle, pointer
from ..rows.findings import Finding
from .bounds import STIRRED
from .graph import gravity_direction
from .moved import moves_of, spoken_of, support_interval
from .questions import STAYS
from .stillness import is_still

if TYPE_CHECKING:
    from ...worlds.requirements import Correction, Row
    from ..scene.surfaces import Surfaces

__all__ = ["Reached", "stays_rows"]

NEVER = np.iinfo(np.int64).max
Frames = NDArray[np.int64]


class Reached:
    """From which frame on each entity that is not static may move, because something moves it."""

    def __init__(self, surfaces: Surfaces) -> None:
        self.surfaces = surfaces
        self.spec = surfaces.candidate.spec
        self.names = tuple(n for n in surfaces.entities if not is_still(self.spec, n))

    def first_frame(self, time: float) -> int:
        """The last frame at or before a time [s]."""
        return int(np.floor(time * self.spec.simulation.fps + 1e-9))

    @cached_property
    def _links(self) -> list[tuple[str | None, str | None]]:
        """Pairs of entities that joints, rope ends and pins join; None is the world."""
        found: list[tuple[str | None, str | None]] = [(j.child, j.parent) for j in self.spec.simulation.joints.values()]
        for name, entity in self.spec.entities.items():
            if isinstance(entity.generator, Rope):
                ends = (entity.generator.attach_start, entity.generator.attach_end)
                found += [(name, None if e == "world" else e) for e in ends if e is not None]
            found += [(name, pin.to) for pin in getattr(entity.physics, "pins", {}).values()]
        return found

    @cached_property
    def hung(self) -> frozenset[str]:
        """Entities that hang on the world, or on something that no force moves, by joints, ropes and pins, also through others: they may swing."""
        fixed = {n for n, e in self.spec.entities.items() if e.motion != "dynamic"}
        found: set[str] = set()
        grown = True
        while grown:
            grown = False
            for a, b in self._links:
                for one, two in ((a, b), (b, a)):
                    if one is not None and one not in fixed | found and (two is None or two in fixed | found):
                        found.add(one)
                        grown = True
        return frozenset(found)

    def source(self, name: str) -> int | None:
        """From which frame on an entity may move by itself, by the story or by a driver; None where nothing says so."""
        spec = self.spec
        found: list[int] = []
        entity = spec.entities[name]
        physics = entity.physics
        still = isinstance(physics, RigidPhysics) and not any(
            abs(c) >= STARTED for c in (*physics.linear_velocity, *physics.angular_velocity)
        )
        if entity.motion == "kinematic" or name in self.hung or moves_of(spec).first(name) is not None:
            return 0
        if entity.generator is not None or bool(fields_of(spec, name)):
            return 0
        if not spoken_of(spec, name):
            return None
        if not still:
            return 0
        for driver in spec.simulation.drivers.values():
            if isinstance(driver, ReleaseDriver) and driver.entity == name:
                found.append(self.first_frame(driver.time))
            elif isinstance(driver, ForceDriver) and driver.entity == name:
                found.append(self.first_frame(driver.start))
            elif isinstance(driver, MotorDriver | DetachDriver) and name in self._joined_by(driver.joint):
                found.append(self.first_frame(driver.time if isinstance(driver, DetachDriver) else driver.start))
        return min(found, default=None)

    def _joined_by(self, joint: str) -> tuple[str | None, ...]:
        found = self.spec.simulation.joints.get(joint)
        return () if found is None else (found.child, found.parent)

    @cached_property
    def away(self) -> dict[str, F64]:
        """Displacement of each centre of mass since frame 0 [m], shape (frames,)."""
        found = {}
        for name in self.names:
            with np.errstate(invalid="ignore", over="ignore"):
                centers = motion.centers(self.surfaces.candidate, name)
                found[name] = np.asarray(np.linalg.norm(centers - centers[0], axis=1))
        return found

    def _stirs(self, name: str) -> int:
        """Last frame at which an entity has not begun to move; `NEVER` where it does not."""
        surfaces, going = self.surfaces, self.away[name] > STIRRED
        for body in surfaces.candidate.entity(name).bodies:
            position, quaternion = surfaces.track(name, body.name)
            with np.errstate(invalid="ignore", over="ignore"):
                going |= np.linalg.norm(position - position[0], axis=1) > STIRRED
                turn = 2.0 * np.linalg.norm(quaternion - np.sign(quaternion @ quaternion[0])[:, None] * quaternion[0], axis=1)
                going |= turn * surfaces.size(name) > STIRRED
        if name in surfaces.candidate.deforming:
            return 0
        return max(0, int(np.argmax(going)) - 1) if going.any() else NEVER

    @cached_property
    def _pushed(self) -> dict[str, int]:
        """First frame at which liquids, cloth or grains that act on it push an entity."""
        candidate = self.surfaces.candidate
        found: dict[str, int] = {}
        soft = {**candidate.liquid_caches, **candidate.cloth_caches, **candidate.particle_caches}
        plan = self.spec.simulation
        coupled = ({c.source, c.target} for c in plan.couplings.values())
        acting = {name for ends in coupled if ends & set(plan.rigid) for name in ends}
        for solver, cache in soft.items():
            if solver not in acting or not cache.index.colliders:
                continue
            given = np.asarray(cache.series(CHANNEL), dtype=np.float64)[: candidate.frame_count, :, :3]
            for at, collider in enumerate(cache.index.colliders):
                frames = np.flatnonzero(np.abs(given[:, at]).max(axis=1) > 0.0)
                if len(frames):
                    name = collider.split("/", 1)[0]
                    found[name] = min(found.get(name, NEVER), max(0, int(frames[0]) - 1))
        return found

    @cached_property
    def _touches(self) -> dict[str, dict[str, NDArray[np.bool_]]]:
        """Who touches whom at which frames or since the frame before, by geometry and by the contact log, shape (frames,)."""
        surfaces, among = self.surfaces, set(self.names)
        found: dict[str, dict[str, NDArray[np.bool_]]] = {n: {} for n in self.names}

        def enter(a: str, b: str, frames: NDArray[np.bool_]) -> None:
            for one, two in ((a, b), (b, a)):
                found[one][two] = found[one].get(two, np.zeros(surfaces.frames, dtype=bool)) | frames

        for (a, b), series in surfaces.moving.items():
            if a in among and b in among:
                enter(a, b, series <= surfaces.contact_gap(a, b))
        for cache in surfaces.candidate.rigid_caches.values():
            owner = [c.split("/", 1)[0] for c in cache.index.colliders]
            for frame, log in enumerate(cache.ragged("contact/pair", "event/pair")[: surfaces.frames]):
                pairs = {tuple(p) for key in ("contact/pair", "event/pair") for p in log[key].tolist()}
                for i, j in pairs:
                    if owner[i] != owner[j] and {owner[i], owner[j]} <= among:
                        now = np.zeros(surfaces.frames, dtype=bool)
                        now[frame] = True
                        enter(owner[i], owner[j], now)
        for one, two in self._links:
            if one in among and two in among:
                enter(str(one), str(two), np.ones(surfaces.frames, dtype=bool))
        return found

    @cached_property
    def arrival(self) -> dict[str, int]:
        """From which frame on each entity may move; `NEVER` where nothing reaches it."""
        found = dict.fromkeys(self.names, NEVER)
        for name in self.names:
            own = self.source(name)
            found[name] = min(NEVER if own is None else own, self._pushed.get(name, NEVER))
        waiting = [(frame, name) for name, frame in found.items() if frame < NEVER]
        heapify(waiting)
        done: set[str] = set()
        while waiting:
            frame, name = heappop(waiting)
            stirs = NEVER if name in done else self._stirs(name)
            done.add(name)
            begins = max(frame, stirs)
            for other, touching in self._touches[name].items() if begins < NEVER else ():
                frames = np.flatnonzero(touching[begins:])
                if len(frames) and begins + int(frames[0]) < found[other]:
                    found[other] = begins + int(frames[0])
                    heappush(waiting, (found[other], other))
        return found


def stays_rows(surfaces: Surfaces) -> list[Row]:
    """Rows `support:stays:<entity>` of free bodies at rest that no relation holds to the end; none before any simulation."""
    candidate = surfaces.candidate
    if candidate.stage == "static" or surfaces.frames < 2 or gravity_direction(surfaces) is None:
        return []
    return rows_of(candidate, STAYS, (), partial(_rows, surfaces))


def _rows(surfaces: Surfaces) -> Iterator[Row]:
    candidate, spec = surfaces.candidate, surfaces.candidate.spec
    covered = {
        r.b
        for r in spec.graph.relations.values()
        if isinstance(r, Supports) and support_interval(spec, r)[0] == 0 and support_interval(spec, r)[1] >= candidate.last_frame
    }
    reached = Reached(surfaces)
    for name in reached.names:
        entity = spec.entities[name]
        judged = entity.motion == "dynamic" and name not in covered and surfaces.broken.get(name, surfaces.frames) > 0
        if judged and reached.source(name) is None:
            yield row_of(candidate, STAYS, (name,), _stays(reached, name), entities=(name,))


def _stays(reached: Reached, name: str) -> Finding:
    surfaces, spec = reached.surfaces, reached.spec
    bound, away = spec.simulation.limits.support_drift, reached.away[name]
    free = reached.arrival[name]
    # What touches it at a frame may have moved it since the frame before.
    last = max(0, min(surfaces.frames, free) - 1)
    held = away[: last + 1]
    wrong = ~(held <= bound)
    frame = int(np.argmax(wrong)) if wrong.any() else None
    if frame is None:
        text = f"{name!r} stays within {held.max() * 1e3:.4g} mm of its place over {len(held)} frames"
        if free < surfaces.frames:
            text += f", until something that moves reaches it at frame {free}"
    else:
        fallen = motion.centers(surfaces.candidate, name)[frame] - motion.centers(surfaces.candidate, name)[0]
        way = ", ".join(f"{c:+.3g}" for c in fallen)
        text = (
            f"{name!r} leaves its place by itself: at frame {frame} it is {away[frame] * 1e3:.4g} mm away from it, by ({way}) m, "
            f"and nothing that a beat or driver moves has reached it"
        )
    return Finding(
        "pass" if frame is None else "fail",
        text,
        float(held.max()) if frame is None else float(away[frame]),
        bound,
        frame=frame,
        hints=() if frame is None else tuple(_corrections(surfaces, name)),
        evidence={"reached_at": free if free < surfaces.frames else None},
        frames=(0, last),
        predicate=f"{name} stays within {bound:g} m of its place until something that moves reaches it",
    )


def _corrections(surfaces: Surfaces, name: str) -> Iterator[Correction]:
    beneath = [n for n in surfaces.neighbours.get(name, ()) if surfaces.carries(n, name, until=1)[0]]
    on = f" on {', '.join(map(repr, beneath[:3]))}" if beneath else ""
    yield correction(
        f"{name!r} falls, tips, slides or rolls{on}: where it stands it cannot rest",
        "placement",
        f"Place {name!r} so that it rests, with its centre over what carries it; then declare what `supports` it.",
        pointers=(pointer("entities", name, "pose"),),
    )
    yield from let_settle(surfaces.candidate, name)
    yield correction(
        "it is meant to move, and no beat says so",
        "story",
        f"Add a beat with the subject {name!r} that says what it does, and what causes it.",
        pointers=("/story/beats",),
    )
    yield correction(
        "it is meant to be let go or pushed",
        "drivers",
        f"Declare a `release` or `force` driver of {name!r} or give it an initial velocity, and add a beat that tells of it.",
        pointers=("/simulation/drivers", pointer("entities", name, "physics", "linear_velocity")),
    )
