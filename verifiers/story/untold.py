"""Drivers of which the story does not tell: the world is run once without them, and its beats must come all the same (R97, R156).

Row `causal:untold:<beat>` of every beat for which the specification has a driver that owns neither it nor a beat that leads to it (of a
beat without causes: no beat at all). Such a driver *reaches* the beat where a chain of pushes (`story/chains.py`: contacts, matter, joints,
bodies on paths) leads from what it acts on to a body that the beat speaks of, before the beat comes true. Those that reach a beat are taken
away together, so that two of which either would do are not both spared; if the beat does not come then, the story needs a driver that nobody
owns, and the row fails. If it comes, the row names them as what helps and is not needed.

What does a countable share of the work fails already by `beat:driven` (`agency.py`), without a run.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...worlds.drivers import acts_from, untold
from ...worlds.errors import EvidenceError
from ...worlds.predicates.registry import is_invariant
from ..predicates.evaluators import beat_times
from ..predicates.times import last_needed
from ..rows.answers import row_of
from ..rows.corrections import postponed
from ..rows.findings import Finding, judged
from .bodies import spoken_bodies
from .bounds import MOST_WITHOUT
from .chains import chains_of
from .interventions import FollowsError
from .offers import untold_offers
from .questions import UNTOLD
from .reruns import Rerun, rerun_without

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Row
    from ...worlds.spec import WorldSpec

__all__ = ["Reached", "check", "reached_by", "row_ids"]

Progress = Callable[[float, float, str], None]


class Reached(NamedTuple):
    """A driver whose chain of pushes arrives at bodies of a beat."""

    driver: str
    bodies: tuple[str, ...]
    seconds: float
    """When the first of them is reached [s]."""


def row_ids(spec: WorldSpec) -> frozenset[str]:
    """Ids of the rows that this check gives for a specification."""
    return frozenset(UNTOLD.row_id((name,)) for name in _concerned(spec))


def _concerned(spec: WorldSpec) -> list[str]:
    return [name for name in spec.story.beats if untold(spec, name)]


def check(candidate: Candidate, progress: Progress | None = None, failing: str | None = None) -> list[Row]:
    """One row per beat for which there is a driver that the story does not tell of.

    Args:
        candidate: what is judged.
        progress: called with (rows done, rows planned, message), also from within a run.
        failing: id of a row that fails; then nothing is simulated, and every row follows from that one.
    """
    beats = _concerned(candidate.spec)
    if failing is not None:
        return [_row(candidate, b, Finding("unverified", postponed(failing), evidence={"follows": failing})) for b in beats]
    runs = _Runs(candidate, beats, progress)
    return [_row(candidate, beat, partial(runs.judge, beat)) for beat in beats]


def _row(candidate: Candidate, beat_id: str, found: Finding | Callable[[], Finding]) -> Row:
    beat, drivers = candidate.spec.story.beats[beat_id], untold(candidate.spec, beat_id)
    found = found if isinstance(found, Finding) else judged(found)
    pointers = [f"/simulation/drivers/{name}" for name in drivers]
    extra = [beat.model_dump(mode="json"), *(candidate.spec.simulation.drivers[d].model_dump(mode="json") for d in drivers)]
    return row_of(
        candidate,
        replace(UNTOLD, mandatory=beat.mandatory),
        (beat_id,),
        replace(found, evidence={"untold": list(drivers), "pointers": pointers, **(found.evidence or {})}),
        entities=spoken_bodies(candidate.spec, beat),
        extra=extra,
    )


def reached_by(candidate: Candidate, beat_id: str) -> list[Reached]:
    """Drivers that the story does not tell of and that reach a body of a beat before it comes true; of a lasting state, before it ends.

    Raises:
        EvidenceError: the joint of a driver is not in the plan, or a log is missing.
    """
    spec, beat = candidate.spec, candidate.spec.story.beats[beat_id]
    bodies, first = spoken_bodies(spec, beat), beat_times(candidate).outcome(beat_id).first_true_frame
    until = beat.frames[1] if first is None or is_invariant(beat.predicate) else first
    found = []
    for driver in untold(spec, beat_id):
        begins, sources = acts_from(spec, driver)
        if begins * spec.simulation.fps >= until:
            continue
        reach = chains_of(candidate).spread(sources, begins, until, acting_until=until)
        times = {name: reach.arrival[reach.names.index(name)] for name in bodies}
        met = tuple(name for name in bodies if np.isfinite(times[name]))
        if met:
            found.append(Reached(driver, met, float(min(times[name] for name in met))))
    return found


class _Runs:
    """Runs of one candidate without drivers that the story does not tell of."""

    def __init__(self, candidate: Candidate, beats: list[str], progress: Progress | None) -> None:
        self.candidate, self._beats, self._progress, self._begun = candidate, beats, progress, -1
        self._made: dict[frozenset[str], Rerun | EvidenceError] = {}
        self._singles = 0

    @cached_property
    def _reaching(self) -> dict[str, list[Reached] | EvidenceError]:
        """Drivers that reach each beat which came true."""
        found: dict[str, list[Reached] | EvidenceError] = {}
        for beat in self._beats:
            try:
                found[beat] = (
                    reached_by(self.candidate, beat) if beat_times(self.candidate).outcome(beat).status == "pass" else []
                )
            except EvidenceError as error:
                found[beat] = error
        return found

    @cached_property
    def _sets(self) -> dict[str, frozenset[str]]:
        """Drivers that are taken away for each beat that some reach: those that reach any beat and are not told of it, so that one run
        serves many."""
        some = {r.driver for found in self._reaching.values() if isinstance(found, list) for r in found}
        reached = [beat for beat, found in self._reaching.items() if isinstance(found, list) and found]
        return {beat: frozenset(untold(self.candidate.spec, beat)) & some for beat in reached}

    def judge(self, beat: str) -> Finding:
        """The finding on whether a beat comes without the drivers that reach it and of which the story does not tell.

        Raises:
            EvidenceError: it cannot be told whom they reach, or the run cannot be made.
        """
        self._begun += 1
        self._tell(0, 1, f"{self._begun + 1} of {len(self._beats)}")
        outcome, found = beat_times(self.candidate).outcome(beat), self._reaching[beat]
        if outcome.status != "pass":
            text = f"{beat} did not come true, so that nobody is asked whether it comes alone: {outcome.explanation}"
            error = FollowsError(self.candidate, beat, text)
            return Finding("unverified", str(error), evidence={"follows": error.row})
        if isinstance(found, EvidenceError):
            raise found
        if not found:
            names = ", ".join(untold(self.candidate.spec, beat))
            return Finding("pass", f"no chain of pushes leads from what {names} acts on to a body of {beat}", 0.0, 0.0)
        return self._without(beat, found)

    def _without(self, beat: str, found: list[Reached]) -> Finding:
        gone = self._sets[beat]
        if gone not in list(dict.fromkeys(self._sets.values()))[:MOST_WITHOUT]:
            raise EvidenceError(
                f"{len(set(self._sets.values()))} different sets of drivers that no beat tells of reach beats, and at most {MOST_WITHOUT} are "
                f"taken away; let {', '.join(sorted(gone))} own beats that lead to {beat}, or take them away"
            )
        runs: list[dict[str, Any]] = []
        came = self._comes(beat, gone, runs)
        reached = [{"driver": r.driver, "bodies": list(r.bodies), "time": r.seconds} for r in found]
        evidence = {"reached": reached, "runs": runs, "frames_rerun": sum(r["frames_rerun"] for r in runs)}
        names = ", ".join(r.driver for r in found)
        way = "; ".join(f"{r.driver} reaches {', '.join(r.bodies)} at {r.seconds:.3f} s" for r in found)
        frames = (min(r["from_frame"] for r in runs), self._end(beat))
        if came:
            text = f"{beat} comes without {names} as well, which no beat that leads to it tells of: it helps and is not needed ({way})"
            return Finding("pass", text, 0.0, 0.0, evidence={**evidence, "helps": [r.driver for r in found]}, frames=frames)
        needed = self._needed(beat, found, gone, runs)
        text = (
            f"without {', '.join(needed)} {beat} does not come ({runs[0 if len(needed) > 1 else -1]['told']}), and no beat that leads to it tells of "
            f"{'it' if len(needed) == 1 else 'them'}: {way}"
        )
        return Finding(
            "fail",
            text,
            1.0,
            0.0,
            entity=next(r.bodies[0] for r in found if r.driver in needed),
            frame=beat_times(self.candidate).first(beat),
            hints=tuple(h for driver in needed for h in untold_offers(self.candidate.spec, driver, beat)),
            evidence={**evidence, "needs": needed, "frames_rerun": sum(r["frames_rerun"] for r in runs)},
            frames=frames,
        )

    def _needed(self, beat: str, found: list[Reached], gone: frozenset[str], runs: list[dict[str, Any]]) -> list[str]:
        """The driver without which alone a beat does not come; all that reach it where there is none, or too many to try."""
        for reached in found:
            single = frozenset({reached.driver})
            if single == gone or (single not in self._made and self._singles >= MOST_WITHOUT):
                break
            self._singles += single not in self._made
            with suppress(EvidenceError):  # the run without all of them has told already that the beat does not come
                if not self._comes(beat, single, runs):
                    return [reached.driver]
        return [r.driver for r in found]

    def _comes(self, beat: str, gone: frozenset[str], runs: list[dict[str, Any]]) -> bool:
        """True where a beat comes in the run without some drivers, which is told in `runs`.

        Raises:
            EvidenceError: the run cannot be made, or the beat not be judged in it.
        """
        run = self._run(gone)
        outcome = beat_times(run.candidate).outcome(beat)
        if outcome.status == "unverified":
            raise EvidenceError(f"without {', '.join(sorted(gone))}, {beat} cannot be judged: {outcome.explanation}")
        came = outcome.status == "pass"
        if came and not run.cost()["instances_rerun"]:
            raise EvidenceError(f"no instance runs otherwise without {', '.join(sorted(gone))}, so that nothing was asked")
        told = {"without": sorted(gone), "from_frame": run.start, "comes": came, "first_true_frame": outcome.first_true_frame}
        runs.append({**told, "told": outcome.explanation, **run.cost()})
        return came

    def _run(self, gone: frozenset[str]) -> Rerun:
        if gone not in self._made:
            try:
                self._made[gone] = self._prevented(gone)
            except EvidenceError as error:
                self._made[gone] = error
        found = self._made[gone]
        if isinstance(found, EvidenceError):
            raise found
        return found

    def _prevented(self, gone: frozenset[str]) -> Rerun:
        candidate = self.candidate
        begins = min(acts_from(candidate.spec, name)[0] for name in gone)
        start = min(max(0, int(np.floor(begins * candidate.spec.simulation.fps + 1e-9))), candidate.last_frame)
        end = max(self._end(beat) for beat, own in self._sets.items() if gone <= own)
        return rerun_without(candidate, gone, start, end, self._tell)

    def _end(self, *beats: str) -> int:
        return min(self.candidate.last_frame, last_needed(self.candidate.spec, beats))

    def _tell(self, done: int, total: int, message: str) -> None:
        if self._progress is not None:
            planned = len(self._beats)
            text = f"checking causal: {self._beats[self._begun]} without drivers that no beat tells of, {message}"
            self._progress(self._begun + done / max(total, 1), planned, text)
