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
from functools import partial
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ...simulation.variants import run_altered
from ...worlds.candidate import Candidate
from ...worlds.errors import EvidenceError
from ...worlds.requirements import Correction, Row, RowId, Status
from ...worlds.spec import Perturbed, Refined, RigidInstance
from ..predicates import Outcome, beat_times, last_needed
from ..rows.verdicts import correction, make_row, postponed
from .perturbations import fixed_places, perturbed

if TYPE_CHECKING:
    from ...worlds.spec import WorldSpec

__all__ = ["CONFIDENCE", "check", "clopper_pearson", "row_ids"]

CONFIDENCE = 0.95
TOLD = 6
"""Most entities whose draws of a failed sample are told."""
_Tell = Callable[[int, int, int, str], None]
"""Takes (run, frames done, frames planned, message)."""
LEAST_STEP = 2e-5
"""[s] Smallest step that solver settings allow."""


def row_ids(spec: WorldSpec) -> frozenset[str]:
    """Ids of the rows that this check gives for a specification."""
    return frozenset(f"robustness:{name}:{beat}" for name, item in spec.story.robustness.items() for beat in item.beats)


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
            progress(
                begun + run + done / max(total, 1), planned, f"checking robustness: run {begun + run + 1} of {planned}, {message}"
            )

    for name, item in declared.items():
        beats = [b for b in dict.fromkeys(item.beats) if b in candidate.spec.story.beats]
        try:
            if not candidate.rigid_caches:
                raise EvidenceError("nothing was simulated yet: probe first")
            if failing is not None:
                raise EvidenceError(postponed(failing))
            made = (
                _perturbed(candidate, name, item, beats, tell)
                if isinstance(item, Perturbed)
                else _refined(candidate, name, item, beats, tell)
            )
        except EvidenceError as error:
            made = [_row(candidate, name, item, b, "unverified", str(error)) for b in beats]
        rows += made
        begun += _runs(item)
    return rows


def _runs(item: Perturbed | Refined) -> int:
    return item.samples if isinstance(item, Perturbed) else 1


# ---------------------------------------------------------------- perturbed starts


def _perturbed(candidate: Candidate, name: str, item: Perturbed, beats: list[str], tell: _Tell) -> list[Row]:
    end = last_needed(candidate.spec, beats)
    passed = dict.fromkeys(beats, 0)
    failed: dict[str, list[dict[str, Any]]] = {b: [] for b in beats}
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
            if outcome.status == "fail":
                failed[beat].append({"sample": sample, "why": outcome.explanation, "drawn": _largest(drawn)})
    kept = sorted(fixed_places(candidate.spec) & set(item.entities or candidate.spec.entities))
    return [_fraction_row(candidate, name, item, b, passed[b], failed[b], {"opened_m": opened, "not_moved": kept}) for b in beats]


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


def _fraction_row(
    candidate: Candidate,
    name: str,
    item: Perturbed,
    beat: str,
    passed: int,
    failed: list[dict[str, Any]],
    more: Mapping[str, Any],
) -> Row:
    share = passed / item.samples
    low, high = clopper_pearson(passed, item.samples)
    text = f"{beat} comes true in {passed} of {item.samples} perturbed runs ({share:.0%}, 95 % interval {low:.0%} to {high:.0%})"
    text += f", {item.min_fraction:.0%} asked"
    if failed:
        text += f"; first not in sample {failed[0]['sample']}: {failed[0]['why']}"
    return _row(
        candidate,
        name,
        item,
        beat,
        "pass" if share >= item.min_fraction else "fail",
        text,
        measured=share,
        bound=item.min_fraction,
        comparison=">=",
        evidence={
            "samples": item.samples,
            "passed": passed,
            "interval_95": [low, high],
            "seed": item.seed,
            "first_failed": failed[0] if failed else None,
            "failed_samples": [f["sample"] for f in failed],
            **more,
        },
    )


# ---------------------------------------------------------------- finer steps


