"""Estimate of the time that work will take: from rates measured before it, and from its own pace once it runs."""

from __future__ import annotations

import json
import math
import statistics
import time
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from pathlib import Path

    from ..execution import JobStore
    from ..worlds.folder import WorldFolder
    from ..worlds.spec import WorldSpec
    from .session import Session

__all__ = [
    "Pace",
    "Usual",
    "bake_estimate",
    "film_estimate",
    "pace_seen",
    "probe_took",
    "spared_seconds",
    "still_estimate",
    "still_took",
    "usual_seconds",
]

SEEN_JOBS = 200
PACE = "pace.json"
"""Beside the pictures of a world: how fast its stills were rendered, and its probes simulated."""
START_S = 5.0
"""Start of a job's process, kernels from their cache, and geometry [s]. Own measurement."""
MANY_PIECES, HEAVIEST = 300, 3
"""Own choice: collision pieces of a world from which on a reply names the entities that have most, and how many of them."""
LAST_PROBES = 5
"""Own choice: probes whose pace tells how busy and how fast the machine is."""
CHECKS_S, CHECKS_SHARE = 1.5, 0.2
"""Time of the checks [s], and their share of the simulation. Own measurement: 0.05 to 1.5 over the recorded worlds, most where a body breaks."""


class Pace:
    """Passes progress on and measures its pace, from the steps of this run alone: what a resumed job finds done took it no time.

    How long the whole job will take is told by its worker, which knows how the checks after the frames went last time.

    Args:
        report: takes (done, total, message).
    """

    def __init__(self, report: Callable[[float, float, str], None]) -> None:
        self._report = report
        self._first: tuple[float, float] | None = None
        self._whole = 0
        self.reports = 0
        """Number of whole steps that were reported: fewer than all where some were done before."""
        self.seconds_per_step: float | None = None
        """Mean over the steps seen; None before the second report."""

    def __call__(self, done: float, total: float, message: str) -> None:
        """Pass a report on."""
        now = time.monotonic()
        if done >= self._whole + 1:
            self._whole = math.floor(done)
            self.reports += 1
        # What comes before the first step, as a preroll, says nothing of the pace of the steps.
        if self._first is None or (done <= self._first[0] and self.seconds_per_step is None):
            self._first = (done, now)
        elif done > self._first[0]:
            self.seconds_per_step = (now - self._first[1]) / (done - self._first[0])
        self._report(done, total, message)


def bake_estimate(session: Session, record: dict[str, Any]) -> float | None:
    """Seconds that a bake with its checks will take, by the pace of its probe; None where that was not measured.

    A bake takes the frames of a probe at production settings, simulates the others and judges all; what the probe simulated once more to
    judge its causes, the bake leaves out.
    """
    detail, total = record["detail"], session.spec.simulation.frames
    simulated, judged, frames = (detail.get(name) for name in ("simulated_s", "judged_s", "frames"))
    if not simulated or judged is None or not frames:
        return None
    # Particles and steps that a coarser probe did without.
    finer, new = float(detail.get("coarser", 1.0)) ** 4, total if detail.get("overrides") else total - frames
    return round((finer * float(simulated) * new + float(judged) * total) / float(frames), 1)


def spared_seconds(bake: Path, probe: Mapping[str, Any]) -> float:
    """Time [s] that frames took which a bake has from its probe, by the probe's pace; 0 where that was not measured.

    Args:
        bake: folder of the bake.
        probe: what the ledger says of the probe.
    """
    from ..simulation.origins import taken_in

    taken = [t.frames for t in taken_in(bake).values()]
    simulated, frames = probe.get("simulated_s"), probe.get("frames")
    return float(simulated) * min(taken) / float(frames) if taken and simulated and frames else 0.0


class Usual(NamedTuple):
    """Seconds of the parts of a probe by usual rates."""

    simulation: float
    checks: float
    reruns: float
    """Runs of the world without its causes, and those of robustness."""
    heaviest: tuple[str, ...] = ()
    """Entities with most collision pieces, in words, where there are many."""

    @property
    def whole(self) -> float:
        """All of it, with the start of its process and the building of its geometry [s]."""
        return round(START_S + self.simulation + self.checks + self.reruns, 1)

    def at(self, pace: float) -> Usual:
        """The same where work takes `pace` times as long as by the usual rates."""
        return self._replace(simulation=self.simulation * pace, checks=self.checks * pace, reruns=self.reruns * pace)

    @property
    def told(self) -> str:
        """Parts in words, for a reply."""
        again = f", {self.reruns:.0f} s runs without causes" if self.reruns >= 1 else ""
        pieces = f"; most collision pieces: {', '.join(self.heaviest)}" if self.heaviest else ""
        return f"the whole probe (simulation {self.simulation:.0f} s{again}, checks {self.checks:.0f} s{pieces})"


