"""What a study found so far: means of participants' means (R153), strengths from pairs, and how far the raters are."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from statistics import fmean
from typing import Any

from ..statistics import repeat_interval
from .answers import CRITERIA
from .design import Study
from .strengths import Comparison, strengths

__all__ = ["comparisons", "study_results"]


def study_results(lines: Sequence[Mapping[str, Any]], *, seed: int = 1) -> dict[str, Any]:
    """Results of the lines of an answer file.

    A mean is over participants, each by the mean of its own ratings, as in the paper; its interval is Student's over participants. Whoever
    stopped early counts with what was answered: every page has all methods.

    Args:
        lines: of `answers.read_lines`, the study first.
        seed: of the draws of the intervals of strengths.
    """
    known = lines[0]
    study = Study(tuple(known["methods"]), tuple(known["tasks"]), known["tasks_each"], known["pairs_each"], known["seed"])
    ratings: dict[tuple[str, str], dict[str, list[float]]] = defaultdict(lambda: defaultdict(list))
    done: dict[str, int] = {str(line["rater"]): 0 for line in lines if line["kind"] == "rater"}
    for line in lines:
        if line["kind"] in ("rate", "pair"):
            done[str(line["rater"])] += 1
        for method, scores in zip(line["methods"], line["scores"], strict=True) if line["kind"] == "rate" else ():
            for criterion, score in scores.items():
                ratings[method, criterion][str(line["rater"])].append(float(score))
    pairs = comparisons(lines)
    found = strengths(study.methods, pairs, seed=seed) if pairs else None
    return {
        "raters": len(done),
        "raters_done": sum(count == len(study.steps(0)) for count in done.values()),
        "means": {m: {c: _mean(ratings[m, c]) for c in CRITERIA} for m in study.methods},
        "pairs": len(pairs),
        "strengths": None if found is None else {m: asdict(s) for m, s in found.items()},
        "study": study.told(),
    }


def comparisons(lines: Sequence[Mapping[str, Any]]) -> list[Comparison]:
    """Answers about pairs."""
    return [Comparison(str(x["rater"]), x["methods"][0], x["methods"][1], x["choice"]) for x in lines if x["kind"] == "pair"]


def _mean(by_rater: Mapping[str, Sequence[float]]) -> dict[str, Any]:
    means = [fmean(scores) for scores in by_rater.values()]
    interval = repeat_interval([means])
    return {
        "mean": fmean(means) if means else None,
        "interval": None if interval is None else [interval.low, interval.high],
        "raters": len(means),
        "ratings": sum(map(len, by_rater.values())),
    }