def _refined(candidate: Candidate, name: str, item: Refined, beats: list[str], tell: _Tell) -> list[Row]:
    spec = candidate.spec
    solvers = {}
    for key, instance in spec.simulation.solvers.items():
        field = "step" if isinstance(instance, RigidInstance) else "max_step"
        step = getattr(instance.settings, field) / item.factor
        if step < LEAST_STEP:
            raise EvidenceError(f"{field} {step * item.factor:g} s of {key!r} divided by {item.factor} is below {LEAST_STEP:g} s")
        solvers[key] = instance.model_copy(update={"settings": instance.settings.model_copy(update={field: step})})
    finer = spec.model_copy(update={"simulation": spec.simulation.model_copy(update={"solvers": solvers})})
    variant = run_altered(candidate, finer, candidate.built, end=last_needed(spec, beats), progress=partial(tell, 0))
    return [_shift_row(candidate, name, item, b, beat_times(candidate).outcome(b), beat_times(variant).outcome(b)) for b in beats]


def _shift_row(candidate: Candidate, name: str, item: Refined, beat: str, coarse: Outcome, fine: Outcome) -> Row:
    status: Status
    shift: float | None = None
    if "unverified" in (coarse.status, fine.status) or coarse.status == "fail":
        status = "unverified"
        open_one = coarse if coarse.status != "pass" else fine
        text = f"{beat} cannot be compared: {open_one.explanation}"
    elif fine.status == "fail":
        status, text = "fail", f"{beat} does not come true with 1/{item.factor} of the step: {fine.explanation}"
    elif coarse.first_true_frame is None or fine.first_true_frame is None:
        status, shift = "pass", 0.0
        text = f"{beat} holds with 1/{item.factor} of the step as well: {fine.explanation}"
    else:
        shift = float(abs(fine.first_true_frame - coarse.first_true_frame))
        status = "pass" if shift <= item.frames else "fail"
        text = (
            f"with 1/{item.factor} of the step {beat} comes true at frame {fine.first_true_frame} instead of "
            f"{coarse.first_true_frame}, {item.frames} frames allowed"
        )
    return _row(
        candidate,
        name,
        item,
        beat,
        status,
        text,
        measured=shift,
        bound=float(item.frames),
        comparison="<=",
        unit="frame",
        evidence={
            "factor": item.factor,
            "frames": [coarse.first_true_frame, fine.first_true_frame],
            "values": [coarse.value, fine.value],
        },
    )


# ---------------------------------------------------------------- rows


def _hints(item: Perturbed | Refined, subject: str) -> list[Correction]:
    if isinstance(item, Refined):
        return [
            correction(
                "the step decides the outcome: it is too long", "step", "halve the step", pointers=("/simulation/solvers",)
            ),
            correction(
                "the motion hangs on a knife's edge",
                "placement",
                f"give {subject} more room, or a firmer push",
                pointers=(f"/entities/{subject}/pose",),
            ),
        ]
    return [
        correction(
            "the outcome hangs on exact placement",
            "placement",
            f"aim {subject} at the middle of where it must arrive, or widen what catches or passes it on",
            pointers=(f"/entities/{subject}/pose",),
        ),
        correction(
            "the push is barely enough",
            "initial_state",
            "raise the speed of what hits",
            pointers=(f"/entities/{subject}/physics",),
        ),
        correction("friction or restitution decides", "material", "choose values that leave more room", pointers=("/materials",)),
    ]


def _row(
    candidate: Candidate,
    name: str,
    item: Perturbed | Refined,
    beat: str,
    status: Status,
    explanation: str,
    *,
    measured: float | None = None,
    bound: float | None = None,
    comparison: Literal["<=", ">=", ""] = "",
    unit: str = "1",
    evidence: Mapping[str, Any] | None = None,
) -> Row:
    declared = candidate.spec.story.beats[beat]
    asked = (
        f"{beat} comes true in at least {item.min_fraction:g} of {item.samples} perturbed runs"
        if isinstance(item, Perturbed)
        else f"with 1/{item.factor} of the step {beat} comes true within {item.frames} frames of where it did"
    )
    failed = status == "fail"
    return make_row(
        candidate,
        RowId("robustness", name, beat),
        predicate=asked,
        status=status,
        explanation=explanation,
        frames=(0, last_needed(candidate.spec, [beat])),
        measured=measured,
        bound=bound,
        comparison=comparison,
        unit=unit,
        entities=(declared.subject,),
        first_failing_entity=declared.subject if failed else None,
        first_failing_frame=declared.frames[1] if failed else None,
        corrections=_hints(item, declared.subject),
        evidence={"pointers": [f"/story/robustness/{name}"], **(evidence or {})},
        extra=[item.model_dump(mode="json"), declared.model_dump(mode="json")],
    )