def usual_seconds(spec: WorldSpec, frames: int) -> Usual:
    """Seconds that a probe of so many frames will take by the usual rates of the categories of its world."""
    from ..worlds.categories.registry import CATEGORIES
    from ..worlds.rerun_time import rerun_seconds

    plan = spec.simulation
    seconds = plan.lead + (plan.frames - 1) / plan.fps
    rate = sum(category.seconds(spec) or 0.0 for category in CATEGORIES.values()) / max(seconds, 1.0 / plan.fps)
    simulation = rate * (plan.lead + (frames - 1) / plan.fps)
    reruns = rate * rerun_seconds(spec)
    return Usual(simulation, CHECKS_S + CHECKS_SHARE * simulation, reruns, _heaviest(spec))


def _heaviest(spec: WorldSpec) -> tuple[str, ...]:
    """Entities of rigid instances with most collision pieces; none where there are few in all."""
    from ..worlds.categories.registry import CATEGORIES

    pieces = {n: CATEGORIES[e.physics.category].pieces(e) for n, e in spec.entities.items()}
    if sum(pieces.values()) < MANY_PIECES:
        return ()
    return tuple(f"{n} {pieces[n]}" for n in sorted(pieces, key=lambda n: -pieces[n])[:HEAVIEST])


def pace_seen(jobs: JobStore, folder: WorldFolder | None = None) -> float:
    """Time that probes take over what is usual for them: of the world in `folder` by its last simulation, else of this workspace.

    Of a workspace it is the median of the last ones that ran to their end and passed; 1 before any.
    """
    own = None if folder is None else _kept(folder).get("over_usual")
    if own is not None:
        return own
    ratios = []
    for job in jobs.list(limit=SEEN_JOBS):
        usual, whole = job.payload.get("usual_s"), (job.finished or 0.0) - (job.started or 0.0)
        if job.kind == "probe" and job.state == "done" and usual and (job.result or {}).get("passed") and whole > 0:
            ratios.append(whole / float(usual))
    return statistics.median(ratios[:LAST_PROBES]) if ratios else 1.0


def probe_took(folder: WorldFolder, seconds: float, usual: float) -> None:
    """Keep how long a part of a probe's simulation took [s], over what is usual for it [s]: for the estimate of the world's next one."""
    _keep(folder, over_usual=seconds / max(usual, 1e-9))


def film_estimate(
    jobs: JobStore, *, frames: int, width: int, height: int, samples: int, folder: WorldFolder | None = None
) -> float | None:
    """Seconds that a film will take: by the pace of the last film of this workspace for each path, before the first by that of the
    fastest still of the world in `folder`; None before that."""
    paths = frames * width * height * samples
    for job in jobs.list(limit=SEEN_JOBS):
        past = job.result or {}
        if job.kind == "final" and job.state == "done" and past.get("seconds_per_frame"):
            rate = float(past["seconds_per_frame"]) / float(past["width"] * past["height"] * past["samples"])
            return round(rate * paths, 1)
    return None if folder is None else still_estimate(folder, paths)


def still_estimate(folder: WorldFolder, paths: int) -> float | None:
    """Seconds that a still of so many paths takes, by the pace of the world's stills; None before the first."""
    pace = _pace_of_stills(folder)
    return None if pace is None else round(pace * paths, 1)


def still_took(folder: WorldFolder, seconds: float, paths: int) -> None:
    """Keep the pace of a still for the estimate of the film: time for each path [s], the least so far, which has least of loading."""
    before = _pace_of_stills(folder)
    rate = seconds / max(paths, 1)
    if before is None or rate < before:
        _keep(folder, seconds_per_path=rate)


def _pace_of_stills(folder: WorldFolder) -> float | None:
    return _kept(folder).get("seconds_per_path")


def _kept(folder: WorldFolder) -> dict[str, float]:
    """Pace of a world, as far as it is known; empty where nothing is, or no numbers are."""
    try:
        return {str(k): float(v) for k, v in json.loads((folder.pictures / PACE).read_bytes()).items()}
    except (OSError, ValueError, AttributeError, TypeError):
        return {}


def _keep(folder: WorldFolder, **known: float) -> None:
    from ..worlds.folder import write_atomically

    write_atomically(folder.pictures / PACE, json.dumps({**_kept(folder), **known}).encode())
