"""Numerical questions that compare a cache with itself: counters, logs, repeated frames, bodies that sleep."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ....worlds.arrays import F64
from ....worlds.errors import EvidenceError
from ....worlds.spec import ReleaseDriver
from ...contact.log import log_fault
from ...ledgers.balance import books_of, frictions
from ...ledgers.exchanged import exchange_steps
from ...rows.corrections import bake_again, halve_step, separate
from ...rows.findings import Finding
from ...scene.surfaces import Surfaces, surfaces_of
from .bounds import ASLEEP_CREEP, ASLEEP_SPEED, SPIKE, STILL, TIME

if TYPE_CHECKING:
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate
    from ...ledgers.balance import Books

__all__ = ["counters", "events", "frozen", "resting", "spike"]


_COUNTS = ("steps", "iterations_max", "iterations_capped", "contacts_max", "overflows")


def counters(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    """Steps cover the frame at no more than the planned step, and no counter is impossible."""
    settings = candidate.spec.simulation.rigid[solver].settings
    values = {n: np.asarray(cache.series(f"record/{n}"), dtype=np.float64) for n in (*_COUNTS, "step")}
    h = 1.0 / cache.index.fps
    steps, step = values["steps"], values["step"]
    with np.errstate(invalid="ignore", divide="ignore"):
        needed = np.ceil(h / np.maximum(step, 1e-12) * (1 - 1e-6))
        drivers = 2 * len(candidate.spec.simulation.drivers) + len(candidate.spec.entities)
        cuts = exchange_steps(candidate, solver)
        faults = {
            "a counter is negative or no whole number": np.any(
                [~((values[n] >= 0) & (values[n] == np.floor(values[n]))) for n in _COUNTS], axis=0
            ),
            "the step is longer than planned": ~(step <= settings.step * (1 + 1e-9)),
            "the step is shorter than refinement makes it": ~(step >= settings.step / 2**settings.refine * (1 - 1e-9)),
            "steps do not cover the frame": ~(steps >= needed),
            "steps are more than the frame holds": ~(steps <= needed + drivers + 1 + cuts),
            "more steps at the cap than steps": ~(values["iterations_capped"] <= np.maximum(steps, 0)),
            "more iterations than the cap": ~(values["iterations_max"] <= settings.iterations),
            "the count of warnings falls": np.diff(values["overflows"], prepend=values["overflows"][0]) < 0,
        }
    for name in ("steps do not cover the frame", "steps are more than the frame holds"):
        faults[name] = np.concatenate([[False], faults[name][1:]])  # frame 0 is a state, no interval
    first = {name: int(np.argmax(wrong)) for name, wrong in faults.items() if wrong.any()}
    wrong = sum(int(w.sum()) for w in faults.values())
    if not first:
        return Finding("pass", f"{steps[1:].sum():.0f} steps cover {cache.index.frames - 1} intervals", 0.0, 0.0, "frames")
    name = min(first, key=lambda n: first[n])
    k = first[name]
    shown = ", ".join(f"{n} {values[n][k]:g}" for n in values)
    hints = (
        bake_again("the records do not belong to these settings"),
        halve_step(candidate, solver, "frames were run with too long a step"),
    )
    return Finding("fail", f"{name} at frame {k} ({shown})", float(wrong), 0.0, "frames", None, k, hints)


def events(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    """Logged contacts and events have possible indices, times, impulses."""
    contact = [f"contact/{n}" for n in ("pair", "impulse", "vector", "max_force", "min_gap")]
    event = [f"event/{n}" for n in ("time", "pair", "point", "speed", "impulse")]
    h, size = 1.0 / cache.index.fps, len(cache.index.colliders)
    count = 0
    for k, log in enumerate(cache.ragged(*contact, *event, raw=True)):
        contacts, begun = len(log["contact/impulse"]), len(log["event/time"])
        count += contacts + begun
        pairs = np.concatenate([log["contact/pair"].reshape(-1, 2), log["event/pair"].reshape(-1, 2)])
        time = log["event/time"]
        faults = {
            "contact channels differ in length": any(len(log[n]) != contacts for n in contact),
            "event channels differ in length": any(len(log[n]) != begun for n in event),
            "a pair names a collider that is not there": bool(len(pairs)) and bool((pairs.min() < 0) or (pairs.max() >= size)),
            "a pair is not in order": bool((pairs[:, 0] > pairs[:, 1]).any()),
            "an impulse or force is negative": any(bool((log[n] < 0).any()) for n in (contact[1], contact[3], event[4])),
            "an event lies outside its frame": bool(begun)
            and not bool(((time > (k - 1) * h - TIME) & (time <= k * h + TIME)).all()),
            "events are not in order of time": bool((np.diff(time) < 0).any()),
        }
        wrong = next((text for text, bad in faults.items() if bad), None)
        if wrong is not None:
            entity = None
            inside = pairs[(pairs >= 0).all(axis=1) & (pairs < size).all(axis=1)] if pairs.ndim == 2 else pairs
            if len(inside):
                entity = cache.index.colliders[int(inside[0, 0])]
                movers = [
                    cache.index.colliders[int(i)]
                    for i in inside.ravel()
                    if cache.body_row(cache.index.colliders[int(i)]) is not None
                ]
                entity = movers[0] if movers else entity
            return Finding(
                "fail", f"{wrong} at frame {k}", 1.0, 0.0, "frames", entity, k, (bake_again("the contact log was edited"),)
            )
    step = candidate.spec.simulation.rigid[solver].settings.step
    rough = frictions(candidate, cache.index.colliders)[1]
    let_go = _let_go(candidate, cache)
    wrong_log = log_fault(cache.ragged(*contact, *event), h, _sleepers(cache), step, rough, let_go=let_go)
    if wrong_log is not None:
        colliders = [cache.index.colliders[i] for i in wrong_log.pair]
        moving = [n for n in colliders if any(b.startswith(f"{n}/") for b in cache.index.bodies)]
        text = f"{' and '.join(colliders)} at frame {wrong_log.frame}: {wrong_log.text}"
        hints = (bake_again("the contact log was edited"),)
        where = (moving or colliders)[0], wrong_log.frame
        return Finding("fail", text, wrong_log.measured, wrong_log.bound, "N s", *where, hints)
    return Finding("pass", f"{count} logged contacts and events", 0.0, 0.0, "frames")


def _sleepers(cache: Cache) -> list[frozenset[int]]:
    """Colliders that sleep at each frame, or have slept or woken within the frame before it."""
    rank = {n: i for i, n in enumerate(cache.index.colliders)}
    owners = [rank.get(b.split("/", 1)[0], -1) for b in cache.index.bodies]
    # A row too many or too few is told by `numerical:finite`.
    return [frozenset(o for o, s in zip(owners, row, strict=False) if s) for row in np.asarray(cache.series("asleep"))]


def _let_go(candidate: Candidate, cache: Cache) -> dict[int, frozenset[int]]:
    """By frame, colliders of the entities that a release lets go within it; at a frame's own time it acts in the next."""
    found: dict[int, frozenset[int]] = {}
    for driver in candidate.spec.simulation.drivers.values():
        if isinstance(driver, ReleaseDriver) and driver.entity in cache.index.colliders:
            frame = math.floor(driver.time * cache.index.fps + TIME) + 1
            found[frame] = found.get(frame, frozenset()) | {cache.index.colliders.index(driver.entity)}
    return found


