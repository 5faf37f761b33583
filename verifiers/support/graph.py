"""Graph of support at every frame: contacts, joints, drivers, and the chain of them down to something static.

Contacts are read from geometry, never from contact logs: a sleeping body has none (R92).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64, rotation_matrix
from ...worlds.spec import ReleaseDriver
from ..ledgers import motion
from ..rows.telling import tell
from .afloat import afloat
from .bounds import MISSING, OUTSIDE, SAME_PLACE
from .equilibrium import Balance, Group, solve
from .links import Link, links_of
from .moved import spoken_of
from .pressing import Squeeze, pressed, squeezes
from .stillness import is_still
from .touching import contacts_of

if TYPE_CHECKING:
    from ..scene.surfaces import Surfaces

__all__ = ["SupportGraph", "beside", "drop", "gravity_direction", "group_of", "rolling"]

LARGEST = 300
"""Own choice: a group of more bodies is cut; those beyond the cut are taken to give and bear any force."""
DROP_STEPS = 200
NEAR = 1e-5
"""[m] Conservative advancement stops at this clearance."""


def gravity_direction(surfaces: Surfaces) -> F64 | None:
    """Unit vector along gravity, shape (3,); None without gravity."""
    gravity = np.array(surfaces.candidate.spec.simulation.gravity, dtype=np.float64)
    strength = float(np.linalg.norm(gravity))
    return gravity / strength if strength > 1e-12 else None


class SupportGraph:
    """Who is held up by whom over the inspected frames, or over the first `until` of them."""

    def __init__(self, surfaces: Surfaces, *, until: int | None = None) -> None:
        self.surfaces = surfaces
        self.until = until
        self._grounded: dict[str, NDArray[np.bool_]] = {}
        self._gripped: dict[str, NDArray[np.bool_]] = {}
        self._floating: dict[str, NDArray[np.bool_]] = {}
        self._rests: dict[tuple[str, str, bytes], bool] = {}
        self._together: dict[int, set[str]] = {}
        self.resting: dict[str, tuple[Group, Balance, F64]] = {}
        """Group, balance and way to the middle of its support [m] at frame 0, per body, kept by `verifiers/support/resting.py`."""

    @cached_property
    def links(self) -> tuple[Link, ...]:
        """Joints and rope ends."""
        return links_of(self.surfaces)

    @cached_property
    def _links_at(self) -> dict[str, tuple[Link, ...]]:
        """Links by the entities that they hold, in their order."""
        found: dict[str, list[Link]] = {}
        for link in self.links:
            for name in {link.a, link.b} - {None}:
                found.setdefault(str(name), []).append(link)
        return {name: tuple(links) for name, links in found.items()}

    @cached_property
    def still(self) -> frozenset[str]:
        """Entities that never move."""
        return frozenset(n for n in self.surfaces.entities if is_still(self.surfaces.candidate.spec, n))

    def squeezed(self, entity: str, frame: int) -> list[Squeeze]:
        """Walls beside which an entity, or what touches it, is drawn apart within their skins, where nothing presses."""
        group = group_of(self, entity, frame)
        return [] if group is None else squeezes(self.surfaces, group, self.still, frame)

    def linked(self, a: str, b: str) -> NDArray[np.bool_]:
        """At which frames a joint or rope end holds the two together, shape (frames,)."""
        holds = np.zeros(self.surfaces.frames, dtype=bool)
        for link in self._links_at.get(a, ()):
            if {link.a, link.b} == {a, b}:
                holds |= link.holds
        return holds

    def jointed(self, entity: str, frame: int) -> bool:
        """True if any joint, pin or rope end that bears weight is attached to the entity at a frame."""
        return bool(self._pins(entity)) or any(bool(link.holds[frame]) for link in self._links_at.get(entity, ()))

    def held(self, entity: str) -> NDArray[np.bool_]:
        """At which frames the entity needs nothing beneath it: static, authored, fixed to the world, or not yet let go by a driver
        whose letting go the story tells of."""
        spec = self.surfaces.candidate.spec
        if spec.entities[entity].motion != "dynamic":
            return np.ones(self.surfaces.frames, dtype=bool)
        time = np.arange(self.surfaces.frames) / spec.simulation.fps
        holds = np.zeros(self.surfaces.frames, dtype=bool)
        for driver in spec.simulation.drivers.values():
            if isinstance(driver, ReleaseDriver) and driver.entity == entity and spoken_of(spec, entity):
                holds |= time <= driver.time
        for link in self._links_at.get(entity, ()):
            if link.a is None:
                holds |= link.holds
        return holds | (None in self._pins(entity))

    def _pins(self, entity: str) -> set[str | None]:
        """Who carries the pins of an elastic body; None for the world."""
        return {pin.to for pin in getattr(self.surfaces.candidate.spec.entities[entity].physics, "pins", {}).values()}

    def floating(self, entity: str) -> NDArray[np.bool_]:
        """At which frames a liquid helps to carry the entity, shape (frames,)."""
        if entity not in self._floating:
            found = afloat(self.surfaces.candidate, entity).values()
            self._floating[entity] = np.logical_or.reduce([np.zeros(self.surfaces.frames, dtype=bool), *found])
        return self._floating[entity]

    def _holders(self, entity: str) -> Iterator[tuple[str, NDArray[np.bool_]]]:
        """Entities that hold it directly, and at which frames."""
        for other in self.surfaces.neighbours.get(entity, ()):
            if self.linked(other, entity).all():
                continue
            carried = self.surfaces.carries(other, entity, until=self.until)
            if carried.any():
                yield other, carried
        for carrier in sorted(self._pins(entity) - {None}, key=str):
            yield str(carrier), np.ones(self.surfaces.frames, dtype=bool)
        for link in self._links_at.get(entity, ()):
            if link.a is not None and link.a != link.b:
                yield (link.b if entity == link.a else link.a), link.holds

    def grounded(self, entity: str) -> NDArray[np.bool_]:
        """At which frames a continuous chain of holders leads from the entity to something held, shape (frames,)."""
        if entity not in self._grounded:
            holders: dict[str, list[tuple[str, NDArray[np.bool_]]]] = {}
            waiting = [entity]
            while waiting:
                name = waiting.pop()
                if name in holders:
                    continue
                holds = self.held(name)
                holders[name] = [] if holds.all() or name in self._grounded else list(self._holders(name))
                waiting += [other for other, _ in holders[name] if other not in holders]
            state = {
                name: self._grounded.get(name, self.held(name) | self.gripped(name) | self.floating(name)).copy()
                for name in holders
            }
            changed = True
            while changed:
                changed = False
                for name, edges in holders.items():
                    before = int(state[name].sum())
                    for other, holds in edges:
                        state[name] |= holds & state[other]
                    changed |= int(state[name].sum()) > before
            self._grounded |= state
        return self._grounded[entity]

    def _touch(self, a: str, b: str) -> NDArray[np.bool_]:
        touches = self.surfaces.series(a, b) <= self.surfaces.contact_gap(a, b)
        if self.until is not None:
            touches[self.until :] = False
        return np.asarray(touches)

    def gripped(self, entity: str) -> NDArray[np.bool_]:
        """At which frames nothing is beneath the entity, but friction and contacts from several sides can bear it, shape (frames,)."""
        if entity not in self._gripped:
            others = [n for n in self.surfaces.neighbours.get(entity, ()) if self._touch(entity, n).any()]
            open_frames = np.zeros(self.surfaces.frames, dtype=bool)
            for other in others:
                open_frames |= self._touch(entity, other)
            for other in others if not self.held(entity).all() else ():
                open_frames &= ~self.surfaces.carries(other, entity, until=self.until)
            open_frames &= ~self.held(entity)
            self._gripped[entity] = np.zeros_like(open_frames)
            for number, frame in enumerate(np.flatnonzero(open_frames), 1):
                tell(f"balance of {entity}: frame", number, int(open_frames.sum()))
                self._gripped[entity][frame] = self.rests(entity, int(frame))
        return self._gripped[entity]

    def rests(self, entity: str, frame: int, *, without: str = "") -> bool:
        """True if contact forces within friction can bear the entity, optionally as if it did not touch one other."""
        if not without and self.rest_together((entity,), frame):
            return True
        key = (entity, without, self._place(entity, frame))
        if key not in self._rests:
            self._rests[key] = self._can_rest(entity, frame, without)
        return self._rests[key]

    def rest_together(self, entities: Iterable[str], frame: int) -> bool:
        """True if it was found before that all of these can rest at a frame, none of them at another's cost."""
        return self._together.get(frame, set()).issuperset(entities)

    def _can_rest(self, entity: str, frame: int, without: str) -> bool:
        group = group_of(self, entity, frame)
        if group is None:
            return False
        group = pressed(self.surfaces, group, self.still, frame)
        if without:
            group = group.without(entity, without)
        # What cannot rest on bodies that give any force cannot on bodies that must rest themselves.
        if (without or frame > 0) and len(group.members) > 1 and not _resting(self.surfaces, group.alone(entity), entity):
            return False
        if without:
            return bool(_resting(self.surfaces, group, entity))
        balances = _resting(self.surfaces, group, entity)
        if set(balances) == set(group.members) and all(b.whole for b in balances.values()) and len(group.members) < LARGEST:
            self._together.setdefault(frame, set()).update(group.members)
        return bool(balances)

    def _place(self, entity: str, frame: int) -> bytes:
        """Poses, as seen from the entity, of all that touches it directly or through others."""
        members, pairs = touching(self, entity, frame)
        involved = sorted({*members, *(n for pair in pairs for n in pair)})
        origin = self.surfaces.candidate.center(entity, frame)
        state: list[F64] = []
        for name in involved:
            for body in self.surfaces.candidate.entity(name).bodies:
                pose = self.surfaces.track(name, body.name).at(frame)
                state += [pose.position - origin, rotation_matrix(pose.quaternion).ravel()]
        return ",".join(involved).encode() + np.round(np.concatenate(state) / SAME_PLACE).astype(np.int64).tobytes()

    def chain(self, entity: str, frame: int) -> list[str]:
        """Shortest chain of holders from the entity to something held at a frame; empty where there is none."""
        paths: list[list[str]] = [[entity]]
        seen = {entity}
        while paths:
            path = paths.pop(0)
            if self.held(path[-1])[frame]:
                return path
            if self.gripped(path[-1])[frame]:
                return [
                    *path,
                    " and ".join(sorted(n for n in self.surfaces.neighbours[path[-1]] if self._touch(path[-1], n)[frame])),
                ]
            if self.floating(path[-1])[frame]:
                found = afloat(self.surfaces.candidate, path[-1])
                return [*path, next(n for n, frames in found.items() if frames[frame])]
            for other, holds in self._holders(path[-1]):
                if holds[frame] and other not in seen:
                    seen.add(other)
                    paths.append([*path, other])
        return []


