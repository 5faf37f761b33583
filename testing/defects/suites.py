"""The list of suites, one module per check, and the benchmark over all of them."""

from __future__ import annotations

import ast
import hashlib
import importlib
import multiprocessing
import secrets
import sys
import time
from concurrent.futures import Executor, ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ...execution.processes import core_count
from ...worlds.canonical import source_digest
from .cases import Suite
from .judge import Drawn, Outcome, draw, interval, outcome, smallest_detected

__all__ = ["CHECKS", "run", "suite_digest", "suite_of", "table", "verifiers_digest"]

CHECKS = (
    "terrain",
    "scale",
    "interpenetration",
    "support",
    "navigability",
    "interiors",
    "causal",
    "story",
    "category",
    "elastic",
    "liquid",
    "liquid_soft",
    "particles",
    "gas",
    "cloth",
    "fracture",
    "numerical",
    "contact",
    "shots",
)
"""Suites: module `testing/defects/<name>.py`, attribute `SUITE`. Those of categories (elastic to fracture) are of the category
check, that of the story is of the beat check, mechanisms of interiors name theirs."""
VARIANTS = 102
"""Generated worlds of each kind per check."""


def suite_of(check: str) -> Suite:
    """The suite of one check."""
    found: Suite = importlib.import_module(f".{check}", __package__).SUITE
    return found


def run(
    *,
    checks: tuple[str, ...] = CHECKS,
    variants: int = VARIANTS,
    seed: int | None = None,
    accepted: bool = True,
    jobs: int | None = None,
) -> dict[str, Any]:
    """Judge every suite; figures per check, and the share of defects found and of sound worlds refused.

    Args:
        checks: which suites; none, and `accepted`: the accepted worlds alone.
        variants: generated worlds of each kind per check.
        seed: draws magnitudes and details; default a new one, which the figures name.
        accepted: also build, bake and judge every world that was accepted once.
        jobs: processes that judge worlds beside each other; default one a core.
    """
    seed = secrets.randbelow(2**31) if seed is None else seed
    figures: dict[str, Any] = {}
    with _pool(jobs or core_count()) as pool:
        for check in checks:
            start = time.perf_counter()
            outcomes = _surveyed(pool, check, variants, seed)
            figures[check] = {**_figures(suite_of(check), outcomes, seed), "suite": suite_digest(check)}
            print(f"{check}: {len(outcomes)} worlds in {time.perf_counter() - start:.0f} s", file=sys.stderr, flush=True)
    kept = _rejudged() if accepted else None
    print(table(figures), file=sys.stderr, flush=True)
    broken, clean = (sum(f[k] for f in figures.values()) for k in ("broken", "clean"))
    found, alarms = (sum(f[k] for f in figures.values()) for k in ("detected", "false_alarms"))
    return {
        "seed": seed,
        "verifiers": verifiers_digest(),
        "checks": figures,
        "accepted": kept,
        "detection": found / max(1, broken),
        "detection_95": interval(found, broken),
        "false_alarm": alarms / max(1, clean),
        "false_alarm_95": interval(alarms, clean),
    }


def _rejudged() -> dict[str, Any]:
    """Accepted worlds judged anew: a check that leaves a mandatory row open raises a false alarm."""
    from .accepted import recorded, rejudge, showcases, specifications

    figures: dict[str, Any] = {"worlds": 0, "checks": 0, "false_alarms": 0, "open_rows": {}}
    for name, spec in [*specifications(), *recorded(), *showcases()]:
        found = rejudge(name, spec)
        alarmed = {r.check for r in found.alarms}
        figures["worlds"] += 1
        figures["checks"] += len(found.checks)
        figures["false_alarms"] += len(alarmed)
        if alarmed:
            figures["open_rows"][name] = [r.id for r in found.alarms]
        text = f"accepted {name}: {len(found.checks)} checks, {len(alarmed)} false alarms, judged in {found.seconds:.1f} s"
        print(text, file=sys.stderr, flush=True)
    figures["false_alarm_95"] = interval(figures["false_alarms"], figures["checks"])
    return figures


