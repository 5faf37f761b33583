"""Two runs over the same prompts, figure by figure, by the paired bootstrap."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from ...worlds.errors import RefusedError
from .figures import FIGURES, RunFigures, identity_of, run_figures
from .runs import run_name
from .statistics import RESAMPLES, paired_bootstrap

if TYPE_CHECKING:
    from inspect_ai.log import EvalLog

__all__ = ["compare_runs", "differences", "refuse_others", "told_difference"]


def compare_runs(first: EvalLog, second: EvalLog, *, seed: int = 1, resamples: int = RESAMPLES) -> dict[str, Any]:
    """Every figure that both runs have, over the prompts for which both have it.

    Args:
        first: a run.
        second: another.
        seed: of the draws.
        resamples: number of draws.

    Raises:
        RefusedError: their sets of prompts or their templates are not the same, or no prompt is in both.
    """
    refuse_others(first, second)
    one, other = identity_of(first), identity_of(second)
    left, right = run_figures(first), run_figures(second)
    ids, others = {r.id for r in left.results}, {r.id for r in right.results}
    if not ids & others:
        raise RefusedError(f"{run_name(first)} and {run_name(second)} have no prompt in common; run the same samples")
    judged = {n: (one["metrics"].get(n), other["metrics"].get(n)) for n in FIGURES if n in left.figures and n in right.figures}
    apart = [name for name, (a, b) in judged.items() if a != b]
    return {
        "first": {"run": run_name(first), "log": first.location, **_told(first, one)},
        "second": {"run": run_name(second), "log": second.location, **_told(second, other)},
        "prompts": one["prompts"],
        "only_in_first": sorted(ids - others),
        "only_in_second": sorted(others - ids),
        "figures": differences(left, right, [n for n in judged if n not in apart], seed=seed, resamples=resamples),
        "scored_differently": {n: {"first": judged[n][0], "second": judged[n][1]} for n in apart},
    }


def refuse_others(first: EvalLog, second: EvalLog) -> None:
    """Refuse runs that do not compare.

    Raises:
        RefusedError: their sets of prompts or their templates are not the same; both are named.
    """
    one, other = identity_of(first), identity_of(second)
    for what, key in (("sets of prompts", "prompts"), ("templates of the whole prompt", "template")):
        if one[key] != other[key]:
            raise RefusedError(
                f"runs of different {what} do not compare: {run_name(first)} has {_words(one[key])}, {run_name(second)} has {_words(other[key])}; "
                "run one of them again on the other's"
            )


def differences(
    first: RunFigures, second: RunFigures, names: Sequence[str], *, seed: int = 1, resamples: int = RESAMPLES
) -> dict[str, dict[str, Any]]:
    """Paired differences by figure, over prompts of which both runs have a mean; `without` names the other prompts."""
    found = {}
    for name in names:
        if name not in first.figures or name not in second.figures:
            continue
        left, right = first.figures[name].means, second.figures[name].means
        both = [p for p in left if left[p] is not None and right.get(p) is not None]
        if both:
            pairs = {p: (left[p] or 0.0, right[p] or 0.0) for p in both}
            made = paired_bootstrap(
                {p: v[0] for p, v in pairs.items()}, {p: v[1] for p, v in pairs.items()}, seed=seed, resamples=resamples
            )
            found[name] = {**asdict(made), "moved": made.moved, "without": sorted((left.keys() & right.keys()) - set(both))}
    return found


def told_difference(name: str, told: dict[str, Any]) -> str:
    """One line for a person."""
    figure = FIGURES[name]
    values = {k: f"{told[k]:.{figure.digits}f}" for k in ("first", "second")}
    spread = f"{told['difference']:+.{figure.digits}f}, 95 % from {told['low']:+.{figure.digits}f} to {told['high']:+.{figure.digits}f}"
    same = "" if told["same_sign"] is None else f"; {100 * told['same_sign']:.0f} % of resamples have its sign"
    better = {"higher": told["difference"] > 0, "lower": told["difference"] < 0}.get(figure.better)
    word = "no movement seen" if not told["moved"] else "moved" if better is None else "better" if better else "worse"
    return f"{figure.title}: {word}: {values['first']} -> {values['second']} ({spread}{same}; {told['prompts']} prompts)"


def _told(log: EvalLog, identity: dict[str, Any]) -> dict[str, Any]:
    solver = (log.eval.solver or "").rpartition("/")[2]
    return {
        "agent": solver,
        "model": log.eval.model,
        **{k: identity[k] for k in ("ablation", "budget", "server", "tools_sha256")},
    }


def _words(known: dict[str, Any]) -> str:
    named = " ".join(str(known[k]) for k in ("name", "version") if known.get(k) not in (None, ""))
    return f"{named or 'none'} (sha256 {str(known.get('sha256', ''))[:12] or 'none'})"
