"""The account as a text of at most 2,500 characters: things, what acts, a time line; what does not fit is counted."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...worlds.errors import EvidenceError
from ...worlds.quoting import listed
from .causes import driver_lines, gravity_words, joint_lines, start_lines
from .courses import MOVING, TIPPED, TURNED, Course
from .meetings import Meeting, endings, meetings, ruptures
from .things import Group, things_of
from .wording import number, place, seconds, towards

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate

__all__ = ["MOST_CHARACTERS", "Account", "account_of"]

MOST_CHARACTERS = 2500
"""Own choice: what a reader takes in at once, about 700 tokens beside six pictures."""
COUNTED = 3
"""Own choice: more members, or pairs, than this of one kind are told together."""
LEAST_WAY = 0.005
"""[m] Own choice: half a centimetre, the least fall, rise or way that is told in numbers."""
TOUCHED = 4
"""Own choice: most things that one is told to touch at the end."""
TURNS = 0.5
"""Own choice: least rotation that is told as turning [turns]."""


class _Line(NamedTuple):
    section: str
    time: float
    text: str


@dataclass(frozen=True)
class Account:
    """A text about a candidate for somebody who did not make it."""

    text: str
    left_out: dict[str, int]
    """Lines that did not fit, by section."""

    @property
    def digest(self) -> str:
        """SHA-256 of the text, hex."""
        return hashlib.sha256(self.text.encode()).hexdigest()


def account_of(candidate: Candidate) -> Account:
    """The account, the same bytes every time; no id, name or text of the specification is in it.

    Raises:
        EvidenceError: nothing is built, or a channel is missing or damaged.
    """
    groups = things_of(candidate)
    if not groups:
        raise EvidenceError("the world has no entities that are judged; call edit_spec")
    of = {entity: group for group in groups for entity in group.members}

    def label(entity: str) -> str:
        return of[entity].label(entity) if entity in of else "something"

    met = [m for m in meetings(candidate) if m.a in of and m.b in of]
    ended = endings(candidate, met)
    happened = ruptures(candidate)
    lists = [
        [_Line("Things", 0.0, g.line()) for g in groups],
        [_Line("What acts", 0.0, line) for line in driver_lines(candidate, label)],
        [_Line("What acts", 0.0, line) for line in start_lines(candidate, groups)],
        [_Line("Time line", r.first, _rupture(r.first, r.last, label(r.entity), r.text, r.cause, label)) for r in happened],
        list(_motions(candidate, groups, ended, label)),
        list(_meetings(met, of, label)),
        [_Line("What acts", 0.0, line) for line in joint_lines(candidate, label)],
    ]
    return _fitted(_head(candidate, groups), lists)


def _head(candidate: Candidate, groups: Sequence[Group]) -> str:
    count, plan = sum(len(g.members) for g in groups), candidate.spec.simulation
    span = f"{candidate.frame_count} frames, {number(candidate.last_frame / plan.fps)} s"
    return f"{count} things, {span}; {gravity_words(candidate)}; x, y, z in m, z up; sizes largest first, of round things the diameter"


def _fitted(head: str, lists: Sequence[Sequence[_Line]]) -> Account:
    """As many lines as fit, one of each list in turn, the first of each first; then in the order of sections and of time."""
    ranked = [line for k in range(max(map(len, lists))) for found in lists if k < len(found) for line in (found[k],)]
    sections = ("Things", "What acts", "Time line")
    room = MOST_CHARACTERS - len(head) - sum(len(s) + 3 for s in sections) - 120
    kept: list[_Line] = []
    left_out: dict[str, int] = {}
    for line in ranked:
        if len(line.text) + 3 <= room:
            room -= len(line.text) + 3
            kept.append(line)
        else:
            left_out[line.section] = left_out.get(line.section, 0) + 1
    told = [head]
    for section in sections:
        own = [line for line in kept if line.section == section]
        own = sorted(own, key=lambda line: line.time) if section == "Time line" else own
        told += [f"{section}:", *(f"- {line.text}" for line in own)] if own else []
    if left_out:
        told.append("Left out: " + ", ".join(f"{count} lines of {name!r}" for name, count in left_out.items()))
    return Account("\n".join(told), left_out)


def _rupture(first: float, last: float, whom: str, text: str, cause: str | None, label: Callable[[str], str]) -> str:
    by = "" if cause is None else f", loaded by {label(cause)}"
    return f"{seconds(first)} to {seconds(last)} s: {whom} {text}{by}"


def _motions(
    candidate: Candidate, groups: Sequence[Group], ended: dict[str, list[str]], label: Callable[[str], str]
) -> Iterator[_Line]:
    """Lines of things that move, most energy first; then of free ones that stay where they are."""
    end = candidate.last_frame / candidate.spec.simulation.fps
    for group in groups:
        moving = [m for m in group.members if group.courses[m].first is not None]
        if len(moving) > COUNTED:
            yield _together(group, moving, end)
            continue
        for member in moving:
            course = group.courses[member]
            touched = sorted({label(o) for o in ended.get(member, ())})
            at = f"{seconds(course.first or 0.0)} to {seconds(end if course.rest is None else course.rest)} s"
            last = f"ends at {place(course.end)}" + (f" touching {listed(touched, TOUCHED)}" if touched else "")
            if course.rest is None:
                last += f", still moving with {number(course.end_speed)} m/s"
            deeds = ", ".join(_deeds(course, upright=group.form.word != "ball"))
            yield _Line("Time line", course.first or 0.0, f"{at}: {label(member)} {deeds}; {last}")
    still = [g.title for g in groups if not g.moves and any(candidate.spec.entities[m].motion == "dynamic" for m in g.members)]
    if still and candidate.stage != "static":
        yield _Line("Time line", end, f"all the time: {', '.join(still)} {'stay' if len(still) > 1 else 'stays'} in place")


def _deeds(course: Course, *, upright: bool) -> Iterator[str]:
    if course.fall >= LEAST_WAY:
        yield f"falls {number(course.fall)} m"
    if course.rise >= LEAST_WAY:
        yield f"rises {number(course.rise)} m"
    way = float(np.linalg.norm(course.way))
    if way >= LEAST_WAY:
        yield f"goes {number(way)} m towards {towards(course.way)}"
    if upright and course.angle > TURNED:
        back = "" if course.end_angle > 0.9 * course.angle else f", at the end {np.degrees(course.end_angle):.0f}"
        yield f"tips by {np.degrees(course.angle):.0f} degrees{back}"
    if course.turns >= TURNS:
        yield f"turns {number(course.turns)} times in all"
    yield f"up to {number(course.speed)} m/s"


def _together(group: Group, moving: Sequence[str], end: float) -> _Line:
    """One line for many alike things."""
    courses = [group.courses[m] for m in moving]
    first = min(c.first or 0.0 for c in courses)
    started = max(c.first or 0.0 for c in courses)
    rest = [end if c.rest is None else c.rest for c in courses]
    told = [f"{len(moving)} of {len(group.members)} move, the first at {seconds(first)}, the last from {seconds(started)} s on"]
    tipped = sum(c.angle > TIPPED for c in courses)
    if tipped:
        told.append(f"{tipped} tip by more than {np.degrees(TIPPED):.0f} degrees")
    falls = sorted(c.fall for c in courses if c.fall >= LEAST_WAY)
    if falls:
        told.append(f"{len(falls)} fall, by {number(falls[0])} to {number(falls[-1])} m")
    told.append(f"up to {number(max(c.speed for c in courses))} m/s")
    later = sum(c.rest is None and c.end_speed > MOVING for c in courses)
    told.append(f"{later} still move at the end" if later else "all at rest at the end")
    return _Line("Time line", first, f"{seconds(first)} to {seconds(max(rest))} s: {group.title}: {', '.join(told)}")


def _meetings(met: Iterable[Meeting], of: dict[str, Group], label: Callable[[str], str]) -> Iterator[_Line]:
    """Who met whom, hardest first; pairs of two kinds that are many together; what touches from the start last."""
    kinds: dict[tuple[str, str, bool], list[Meeting]] = {}
    for meeting in met:
        one, two = sorted((of[meeting.a].title, of[meeting.b].title))
        kinds.setdefault((one, two, meeting.from_start), []).append(meeting)
    lines = []
    for (one, two, from_start), found in kinds.items():
        weight = max(m.hardest * max(m.speed, MOVING) for m in found)
        if len(found) > COUNTED:
            lines.append((from_start, weight, _many(one, two, found, label, from_start=from_start)))
        else:
            lines += [(from_start, m.hardest * max(m.speed, MOVING), _one(m, of, label)) for m in found]
    lines.sort(key=lambda line: (line[0], -float(f"{line[1]:.2e}"), line[2].text))
    yield from (line for _, _, line in lines)


def _one(meeting: Meeting, of: dict[str, Group], label: Callable[[str], str]) -> _Line:
    if meeting.from_start:
        one, two = sorted((label(meeting.a), label(meeting.b)))
        return _Line("Time line", 0.0, f"from the start: {one} touches {two}")

    def moved(entity: str) -> tuple[float, str]:
        first = of[entity].courses[entity].first
        return (np.inf if first is None else first, label(entity))

    one, two = sorted((meeting.a, meeting.b), key=moved)
    how = f"hits {label(two)} at up to {number(meeting.speed)} m/s" if meeting.speed > MOVING else f"touches {label(two)}"
    often = f", {len(meeting.begins)} contacts until {seconds(meeting.begins[-1])} s" if len(meeting.begins) > 1 else ""
    # What heats a body, or makes dust or steam of it, has no impulse to tell: its push counts as without end.
    hard = f", {number(meeting.impulse)} N s in all" if np.isfinite(meeting.impulse) else ""
    return _Line("Time line", meeting.first, f"{seconds(meeting.first)} s: {label(one)} {how}{often}{hard}")


def _many(one: str, two: str, found: Sequence[Meeting], label: Callable[[str], str], *, from_start: bool) -> _Line:
    pair = [" and ".join(sorted((label(m.a), label(m.b)))) for m in (found[0], found[-1])]
    whom = f"{one} among themselves" if one == two else f"{one} and {two}"
    if from_start:
        return _Line("Time line", 0.0, f"from the start: {whom} touch in {len(found)} pairs")
    speed = max(m.speed for m in found)
    hit = f" at up to {number(speed)} m/s" if speed > MOVING else ""
    times = f"first {pair[0]} at {seconds(found[0].first)}, last {pair[1]} at {seconds(found[-1].first)} s"
    return _Line("Time line", found[0].first, f"{seconds(found[0].first)} s on: {whom} meet in {len(found)} pairs{hit}, {times}")
