"""Promises of a probe about its bake: the frames at which beats come true (R78)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from ..verifiers.rows.answers import row_of
from ..verifiers.rows.findings import Finding
from ..verifiers.story.questions import PROMISE

if TYPE_CHECKING:
    from ..worlds.candidate import Candidate
    from ..worlds.requirements import Row

__all__ = ["broken_promises", "promise_row"]

LATE = 0.15
"""Own choice: share of the time since frame 0 by which a beat may come earlier or later than a coarser probe had it. Fronts of
liquid resolved half as finely are some per cent late; beats that come true in another order are a broken promise in any case."""
LATE_FRAMES = 2
"""Never less."""
Events = Mapping[str, int | None]
"""First frame at which each beat is true; None where it never is."""


def broken_promises(promised: Events, found: Events, *, coarse: bool) -> list[str]:
    """Beats that do not come true as promised: at the very frame, or after a coarser probe, about then and in the same order."""
    if not coarse:
        return sorted(k for k in promised if promised[k] != found.get(k))
    wrong = set()
    for name, frame in promised.items():
        there = found.get(name)
        if frame is None or there is None:
            wrong |= {name} if frame is not there else set()
        elif abs(there - frame) > max(LATE_FRAMES, LATE * frame):
            wrong.add(name)
    known = {k: (p, f) for k, p in promised.items() if p is not None and (f := found.get(k)) is not None}
    for a, (first, here) in known.items():
        for b, (later, there) in known.items():
            if first < later and here > there:
                wrong |= {a, b}
    return sorted(wrong)


def promise_row(candidate: Candidate, promised: Events, found: Events, overrides: Mapping[str, float]) -> Row:
    """The row of a bake about what its probe promised.

    Args:
        candidate: the bake.
        promised: events of the probe.
        found: those of the bake.
        overrides: what the probe left coarser; empty where it ran at production settings.
    """
    different = broken_promises(promised, found, coarse=bool(overrides))
    about = f"within {LATE:.0%} of the time and in the order" if overrides else "at the frames"
    found_out = Finding(
        "fail" if different else "pass",
        f"{', '.join(different)} came otherwise" if different else f"{len(promised)} beats came as promised",
        float(len(different)),
        0.0,
        evidence={
            "promised": promised,
            "found": found,
            **({"different": different, "probe_overrides": overrides} if overrides else {}),
        },
        predicate=f"beats come true {about} that the probe of these settings promised",
    )
    return row_of(candidate, PROMISE, (), found_out, extra=promised)
