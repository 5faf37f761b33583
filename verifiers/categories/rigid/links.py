"""Which bodies belong together: owners, and contacts and joints as links of causal chains, by their logs (R96, R97)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ....worlds.spec import DetachDriver
from ..judge import Push, Tie

if TYPE_CHECKING:
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate
    from ....worlds.spec import WorldSpec

__all__ = ["contact_pushes", "owners", "ties"]


def owners(cache: Cache) -> list[str]:
    """Entity of every body of a cache."""
    return [name.split("/", 1)[0] for name in cache.index.bodies]


def contact_pushes(candidate: Candidate) -> list[list[Push]]:
    """Contacts per frame.

    A contact that lasts from the frame before carries all the time; a new one from its event on, or, if it has ended by
    the next frame, at its event only.
    """
    found: list[list[Push]] = [[] for _ in range(candidate.frame_count)]
    for cache in candidate.rigid_caches.values():
        contacts = cache.ragged("contact/pair", "contact/impulse")
        logs = cache.ragged("event/time", "event/pair", "event/impulse")
        totals = [
            {tuple(p): float(j) for p, j in zip(c["contact/pair"].tolist(), c["contact/impulse"], strict=True)} for c in contacts
        ]
        for frame in range(candidate.frame_count):
            events: dict[tuple[int, int], list[tuple[float, float]]] = {}
            log = logs[frame]
            for time, pair, impulse in zip(log["event/time"], log["event/pair"].tolist(), log["event/impulse"], strict=True):
                events.setdefault(tuple(pair), []).append((float(time), float(impulse)))
            for pair in {**totals[frame], **events}:
                found[frame] += _pushes(cache, totals, frame, pair, events.get(pair, []), candidate.spec.simulation.fps)
    return found


def _pushes(
    cache: Cache,
    totals: list[dict[tuple[int, int], float]],
    frame: int,
    pair: tuple[int, int],
    events: list[tuple[float, float]],
    fps: int,
) -> list[Push]:
    """Pushes of one pair in a frame: impulses by pair of every frame, beginnings of contacts in this one with their impulses."""
    a, b = (cache.index.colliders[k] for k in pair)
    start, end, total = (frame - 1) / fps, frame / fps, totals[frame].get(pair)
    first = events[0][1] if events else 0.0
    if not events or (frame > 0 and pair in totals[frame - 1]):
        return [Push(a, b, start, end, first if total is None else total)]
    single = len(events) == 1
    found = [Push(a, b, t, t, j if total is None or not single else total) for t, j in events]
    if frame + 1 < len(totals) and pair in totals[frame + 1]:
        found.append(Push(a, b, events[0][0], end, first if total is None else total))
    return found


def ties(spec: WorldSpec) -> list[Tie]:
    """Ends of joints, springs and ropes, and until when they hold [s]; None is the world."""
    opened = {d.joint: d.time for d in spec.simulation.drivers.values() if isinstance(d, DetachDriver)}
    found: list[Tie] = [(j.parent, j.child, opened.get(name, float("inf"))) for name, j in spec.simulation.joints.items()]
    for name, entity in spec.entities.items():
        if entity.generator is not None:
            found += [(name, to, float("inf")) for to in (entity.generator.attach_start, entity.generator.attach_end)]
    return found
