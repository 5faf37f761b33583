"""Robustness: beats under small changes of what the specification leaves uncertain, and under a finer time step.

Rows `robustness:<id>:<beat>`, one per beat of each item of `story.robustness`; a world without such items has none.

- `perturbed`: the share of samples in which the beat comes true, with its 95 % interval (C. J. Clopper and E. S. Pearson,
  Biometrika 26 (1934) 404), is at least `min_fraction`. The verdict goes by the share itself: the interval only tells how
  well so many samples know it.
- `refined`: with the step of every solver divided by `factor` the beat comes true too, shifted by at most `frames`.

Every sample runs from frame 0 to the last frame that its beats need.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from ...simulation.variants import run_altered
from ...worlds.candidate import Candidate
from ...worlds.errors import EvidenceError
from ...worlds.spec import Perturbed, Refined, RigidInstance
from ..predicates.evaluators import beat_times
from ..predicates.times import last_needed
from ..rows.answers import row_of
from ..rows.corrections import LEAST_STEP, correction, halve_any_step, postponed
from ..rows.findings import Finding, lacking
from .bounds import CONFIDENCE
from .branches import Branch, branches_of, comes_true
from .offers import faster
from .perturbations import fixed_places, perturbed
from .questions import ROBUST

if TYPE_CHECKING:
    from ...worlds.requirements import Correction, Row
    from ...worlds.spec import WorldSpec
    from ..predicates.outcome import Outcome

__all__ = ["check", "clopper_pearson", "row_ids"]

TOLD = 6
"""Most entities whose draws of a failed sample are told."""
_Tell = Callable[[int, int, int, str], None]
"""Takes (run, frames done, frames planned, message)."""


def row_ids(spec: WorldSpec) -> frozenset[str]:
    """Ids of the rows that this check gives for a specification."""
    return frozenset(ROBUST.row_id((name, beat)) for name, item in spec.story.robustness.items() for beat in item.beats)


def clopper_pearson(hits: int, count: int) -> tuple[float, float]:
    """Two-sided 95 % interval of a proportion."""
    from scipy.stats import beta

    if count == 0:
        return (0.0, 1.0)
    tail = (1.0 - CONFIDENCE) / 2.0
    low = 0.0 if hits == 0 else float(beta.ppf(tail, hits, count - hits + 1))
    high = 1.0 if hits == count else float(beta.ppf(1.0 - tail, hits + 1, count - hits))
    return (low, high)


def check(
    candidate: Candidate, progress: Callable[[float, float, str], None] | None = None, failing: str | None = None
) -> list[Row]:
    """One row per declared item and beat.

    Args:
        candidate: what is judged.
        progress: called with (runs done, runs planned, message), also from within a run.
        failing: id of a row that fails; then nothing is simulated, and every row follows from that one.
    """
    rows: list[Row] = []
    declared = candidate.spec.story.robustness
    planned = sum(_runs(item) for item in declared.values())
    begun = 0

    def tell(run: int, done: int, total: int, message: str) -> None:
        if progress is not None:
            at = begun + run
            progress(at + done / max(total, 1), planned, f"checking robustness: run {at + 1} of {planned}, {message}")

    for name, item in declared.items():
        beats = [b for b in dict.fromkeys(item.beats) if b in candidate.spec.story.beats]
        try:
            if failing is not None:
                found = dict.fromkeys(beats, Finding("unverified", postponed(failing), unit=ROBUST.unit))
            elif not candidate.rigid_caches:
                raise EvidenceError("nothing was simulated yet: probe first")
            elif isinstance(item, Perturbed):
                found = _perturbed(candidate, name, item, beats, tell)
            else:
                found = _refined(candidate, item, beats, tell)
        except EvidenceError as error:
            found = dict.fromkeys(beats, replace(lacking(error), unit=ROBUST.unit))
        rows += [_row(candidate, name, item, beat, finding) for beat, finding in found.items()]
        begun += _runs(item)
    return rows


def _runs(item: Perturbed | Refined) -> int:
    return item.samples if isinstance(item, Perturbed) else 1


# ---------------------------------------------------------------- perturbed starts


def _perturbed(candidate: Candidate, name: str, item: Perturbed, beats: list[str], tell: _Tell) -> dict[str, Finding]:
    """Findings by beat, from all samples."""
    end = last_needed(candidate.spec, beats)
    passed = dict.fromkeys(beats, 0)
    failed: dict[str, list[dict[str, Any]]] = {b: [] for b in beats}
    never = {b: _never(candidate, b) for b in beats}
    opened = 0.0
    for sample in range(item.samples):
        spec, built, drawn = perturbed(candidate, name, item, sample)
        try:
            variant = run_altered(candidate, spec, built, end=end, progress=partial(tell, sample))
        except EvidenceError as error:
            for beat in beats:
                failed[beat].append({"sample": sample, "why": str(error), "drawn": _largest(drawn)})
            continue
        opened = max(opened, _opened(variant))
        for beat in beats:
            outcome = beat_times(variant).outcome(beat)
            if outcome.status == "unverified":
                raise EvidenceError(f"sample {sample} cannot be judged: {outcome.explanation}")
            passed[beat] += outcome.status == "pass"
            never[beat] = [branch for branch in never[beat] if not comes_true(variant, branch)]
            if outcome.status == "fail":
                failed[beat].append({"sample": sample, "why": outcome.explanation, "drawn": _largest(drawn)})
    kept = sorted(fixed_places(candidate.spec) & set(item.entities or candidate.spec.entities))
    found = {b: _fraction(item, b, passed[b], failed[b], {"opened_m": opened, "not_moved": kept}) for b in beats}
    return {b: _with_branches(finding, never[b]) for b, finding in found.items()}


def _never(candidate: Candidate, beat: str) -> list[Branch]:
    """Branches of an `or` of a beat that the recorded motion never makes true."""
    declared = candidate.spec.story.beats[beat]
    branches = branches_of(declared, f"/story/beats/{beat}", candidate.spec.simulation.frames - 1)
    return [b for b in branches if not comes_true(candidate, b)]


def _with_branches(found: Finding, never: list[Branch]) -> Finding:
    """The finding of a sample, failing where a branch came true neither in the recorded motion nor in any run of it."""
    if not never:
        return found
    text = f"{never[0].text} never comes true, neither here nor in a perturbed run: drop that branch, {never[0].pointer}"
    return replace(found, status="fail", text=text, evidence={**(found.evidence or {}), "never": [b.pointer for b in never]})


def _opened(variant: Candidate) -> float:
    """Farthest that a body stands at frame 0 from where the sample put it [m]: opened skins, overlaps, and the preroll."""
    moved = 0.0
    for name, entity in variant.spec.entities.items():
        if entity.motion == "dynamic" and entity.generator is None and variant.moves(name):
            wanted = np.array(entity.pose.position) - variant.pose(name, 0).position
            moved = max(moved, float(np.linalg.norm(wanted)))
    return moved


def _largest(drawn: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """The draws of a sample, shortened to those that moved farthest or changed most."""

    def size(key: str) -> float:
        told = drawn[key]
        shift = float(np.linalg.norm(told.get("shift_m", (0.0,))))
        return max(shift, *(abs(float(told.get(k, 1.0)) - 1.0) for k in ("speed", "mass")), abs(float(told.get("turn_rad", 0.0))))

    return {k: dict(drawn[k]) for k in sorted(drawn, key=size, reverse=True)[:TOLD]}


def _fraction(item: Perturbed, beat: str, passed: int, failed: list[dict[str, Any]], more: Mapping[str, Any]) -> Finding:
    share = passed / item.samples
    low, high = clopper_pearson(passed, item.samples)
    text = f"{beat} comes true in {passed} of {item.samples} perturbed runs ({share:.0%}, 95 % interval {low:.0%} to {high:.0%})"
    text += f", {item.min_fraction:.0%} asked"
    if failed:
        text += f"; first not in sample {failed[0]['sample']}: {failed[0]['why']}"
    evidence = {
        "samples": item.samples,
        "passed": passed,
        "interval_95": [low, high],
        "seed": item.seed,
        "first_failed": failed[0] if failed else None,
        "failed_samples": [f["sample"] for f in failed],
        **more,
    }
    return Finding(
        "pass" if share >= item.min_fraction else "fail",
        text,
        share,
        item.min_fraction,
        "1",
        evidence=evidence,
        comparison=">=",
    )


# ---------------------------------------------------------------- finer steps


def _refined(candidate: Candidate, item: Refined, beats: list[str], tell: _Tell) -> dict[str, Finding]:
    """Findings by beat, from one run with finer steps."""
    spec, least, solvers = candidate.spec, LEAST_STEP["step"], {}
    for key, instance in spec.simulation.solvers.items():
        field = "step" if isinstance(instance, RigidInstance) else "max_step"
        step = getattr(instance.settings, field) / item.factor
        if step < least:
            raise EvidenceError(f"{field} {step * item.factor:g} s of {key!r} divided by {item.factor} is below {least:g} s")
        solvers[key] = instance.model_copy(update={"settings": instance.settings.model_copy(update={field: step})})
    finer = spec.model_copy(update={"simulation": spec.simulation.model_copy(update={"solvers": solvers})})
    variant = run_altered(candidate, finer, candidate.built, end=last_needed(spec, beats), progress=partial(tell, 0))
    return {b: _shift(item, b, beat_times(candidate).outcome(b), beat_times(variant).outcome(b)) for b in beats}


def _shift(item: Refined, beat: str, coarse: Outcome, fine: Outcome) -> Finding:
    finer, allowed = f"with 1/{item.factor} of the step", item.frames
    evidence = {
        "factor": item.factor,
        "frames": [coarse.first_true_frame, fine.first_true_frame],
        "values": [coarse.value, fine.value],
    }
    found = Finding("unverified", "", None, float(allowed), "frame", evidence=evidence, comparison="<=")
    if "unverified" in (coarse.status, fine.status) or coarse.status == "fail":
        open_one = coarse if coarse.status != "pass" else fine
        return replace(found, text=f"{beat} cannot be compared: {open_one.explanation}")
    if fine.status == "fail":
        return replace(found, status="fail", text=f"{beat} does not come true {finer}: {fine.explanation}")
    if coarse.first_true_frame is None or fine.first_true_frame is None:
        return replace(found, status="pass", measured=0.0, text=f"{beat} holds {finer} as well: {fine.explanation}")
    shift = float(abs(fine.first_true_frame - coarse.first_true_frame))
    text = f"{finer} {beat} comes true at frame {fine.first_true_frame} instead of {coarse.first_true_frame}, {allowed} frames allowed"
    return replace(found, status="pass" if shift <= allowed else "fail", measured=shift, text=text)


# ---------------------------------------------------------------- rows


def _hints(item: Perturbed | Refined, subject: str) -> tuple[Correction, ...]:
    place = f"/entities/{subject}"
    if isinstance(item, Refined):
        cause, room = "the step decides the outcome: it is too long", f"give {subject} more room, or a firmer push"
        return (
            halve_any_step(cause),
            correction("the motion hangs on a knife's edge", "placement", room, pointers=(f"{place}/pose",)),
        )
    aim = f"aim {subject} at the middle of where it must arrive, or widen what catches or passes it on"
    return (
        correction("the outcome hangs on exact placement", "placement", aim, pointers=(f"{place}/pose",)),
        faster(subject, "the push is barely enough"),
        correction("friction or restitution decides", "material", "choose values that leave more room", pointers=("/materials",)),
    )


def _row(candidate: Candidate, name: str, item: Perturbed | Refined, beat: str, found: Finding) -> Row:
    declared = candidate.spec.story.beats[beat]
    predicate = (
        f"{beat} comes true in at least {item.min_fraction:g} of {item.samples} perturbed runs"
        if isinstance(item, Perturbed)
        else f"with 1/{item.factor} of the step {beat} comes true within {item.frames} frames of where it did"
    )
    found = replace(
        found,
        predicate=predicate,
        frame=declared.frames[1],
        hints=_hints(item, declared.subject),
        evidence={"pointers": [f"/story/robustness/{name}"], **(found.evidence or {})},
        frames=(0, last_needed(candidate.spec, [beat])),
    )
    extra = [item.model_dump(mode="json"), declared.model_dump(mode="json")]
    return row_of(candidate, ROBUST, (name, beat), found, entities=(declared.subject,), extra=extra)
