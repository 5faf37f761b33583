"""The paper's formulas from single scores to that of a film, and from films to that of a method (R140, R145-R147, R150)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from statistics import fmean

__all__ = ["causal_score", "composition_score", "macro_average", "production_score", "shots_score"]

EVENTS, LINKS = 0.7, 0.3
"""Weights of completion and of causal linkage (R145)."""


def causal_score(beats: Sequence[float], links: Sequence[float]) -> float:
    """c = 0.7 e + 0.3 l, with e the mean of five beats and l that of four links, each 0, 0.5 or 1."""
    if len(beats) != 5 or len(links) != 4:
        raise ValueError(f"Caus needs five beats and four links, not {len(beats)} and {len(links)}")
    return EVENTS * fmean(beats) + LINKS * fmean(links)


def shots_score(segments: Sequence[tuple[float, float, float]]) -> float:
    """Mean over eight segments of the mean of three scores of 1 to 5, each over 5."""
    if len(segments) != 8:
        raise ValueError(f"Qual needs eight segments, not {len(segments)}")
    return fmean(fmean(score / 5.0 for score in segment) for segment in segments)


def composition_score(found: Sequence[bool]) -> float:
    """Share of the questions that a window of the film answers with yes."""
    return fmean(float(yes) for yes in found)


def production_score(windows: Sequence[tuple[int, Sequence[float]]]) -> float:
    """Mean over windows of the sum of four scores of 1 to 5 over 20, weighted by their numbers of frames.

    Args:
        windows: number of frames and scores of each.
    """
    if any(len(scores) != 4 for _, scores in windows):
        raise ValueError("Prod needs four scores per window")
    total = sum(count for count, _ in windows)
    return sum(count * sum(scores) / 20.0 for count, scores in windows) / total


def macro_average(scores: Mapping[str, float | None]) -> float | None:
    """S_m: mean over tasks; None as soon as one of them has no score, since a mean over fewer tasks does not compare."""
    known = [score for score in scores.values() if score is not None]
    return fmean(known) if known and len(known) == len(scores) else None