def _pool(jobs: int) -> ProcessPoolExecutor:
    return ProcessPoolExecutor(jobs, mp_context=multiprocessing.get_context("spawn"))


def _outcome(check: str, drawn: Drawn) -> Outcome:
    return outcome(suite_of(check), drawn)


def _surveyed(pool: Executor, check: str, variants: int, seed: int) -> list[Outcome]:
    """Outcomes of all drawn worlds of one suite, in the order of the draw."""
    found = []
    for one in pool.map(partial(_outcome, check), draw(suite_of(check), variants=variants, seed=seed)):
        found.append(one)
        _tell(check, one)
    return found


def suite_digest(check: str) -> str:
    """SHA-256 over the modules of a suite: its own and those of `testing/defects/` that they import."""
    folder, state = Path(__file__).parent, hashlib.sha256()
    found, seen = [check], set()
    while found:
        name = found.pop()
        path = folder / f"{name}.py"
        if name in seen or not path.exists():
            continue
        seen.add(name)
        found += [
            word
            for node in ast.walk(ast.parse(path.read_text()))
            if isinstance(node, ast.ImportFrom) and node.level == 1
            for word in ([node.module] if node.module else [a.name for a in node.names])
        ]
    for name in sorted(seen):
        state.update(name.encode() + (folder / f"{name}.py").read_bytes())
    return state.hexdigest()


def verifiers_digest() -> str:
    """SHA-256 over the source of the verifiers, which judged the worlds of a run."""
    return source_digest(Path(__file__).parents[2] / "verifiers")


def _tell(check: str, outcome: Outcome) -> None:
    if not outcome.right:
        what = "missed" if outcome.broken else "false alarm"
        print(f"{check}: {what}: {outcome.mechanism} at {outcome.magnitude!r}, seed {outcome.seed}", file=sys.stderr, flush=True)


def _figures(suite: Suite, outcomes: list[Outcome], seed: int) -> dict[str, Any]:
    broken, clean = ([o for o in outcomes if o.broken == kind] for kind in (True, False))
    detected, alarms = sum(o.right for o in broken), sum(not o.right for o in clean)
    return {
        "broken": len(broken),
        "detected": detected,
        "detection_95": interval(detected, len(broken)),
        "clean": len(clean),
        "false_alarms": alarms,
        "false_alarm_95": interval(alarms, len(clean)),
        "median_ms": round(float(np.median([o.milliseconds for o in outcomes])), 2),
        "mechanisms": {"broken": len(suite.of(broken=True)), "clean": len(suite.of(broken=False))},
        "hand_picked": {"broken": sum(o.named for o in broken), "clean": sum(o.named for o in clean)},
        "smallest_detected": {
            m.name: {"magnitude": smallest_detected(suite.check, m, seed), "bound": m.bound, "unit": m.unit}
            for m in suite.of(broken=True)
            if m.bound is not None
        },
        "missed": [{"mechanism": o.mechanism, "magnitude": o.magnitude, "seed": o.seed} for o in outcomes if not o.right],
    }


def table(figures: dict[str, Any]) -> str:
    """The figures as text, one line per check and one per smallest defect."""
    lines = [f"{'check':16} {'detected':>12} {'95 %':>16} {'false alarms':>13} {'95 %':>16} {'median ms':>10}"]
    for check, f in figures.items():
        found, alarm = (f"{100 * f[k][0]:.2f}-{100 * f[k][1]:.2f} %" for k in ("detection_95", "false_alarm_95"))
        lines.append(
            f"{check:16} {f['detected']:>5} / {f['broken']:<4} {found:>16} {f['false_alarms']:>6} / {f['clean']:<4} {alarm:>16} "
            f"{f['median_ms']:>10.2f}"
        )
    lines.append("smallest detected defect (bound)")
    for check, f in figures.items():
        for name, least in f["smallest_detected"].items():
            value = "not found" if least["magnitude"] is None else f"{least['magnitude']:.4g}"
            lines.append(f"  {check}: {name}: {value} {least['unit']} ({least['bound']:.4g})")
    return "\n".join(lines)