def frozen(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    """No free body that moves is at the same place at two frames, to the last bit."""
    books = books_of(candidate, cache)
    speed = np.linalg.norm(books.velocity, axis=2)
    fast = (np.minimum(speed[:-1], speed[1:]) > STILL) & (books.free_time[:, books.owner] > 0)
    same = (np.diff(books.position, axis=0) == 0).all(axis=2) & (np.diff(books.quaternion, axis=0) == 0).all(axis=2)
    bad = fast & same
    count = float(np.count_nonzero(bad))
    if not bad.any():
        return Finding(
            "pass", f"{int(np.count_nonzero(fast))} moves between frames, none of them repeats a pose", 0.0, 0.0, "poses"
        )
    k = int(np.argmax(bad.any(axis=1)))
    name = books.entities[int(books.owner[int(np.argmax(bad[k]))])]
    text = f"{name} moves at {speed[k + 1][bad[k]].max():.3g} m/s and is at frame {k + 1} where it was at frame {k}"
    return Finding("fail", text, count, 0.0, "poses", name, k + 1, (bake_again("a frame was written twice"),))


def spike(candidate: Candidate, solver: str, cache: Cache) -> tuple[int, float, float] | None:
    """First frame within which something was far faster than at its ends: frame, recorded peak and what frames show [m/s]."""
    books = books_of(candidate, cache)
    peak = np.asarray(cache.series("record/max_speed"), dtype=np.float64)
    speed = np.linalg.norm(books.velocity, axis=2).max(axis=1)
    way = np.linalg.norm(np.diff(books.body_centers, axis=0), axis=2).max(axis=1) / books.duration
    fall = float(np.linalg.norm(books.gravity)) * books.duration
    seen = np.maximum.reduce([speed[:-1], speed[1:], way]) + fall + STILL
    wrong = ~(peak[1:] <= SPIKE * seen)
    if not wrong.any():
        return None
    k = int(np.argmax(wrong))
    return k + 1, float(peak[k + 1]), float(seen[k])


# ---------------------------------------------------------------- sleep


def resting(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    """Sleeping bodies stay where they are, and something touches or holds them."""
    books = books_of(candidate, cache)
    free = ~books.kinematic[books.owner]
    until = books.released[books.owner]
    # The state at the very moment of release is still that of the hold.
    held = (until > 0.0) & (books.times[:, None] <= until + TIME)
    asleep = books.asleep & free & ~held
    if not asleep.any():
        return Finding("pass", "no free body sleeps", 0.0, ASLEEP_CREEP, "m")
    # What was stirred between two frames may have moved a little before it slept again.
    stays = asleep[:-1] & asleep[1:] & ~books.stirred[1:]
    way = np.where(stays, np.linalg.norm(np.diff(books.body_centers, axis=0), axis=2), 0.0)
    speed = np.where(asleep, np.linalg.norm(books.velocity, axis=2), 0.0)
    for values, bound, unit, what, shift in ((way, ASLEEP_CREEP, "m", "creeps", 1), (speed, ASLEEP_SPEED, "m/s", "moves at", 0)):
        wrong = values > bound
        if wrong.any():
            k = int(np.argmax(wrong.any(axis=1)))
            name = books.entities[int(books.owner[int(np.argmax(values[k]))])]
            text = f"{name} sleeps at frame {k + shift} and {what} {values[k].max():.3g} {unit}"
            return Finding("fail", text, float(values.max()), bound, unit, name, k + shift, (bake_again("the cache was edited"),))
    return _aloft(books, asleep, float(way.max(initial=0.0)))


def _aloft(books: Books, asleep: np.ndarray[tuple[int, ...], np.dtype[np.bool_]], creep: float) -> Finding:
    """Judge whether something touches every sleeping entity when it falls asleep and at the end of its sleep."""
    candidate = books.candidate
    naps = 0
    if np.linalg.norm(books.gravity) > 0:
        surfaces = surfaces_of(candidate)
        for row, name in enumerate(books.entities):
            mine = asleep[:, books.owner == row].any(axis=1)
            if not mine.any() or books.jointed[row] or _sprung(books, row):
                continue
            edges = np.flatnonzero(np.diff(mine.astype(int), prepend=0, append=0))
            for start, end in zip(edges[::2], edges[1::2] - 1, strict=True):
                naps += 1
                # A sleeping body stays where it is, so both ends of its sleep speak for all of it but for what moved away.
                for frame in sorted({int(start), int(end)}):
                    gap, other = _nearest(books, surfaces, name, frame)
                    bound = (
                        surfaces.contact_gap(name, other) if other is not None else candidate.spec.simulation.limits.contact_gap
                    )
                    if not gap <= bound:
                        near = "nothing else is there" if other is None else f"the nearest surface, {other}, is {gap:.3g} m away"
                        hints = (bake_again("the cache was edited"), separate(name))
                        return Finding(
                            "fail",
                            f"{name} sleeps at frame {frame} and {near}",
                            gap if math.isfinite(gap) else None,
                            bound,
                            "m",
                            name,
                            frame,
                            hints,
                        )
    return Finding("pass", f"{naps} sleeps, each in touch with something", creep, ASLEEP_CREEP, "m")


def _sprung(books: Books, row: int) -> bool:
    return any(row in (s.child, s.parent) for s in books.springs)


def _nearest(books: Books, shared: Surfaces, name: str, frame: int) -> tuple[float, str | None]:
    """Least clearance of an entity to any other at one frame [m], and whose; boxes first."""
    found: tuple[float, str | None] = (math.inf, None)
    shared.require(name)
    low, high = _box(books, name, frame)
    order = []
    for other in shared.entities:
        if other == name:
            continue
        lo, hi = _box(books, other, frame)
        apart = float(np.linalg.norm(np.maximum(np.maximum(low - hi, lo - high), 0.0)))
        order.append((apart, other))
    for apart, other in sorted(order):
        if apart > found[0] or apart > 10 * books.candidate.spec.simulation.limits.contact_gap + shared.contact_gap(name, other):
            return found if found[1] is not None else (apart, other)
        gap = float(shared.gap(name, other, frame).distance)
        if gap < found[0]:
            found = (gap, other)
        if gap <= shared.contact_gap(name, other):
            return found
    return found


def _box(books: Books, name: str, frame: int) -> tuple[F64, F64]:
    points = [books.candidate.pose(name, frame, p.body).apply(p.render.vertices) for p in books.candidate.entity(name).parts]
    if not points:
        raise EvidenceError(f"entity {name!r} has no visible geometry; call place_object")
    every = np.concatenate(points)
    return every.min(axis=0), every.max(axis=0)