def group_of(graph: SupportGraph, entity: str, frame: int) -> Group | None:
    """The free bodies that touch `entity` at a frame, directly or through others; None without gravity or where it is held."""
    surfaces = graph.surfaces
    gravity = np.array(surfaces.candidate.spec.simulation.gravity, dtype=np.float64)
    strength = float(np.linalg.norm(gravity))
    if strength < 1e-12 or _fixed(graph, entity, frame):
        return None
    members, pairs = touching(graph, entity, frame)
    contacts = tuple((a, b, contacts_of(surfaces, a, b, frame)) for a, b in pairs)
    candidate = surfaces.candidate
    centers = np.array([candidate.center(m, frame) for m in members])
    weights = np.array([motion.entity_mass(candidate, m) * strength for m in members])
    sizes = np.array([0.5 * surfaces.size(m) for m in members])
    return Group(members, contacts, centers, weights, sizes, gravity / strength)


def touching(graph: SupportGraph, entity: str, frame: int) -> tuple[tuple[str, ...], tuple[tuple[str, str], ...]]:
    """The free bodies that touch `entity` directly or through others, itself among them, and every touching pair of theirs."""
    surfaces = graph.surfaces
    members, waiting = [entity], [entity]
    pairs: dict[frozenset[str], tuple[str, str]] = {}
    while waiting:
        name = waiting.pop(0)
        for other in surfaces.neighbours.get(name, ()):
            pair = frozenset((name, other))
            if pair in pairs or not surfaces.series(name, other)[frame] <= surfaces.contact_gap(name, other):
                continue
            pairs[pair] = (name, other)
            if other not in members and len(members) < LARGEST and not _fixed(graph, other, frame):
                members.append(other)
                waiting.append(other)
    return tuple(members), tuple(pairs.values())


