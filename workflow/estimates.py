"""Estimate of the time that work will take: from rates measured before it, and from its own pace once it runs."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..execution import JobStore
    from ..worlds.spec import WorldSpec
    from .session import Session

__all__ = [
    "Pace",
    "bake_estimate",
    "film_estimate",
]

SEEN_JOBS = 200


class Pace:
    """Passes progress on and measures its pace, from the steps of this run alone: what a resumed job finds done took it no time.

    How long the whole job will take is told by its worker, which knows how the checks after the frames went last time.

    Args:
        report: takes (done, total, message).
    """

    def __init__(self, report: Callable[[float, float, str], None]) -> None:
        self._report = report
        self._first: tuple[float, float] | None = None
        self.reports = 0
        """Number of reports: fewer than steps where some were done before."""
        self.seconds_per_step: float | None = None
        """Mean over the steps seen; None before the second report."""

    def __call__(self, done: float, total: float, message: str) -> None:
        """Pass a report on."""
        now = time.monotonic()
        self.reports += 1
        if self._first is None:
            self._first = (done, now)
        elif done > self._first[0]:
            self.seconds_per_step = (now - self._first[1]) / (done - self._first[0])
        self._report(done, total, message)


def bake_estimate(session: Session, record: dict[str, Any]) -> float | None:
    """Seconds that a bake with its checks will take, by the pace of its probe; None where that was not measured.

    A bake simulates and judges the frames; what the probe simulated once more to judge its causes, the bake leaves out.
    """
    simulated, judged = record["detail"].get("simulated_s"), record["detail"].get("judged_s")
    frames = record["detail"].get("frames")
    if not simulated or judged is None or not frames:
        return None
    # Particles and steps that a coarser probe did without.
    finer = float(record["detail"].get("coarser", 1.0)) ** 4
    per_frame = (finer * float(simulated) + float(judged)) / float(frames)
    return round(per_frame * session.spec.simulation.frames, 1)


def usual_seconds(spec: WorldSpec, frames: int) -> float | None:
    """Seconds that a world will take for so many frames by the usual rates of its categories; None where none is known."""
    from ..worlds.categories.registry import CATEGORIES

    known = [s for s in (category.seconds(spec) for category in CATEGORIES.values()) if s is not None]
    return round(sum(known) * (frames / spec.simulation.frames), 1) if known else None


def film_estimate(jobs: JobStore, *, frames: int, width: int, height: int, samples: int) -> float | None:
    """Seconds that a film will take, by the pace of the last film of this workspace for each path; None before the first."""
    for job in jobs.list(limit=SEEN_JOBS):
        past = job.result or {}
        if job.kind == "final" and job.state == "done" and past.get("seconds_per_frame"):
            paths = past["width"] * past["height"] * past["samples"]
            rate = float(past["seconds_per_frame"]) / float(paths)
            return round(rate * frames * width * height * samples, 1)
    return None
