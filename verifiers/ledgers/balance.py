"""Ledgers of a rigid instance: momentum and energy per frame and entity, with their sources and sinks.

Everything here is computed from poses, velocities and built mass properties; of the solver's own records only the
contact impulses enter: as what they gave, and as the most that they can have given (Coulomb: friction at most mu times the
normal impulse). What is left of a change of momentum when gravity, drivers, drag, springs and contacts are taken off has no source.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from ...worlds.spec import DetachDriver, ForceDriver, ReleaseDriver, RigidPhysics
from ..support.springs import Spring, springs_of
from .assemblies import assemblies_of, joined
from .bodies import BodyBooks, Flags
from .contacts import CONTACT_CHANNELS, Contacts, logged_contacts
from .exchanged import Exchanged, exchanged
from .fields import blown

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...worlds.cache import Cache
    from ...worlds.candidate import Candidate

__all__ = ["Books", "Contacts", "Flags", "books_of", "contacts_of", "frictions"]

_SLACK = 1e-9
"""[s] Times this close are equal."""
NAP_SPEED = 0.05
"""[m/s] A body that is faster at both frames was not asleep between them: it would have had to stop and to start."""
NAP_STEPS = 9
"""Steps at rest that precede sleep, less one (MuJoCo's `mjMINAWAKE` is 10)."""


def books_of(candidate: Candidate, cache: Cache) -> Books:
    """The ledgers of one instance, computed once per cache.

    Raises:
        EvidenceError: a channel is missing, damaged or of another shape than the index says.
    """
    return candidate.memo(("books", cache), lambda: Books(candidate, cache))


def frictions(candidate: Candidate, colliders: Sequence[str], *, sliding: bool = False) -> tuple[F64, F64]:
    """Least and greatest friction coefficient between any two of `colliders` (n entities), each shape (n, n).

    The greatest is that of rest, unless both are asked for of what is `sliding`.
    """
    spec, own = candidate.spec, []
    for name in colliders:
        used = [spec.materials[p.material] for p in candidate.entity(name).parts]
        most = [m.friction if sliding else m.friction_at_rest for m in used]
        own.append((min((m.friction for m in used), default=0.0), max(most, default=0.0)))
    table = np.array(own).reshape(-1, 2)
    # The larger of two materials' coefficients holds; a pair of its own overrides both.
    low, high = (np.maximum.outer(column, column) for column in table.T)
    rank = {n: i for i, n in enumerate(colliders)}
    for pair in spec.simulation.contacts.values():
        if pair.friction is not None and pair.a in rank and pair.b in rank:
            i, j = rank[pair.a], rank[pair.b]
            low[i, j] = low[j, i] = pair.friction
            high[i, j] = high[j, i] = pair.friction if sliding else pair.friction_at_rest
    return low, high


def contacts_of(candidate: Candidate, cache: Cache) -> Contacts:
    """All logged contacts of one instance: also where none of its rigid bodies moves, but something elastic does.

    Raises:
        EvidenceError: a channel is missing or its rows do not fit.
    """
    if cache.index.bodies:
        return books_of(candidate, cache).contacts
    return candidate.memo(("contacts", cache), lambda: logged_contacts(cache.ragged(*CONTACT_CHANNELS)))


class Books(BodyBooks):
    """Ledgers of one instance. Axes: frames F, intervals F - 1 (interval k leads from frame k to k + 1), moving entities E."""

    @cached_property
    def springs(self) -> tuple[Spring, ...]:
        """Springs and ropes between points of this instance's entities, measured."""
        return springs_of(self)

    @cached_property
    def elastic(self) -> F64:
        """Energy stored in springs between two points [J], shape (F,)."""
        result = np.zeros(self.frames)
        for spring in self.springs:
            result += spring.energy
        return result

    # ---------------------------------------------------------------- what acts when

    @cached_property
    def released(self) -> F64:
        """Time from which each entity is free [s], shape (E,); infinite for kinematic ones."""
        result = np.where(self.kinematic, np.inf, -np.inf)
        for driver in self.candidate.spec.simulation.drivers.values():
            if isinstance(driver, ReleaseDriver) and driver.entity in self.row:
                row = self.row[driver.entity]
                result[row] = max(result[row], driver.time)
        return result

    @cached_property
    def free_time(self) -> F64:
        """Time that each entity is neither held nor on a path within each interval [s], shape (F - 1, E)."""
        start = np.maximum(self.times[:-1, None], self.released)
        free: F64 = np.clip(self.times[1:, None] - start, 0.0, self.duration)
        return np.where(free < _SLACK, 0.0, free)

    def overlap(self, start: float, end: float) -> F64:
        """Part of each interval that lies within [start, end) [s], shape (F - 1,)."""
        inside: F64 = np.minimum(self.times[1:], end) - np.maximum(self.times[:-1], start)
        return np.clip(inside, 0.0, None)

    @cached_property
    def detached(self) -> dict[str, float]:
        """Time at which each joint that a driver opens is opened [s]."""
        found: dict[str, float] = {}
        for driver in self.candidate.spec.simulation.drivers.values():
            if isinstance(driver, DetachDriver):
                found[driver.joint] = min(driver.time, found.get(driver.joint, np.inf))
        return found

    # ---------------------------------------------------------------- impulses per interval

    @cached_property
    def gravity_impulse(self) -> F64:
        """Impulse of gravity [N s], shape (F - 1, E, 3)."""
        return (self.free_time * self.mass)[:, :, None] * self.gravity

    @cached_property
    def driver_wrench(self) -> tuple[F64, F64]:
        """Impulse and angular impulse of force drivers [N s], [N m s], each shape (F - 1, E, 3)."""
        linear, angular = np.zeros((2, self.frames - 1, len(self.entities), 3))
        for driver in self.candidate.spec.simulation.drivers.values():
            if isinstance(driver, ForceDriver) and driver.entity in self.row:
                row = self.row[driver.entity]
                acting = self.overlap(max(driver.start, self.released[row]), driver.end)[:, None]
                linear[:, row] += acting * np.array(driver.force)
                angular[:, row] += acting * np.array(driver.torque)
        return linear, angular

    @cached_property
    def drag(self) -> F64:
        """Drag coefficient of each entity [N s/m], shape (E,)."""
        physics = [self.candidate.spec.entities[n].physics for n in self.entities]
        return np.array([p.linear_damping if isinstance(p, RigidPhysics) else 0.0 for p in physics])

    @cached_property
    def drag_impulse(self) -> F64:
        """Impulse of drag [N s], shape (F - 1, E, 3): exactly the coefficient times the way."""
        acting = (self.free_time > 0)[:, :, None]
        return np.where(acting, -self.drag[:, None] * np.diff(self.centers, axis=0), 0.0)

    @cached_property
    def spring_impulse(self) -> tuple[F64, F64]:
        """Impulse of springs [N s], shape (F - 1, E, 3), and its uncertainty, shape (F - 1, E); infinite where not resolved."""
        impulse, doubt = np.zeros((self.frames - 1, len(self.entities), 3)), np.zeros((self.frames - 1, len(self.entities)))
        for spring in self.springs:
            given, unsure = spring.impulse
            for row, sign in ((spring.child, 1.0), (spring.parent, -1.0)):
                if row is not None and not self.kinematic[row]:
                    free = self.free_time[:, row] > 0
                    impulse[:, row] += sign * np.where(free[:, None], given, 0.0)
                    doubt[:, row] += np.where(free, unsure, 0.0)
        return impulse, doubt

    @cached_property
    def let_go(self) -> Flags:
        """True where an entity is let go within the interval, not at one of its ends, shape (F - 1, E)."""
        return (self.free_time > 0.0) & (self.free_time < self.duration - _SLACK) & ~self.kinematic

    @cached_property
    def liquid(self) -> Exchanged:
        """Impulses and work of liquids, grains and cloth that are coupled both ways: of what they give to a body that is let go within an
        interval, the share of it in which it is free (see `let_go_doubt`); the hold bears the rest."""
        found = exchanged(self)
        share = np.where(self.let_go, self.free_time / self.duration, 1.0)[:, :, None]
        return replace(found, linear=share * found.linear, angular=share * found.angular)

    @cached_property
    def let_go_doubt(self) -> tuple[F64, F64]:
        """Uncertainty of those impulses [N s], [N m s], each shape (F - 1, E): all of them may come before the release, or after."""
        share = self.free_time / self.duration
        wide = np.where(self.let_go, np.maximum(share, 1.0 - share) / np.maximum(share, _SLACK), 0.0)
        linear, angular = (np.linalg.norm(v, axis=2) for v in (self.liquid.linear, self.liquid.angular))
        return wide * linear, wide * angular

    @cached_property
    def fields(self) -> Exchanged:
        """Impulses and work of force fields."""
        return blown(self)

    @cached_property
    def outside(self) -> Exchanged:
        """Impulses and work of coupled matter and of force fields together."""
        return self.liquid.plus(self.fields)

    @cached_property
    def known_impulse(self) -> F64:
        """Gravity, drivers, drag, springs, liquids and fields together [N s], shape (F - 1, E, 3)."""
        return self.gravity_impulse + self.driver_wrench[0] + self.drag_impulse + self.spring_impulse[0] + self.outside.linear

    @cached_property
    def residual(self) -> F64:
        """Change of momentum less what is known [N s], shape (F - 1, E, 3): what contacts, joints or nothing gave.

        Zero for entities on paths and held ones, which nothing moves but their driver.
        """
        change = np.diff(self.momentum, axis=0) - self.known_impulse
        return np.where((self.free_time > 0)[:, :, None], change, 0.0)

    @cached_property
    def switching(self) -> Flags:
        """True where a force driver acts on the entity for a part of the interval only, shape (F - 1, E)."""
        result = np.zeros((self.frames - 1, len(self.entities)), dtype=bool)
        for driver in self.candidate.spec.simulation.drivers.values():
            if isinstance(driver, ForceDriver) and driver.entity in self.row:
                acting = self.overlap(driver.start, driver.end)
                result[:, self.row[driver.entity]] |= (acting > _SLACK) & (acting < self.duration - _SLACK)
        return result

    @cached_property
    def reach(self) -> F64:
        """The same of each entity of one body, with its collision skins, shape (E,)."""
        spec = self.candidate.spec
        skin = 2.0 * spec.simulation.rigid[self.cache.index.solver].settings.skin
        off = [max((max(p.deviation) for p in self.candidate.entity(n).parts), default=0.0) for n in self.entities]
        result: F64 = self.body_reach[self.first] + skin + np.array(off)
        return result

    @cached_property
    def rolling(self) -> F64:
        """Greatest rolling resistance length among all that the instance's entities may touch [m]; as lever of pure torques."""
        spec = self.candidate.spec
        names = {p.material for n in self.cache.index.colliders for p in self.candidate.entity(n).parts}
        length = max((spec.materials[m].rolling_friction for m in names), default=0.0)
        return np.full(len(self.entities), max(length, 1e-6))

    @cached_property
    def sources(self) -> dict[str, F64]:
        """Impulses by cause [N s], each shape (F - 1, E, 3); the residual is what contacts and joints gave."""
        return {
            "gravity": self.gravity_impulse,
            "drivers": self.driver_wrench[0],
            "drag": self.drag_impulse,
            "springs": self.spring_impulse[0],
            **({"liquids": self.liquid.linear} if self.liquid.wet.any() else {}),
            **({"fields": self.fields.linear} if self.fields.wet.any() else {}),
            "contacts, joints": self.residual,
        }

    # ---------------------------------------------------------------- contacts

    @cached_property
    def contacts(self) -> Contacts:
        """All logged contacts.

        Raises:
            EvidenceError: a channel is missing or its rows do not fit.
        """
        return logged_contacts(self.ragged(*CONTACT_CHANNELS))

    @cached_property
    def collider_row(self) -> NDArray[np.int64]:
        """Entity row per collider; -1 for static ones."""
        return np.array([self.row.get(n, -1) for n in self.cache.index.colliders], dtype=np.int64)

    @cached_property
    def friction(self) -> tuple[F64, F64]:
        """Least and greatest friction coefficient of every contact, each shape (contacts,)."""
        low, high = frictions(self.candidate, self.cache.index.colliders)
        return low[self.contacts.a, self.contacts.b], high[self.contacts.a, self.contacts.b]

    @cached_property
    def contact_budget(self) -> F64:
        """Most that the logged contacts can have changed each entity's momentum [N s], shape (F - 1, E)."""
        return self._on_entities(np.abs(self.contacts.impulse) * np.sqrt(1.0 + self.friction[1] ** 2))

    @cached_property
    def contact_given(self) -> F64:
        """Impulse of the logged contacts on each entity, friction included [N s], shape (F - 1, E, 3)."""
        found, result = self.contacts, np.zeros((self.frames - 1, len(self.entities), 3))
        for side, sign in ((found.a, -1.0), (found.b, 1.0)):
            rows = self.collider_row[side]
            good = (rows >= 0) & (found.a != found.b)
            np.add.at(result, (found.frame[good] - 1, rows[good]), sign * found.given[good])
        return result

    @cached_property
    def logged_impulse(self) -> F64:
        """Logged normal impulses on each entity [N s], shape (F - 1, E)."""
        return self._on_entities(self.contacts.impulse)

    def _on_entities(self, values: F64) -> F64:
        """Sum of a value per contact over the contacts of each entity with others, shape (F - 1, E)."""
        found = self.contacts
        result = np.zeros((self.frames - 1, len(self.entities)))
        for side, other in ((found.a, found.b), (found.b, found.a)):
            rows = self.collider_row[side]
            good = (rows >= 0) & (side != other)
            np.add.at(result, (found.frame[good] - 1, rows[good]), values[good])
        return result

    @cached_property
    def touched(self) -> Flags:
        """True where a contact of the entity with another is logged in the interval, shape (F - 1, E)."""
        result = np.zeros((self.frames - 1, len(self.entities)), dtype=bool)
        for side, other in ((self.contacts.a, self.contacts.b), (self.contacts.b, self.contacts.a)):
            rows = self.collider_row[side]
            good = (rows >= 0) & (side != other)
            result[self.contacts.frame[good] - 1, rows[good]] = True
        return result

    @cached_property
    def dozing(self) -> Flags:
        """True where a body of the entity sleeps at an end of the interval, shape (F - 1, E): its contacts are then not all logged."""
        asleep = np.zeros((self.frames, len(self.entities)), dtype=bool)
        for body, owner in enumerate(self.owner):
            asleep[:, owner] |= self.asleep[:, body]
        return asleep[:-1] | asleep[1:]

    @cached_property
    def napping(self) -> Flags:
        """True where the entity may have slept and woken within the interval, shape (F - 1, E): slow at an end, and of an assembly that is in
        contact for at least the steps that the engine waits before it puts it to sleep; what joints hold together sleeps as one."""
        label, _ = self.assemblies
        groups = int(label.max(initial=-1)) + 1
        known, budget, touched = np.zeros(groups), np.zeros(groups), np.zeros(groups, dtype=bool)
        np.add.at(known, label, np.linalg.norm(self.known_impulse, axis=2))
        np.add.at(budget, label, self.contact_budget)
        np.logical_or.at(touched, label, self.touched)
        long = touched & (budget >= NAP_STEPS * self.step / self.duration * known)
        result: Flags = self._may_sleep & _slow(self.velocities) & long[label]
        return result

    @cached_property
    def napping_bodies(self) -> Flags:
        """Bodies that may have slept and woken within the interval, shape (F - 1, n): slow at an end, and of an entity that touched
        something, itself included."""
        touched = self.touched.copy()
        for side in (self.contacts.a, self.contacts.b):
            rows = self.collider_row[side]
            touched[self.contacts.frame[rows >= 0] - 1, rows[rows >= 0]] = True
        result: Flags = self._may_sleep & _slow(self.velocity) & touched[:, self.owner]
        return result

    @property
    def _may_sleep(self) -> bool:
        return self.candidate.spec.simulation.rigid[self.cache.index.solver].settings.sleep

    # ---------------------------------------------------------------- joints

    @cached_property
    def assemblies(self) -> tuple[NDArray[np.int64], Flags]:
        """Entities joined by joints, per interval: label, shape (F - 1, E), and whether fixed to something that does not move freely."""
        return assemblies_of(self)

    @cached_property
    def jointed(self) -> Flags:
        """Entities that a joint or a rope's end touches, shape (E,)."""
        result = np.zeros(len(self.entities), dtype=bool)
        for _, parent, child in joined(self):
            for side in (parent, child):
                if side is not None:
                    result[side] = True
        return result

    @cached_property
    def lone(self) -> Flags:
        """Free entities of one body that no joint and no spring touches, shape (E,)."""
        sprung = np.zeros(len(self.entities), dtype=bool)
        for spring in self.springs:
            for row in (spring.child, spring.parent):
                if row is not None:
                    sprung[row] = True
        result: Flags = self.single & ~self.jointed & ~sprung & ~self.kinematic
        return result


def _slow(velocity: F64) -> Flags:
    """True where a speed [m/s], of velocities of shape (F, n, 3), is below `NAP_SPEED` at either end of an interval, shape (F - 1, n)."""
    speed = np.linalg.norm(velocity, axis=2)
    return np.asarray(np.minimum(speed[:-1], speed[1:]) < NAP_SPEED)