def _fixed(graph: SupportGraph, entity: str, frame: int) -> bool:
    """True if something else than contact may hold the entity: it is then taken to give and bear any force."""
    return bool(graph.held(entity)[frame]) or graph.jointed(entity, frame) or entity in graph.surfaces.broken


def rolling(surfaces: Surfaces, entity: str) -> float:
    """Largest rolling resistance length of an entity's materials [m]: so far may a contact force act from its point."""
    materials = surfaces.candidate.spec.materials
    used = {p.material for p in surfaces.candidate.entity(entity).parts}
    return max((materials[m].rolling_friction for m in used if m in materials), default=0.0)


def _resting(surfaces: Surfaces, group: Group, entity: str) -> dict[str, Balance]:
    """Bodies of the group, the entity among them, that can rest on each other; none where the entity cannot."""
    while entity in group.members:
        found = solve(group, claimed=(entity,), shift=OUTSIDE)
        fit = {m for m, b in found.items() if b.missing <= MISSING and b.shift <= OUTSIDE + rolling(surfaces, m)}
        if len(fit) == len(group.members):
            return found
        group = group.of(fit)
    return {}


def beside(surfaces: Surfaces, entity: str, frame: int) -> list[str]:
    """Entities that touch it at a frame beside or above it, not in the way of its falling."""
    return [
        n
        for n in surfaces.neighbours.get(entity, ())
        if surfaces.series(entity, n)[frame] <= surfaces.contact_gap(entity, n)
        and not surfaces.carries(n, entity, until=frame + 1)[frame]
    ]


