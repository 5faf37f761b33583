"""Who touched whom, when and how hard, by the pushes that the records tell; what broke and what tore."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from ..categories.registry import JUDGES
from ..ledgers import motion

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ..categories.judge import Rupture

__all__ = ["Meeting", "endings", "meetings", "ruptures"]

LEAST = 1e-6
"""[N s] Own choice: 1 mm/s of a 1 g body; smaller pushes are of matter that only comes near (as in chains of pushes)."""


@dataclass
class Meeting:
    """Two entities, in the order of their names, and the pushes between them."""

    a: str
    b: str
    first: float
    """[s]"""
    from_start: bool
    """True if they touch from the first frame on."""
    impulse: float = 0.0
    """Sum of all pushes [N s]."""
    hardest: float = 0.0
    """Within a frame [N s]."""
    hardest_at: float = 0.0
    speed: float = 0.0
    """Greatest closing speed of a contact that began [m/s]; 0 where no log tells."""
    last: int = 0
    """Last frame with a push."""
    begins: list[float] = field(default_factory=list)
    """Times at which contacts began after frame 0 [s]."""


def meetings(candidate: Candidate) -> list[Meeting]:
    """All pairs that pushed each other, by first time.

    Raises:
        EvidenceError: a channel is missing or damaged.
    """
    found: dict[tuple[str, str], Meeting] = {}
    if candidate.stage == "static":
        return []
    for judge in JUDGES.values():
        for frame, pushes in enumerate(judge.pushes(candidate)):
            within: dict[tuple[str, str], float] = {}
            for push in pushes:
                if push.a == push.b or push.impulse <= LEAST:
                    continue
                pair = min(push.a, push.b), max(push.a, push.b)
                if pair not in found:
                    found[pair] = Meeting(*pair, max(0.0, push.begin), push.begin <= 0.0 or frame == 0)
                within[pair] = within.get(pair, 0.0) + push.impulse
            for pair, impulse in within.items():
                meeting = found[pair]
                meeting.impulse, meeting.last = meeting.impulse + impulse, frame
                if impulse > meeting.hardest:
                    meeting.hardest, meeting.hardest_at = impulse, frame / candidate.spec.simulation.fps
    _add_speeds(candidate, found)
    return sorted(found.values(), key=lambda m: m.first)


def _add_speeds(candidate: Candidate, found: dict[tuple[str, str], Meeting]) -> None:
    """Closing speeds and beginnings of logged contacts."""
    for cache in candidate.rigid_caches.values():
        names = cache.index.colliders
        for log in cache.ragged("event/time", "event/pair", "event/speed")[: candidate.frame_count]:
            for time, (i, j), speed in zip(
                log["event/time"].tolist(), log["event/pair"].tolist(), log["event/speed"].tolist(), strict=True
            ):
                meeting = found.get((min(names[i], names[j]), max(names[i], names[j])))
                if meeting is not None and time > 0.0:
                    meeting.begins.append(float(time))
                    meeting.speed = max(meeting.speed, float(speed))


def ruptures(candidate: Candidate) -> list[Rupture]:
    """Everything that broke or tore, by first time.

    Raises:
        EvidenceError: a channel is missing or damaged.
    """
    if candidate.stage == "static":
        return []
    return sorted((r for judge in JUDGES.values() for r in judge.ruptures(candidate)), key=lambda r: r.first)


def endings(candidate: Candidate, found: list[Meeting]) -> dict[str, list[str]]:
    """Entities that each one touches at the end: of what sleeps, those that it touched before, since its contacts are logged no more."""
    last: dict[str, int] = {}
    for meeting in found:
        for entity in (meeting.a, meeting.b):
            last[entity] = max(last.get(entity, 0), meeting.last)
    ended: dict[str, list[str]] = {}
    for meeting in found:
        for entity, other in ((meeting.a, meeting.b), (meeting.b, meeting.a)):
            awake = last[entity] == candidate.last_frame or not _asleep(candidate, entity)
            if meeting.last == (candidate.last_frame if awake else last[entity]):
                ended.setdefault(entity, []).append(other)
    return ended


def _asleep(candidate: Candidate, entity: str) -> bool:
    return candidate.moves(entity) and entity not in candidate.deforming and bool(motion.asleep(candidate, entity)[-1])