def drop(surfaces: Surfaces, entity: str, frame: int) -> tuple[float, str] | None:
    """Distance that the entity falls along gravity until it meets something [m], and its name; None where nothing lies beneath.

    Conservative advancement: it moves by the clearance, which no obstacle can be nearer than.
    """
    direction = gravity_direction(surfaces)
    if direction is None:
        return None
    low, high = surfaces.boxes(np.array([frame]))
    own = list(surfaces.parts_of[entity])
    reach = float(np.linalg.norm(high[:, 0].max(axis=0) - low[:, 0].min(axis=0)))
    start, stop = low[own, 0].min(axis=0), high[own, 0].max(axis=0)
    start, stop = np.minimum(start, start + reach * direction), np.maximum(stop, stop + reach * direction)
    meets = ((low[:, 0] <= stop) & (high[:, 0] >= start)).all(axis=1)
    others = {surfaces.parts[i].entity for i in np.flatnonzero(meets)} - {entity} - set(beside(surfaces, entity, frame))
    best: tuple[float, str] | None = None
    for other in sorted(others):
        fallen = 0.0
        for _ in range(DROP_STEPS):
            clearance = surfaces.gap(entity, other, frame, offset=fallen * direction).distance
            if clearance <= NEAR or (best is not None and fallen >= best[0]) or fallen > reach:
                break
            fallen += clearance
        if fallen <= reach and clearance <= NEAR and (best is None or fallen < best[0]):
            best = (fallen, other)
    return best
