"""Commands about runs that are done: more metrics, a report, a comparison, people's judgement; and the judge that they share with `run`."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from ...worlds.errors import InputError

__all__ = ["WITHOUT_INSPECT", "add_judge", "add_later_commands", "judge_of", "pairs_of"]

Add = Callable[..., argparse.ArgumentParser]
"""Adds a parser by name."""


def add_later_commands(add: Add) -> None:
    """Add `score`, `report`, `compare` and `study`."""
    score = add("score", help="score a finished run by metrics; what has a value keeps it")
    score.set_defaults(command=_score)
    score.add_argument("run", type=Path, metavar="RUN", help="folder of a run, or its log")
    score.add_argument("--metrics", required=True, metavar="NAME,NAME", help="pen, caus, qual, comp, align, imag, prod, or all")
    score.add_argument("--again", action="store_true", help="score what has a value too")
    add_judge(score)
    report = add("report", help="one HTML page and one JSON file about a run")
    report.set_defaults(command=_report)
    report.add_argument("run", type=Path, metavar="RUN", help="folder of a run, or its log")
    report.add_argument(
        "--beside", type=Path, action="append", default=[], metavar="RUN", help="another run in the same tables (repeatable)"
    )
    report.add_argument(
        "--beats", type=Path, metavar="FILE", help="which beats of the worlds stand for which of the prompts, and rulings"
    )
    report.add_argument("--out", type=Path, metavar="DIR", help="folder of the two files (default: reports beside the run)")
    compare = add("compare", help="two runs over the same prompts, by the paired bootstrap")
    compare.set_defaults(command=_compare)
    compare.add_argument("first", type=Path, metavar="A", help="folder of a run, or its log")
    compare.add_argument("second", type=Path, metavar="B", help="another; differences are B less A")
    compare.add_argument("--seed", type=int, default=1, metavar="N", help="of the draws")
    study = add("study", help="a page on which people judge films, blind")
    study.set_defaults(command=_study)
    study.add_argument(
        "films", type=Path, metavar="FILMS_FOLDER", help="METHOD/TASK.webm (or .mp4), the same tasks of every method"
    )
    study.add_argument("--answers", type=Path, metavar="FILE", help="where answers go (default: FILMS_FOLDER.answers.jsonl)")
    study.add_argument(
        "--prompts", default="agenticsimbench", metavar="SET", help="set of prompts by name or file; its ids are the tasks"
    )
    study.add_argument("--tasks", type=int, default=8, metavar="N", help="tasks that each rater sees")
    study.add_argument("--pairs", type=int, default=8, metavar="N", help="pairs of films that each rater compares after that")
    study.add_argument("--seed", type=int, default=1, metavar="N", help="of the order of tasks, methods and pairs")
    study.add_argument("--port", type=int, default=8765, metavar="N", help="on 127.0.0.1")
    study.add_argument("--results", action="store_true", help="print the answers so far instead: means, strengths, intervals")


def add_judge(parser: argparse.ArgumentParser) -> None:
    """Options of metrics that ask a judge model."""
    parser.add_argument("--judge", metavar="PROVIDER/MODEL", help="model that sees the films, for caus, qual, comp and prod")
    parser.add_argument("--judge-arg", action="append", default=[], metavar="NAME=VALUE", help="argument of the judge")
    parser.add_argument(
        "--prices", default="", metavar="IN/OUT", help="its dollars per million tokens, for the forecast, as 3/15"
    )


def judge_of(options: argparse.Namespace) -> Any:
    """The judge that the options name; None where they name none."""
    from inspect_ai.model import get_model

    return get_model(options.judge, **pairs_of(options.judge_arg)) if options.judge else None


def _score(options: argparse.Namespace) -> int:
    from .figures import METRIC_FIGURES, run_figures, unscored
    from .metrics.scorers import prices_of
    from .runs import open_run
    from .scoring import forecast_films, metric_names, need_judge, score_log

    names, log = metric_names(options.metrics), open_run(options.run)
    asking = need_judge(names, options.judge)
    if asking:
        told = forecast_films(log.samples or (), asking, prices=prices_of(options.prices), again=options.again)
        print(f"judge {options.judge} for {', '.join(asking)}, at most: {told.words()}", file=sys.stderr, flush=True)
    asked = score_log(log, names, judge=judge_of(options), again=options.again)
    found = run_figures(log).figures
    means = {
        f.name: {"average": found[f.name].average, "by_prompt": found[f.name].means} for f in METRIC_FIGURES if f.name in found
    }
    print(json.dumps({"log": log.location, "asked": asked, "metrics": means, "unscored": unscored(log)}))
    return 0


def _report(options: argparse.Namespace) -> int:
    from .report.document import beat_notes, report_document
    from .report.films import film_sheets
    from .report.page import report_page
    from .runs import open_run, run_name

    log, beside = open_run(options.run), [open_run(place) for place in options.beside]
    folder = options.out or Path(str((log.eval.metadata or {}).get("run") or log.location)).parent / "reports"
    document = report_document(log, beside, notes=beat_notes(options.beats))
    page = report_page(document, film_sheets([log, *beside]))
    folder.mkdir(parents=True, exist_ok=True)
    places = {kind: folder / f"{run_name(log)}.{kind}" for kind in ("html", "json")}
    places["json"].write_text(json.dumps(document, indent=1, sort_keys=True), encoding="utf-8")
    places["html"].write_text(page, encoding="utf-8")
    print(json.dumps({kind: str(place) for kind, place in places.items()}))
    return 0


def _compare(options: argparse.Namespace) -> int:
    from .compare import compare_runs, told_difference
    from .runs import open_run

    found = compare_runs(open_run(options.first), open_run(options.second), seed=options.seed)
    for name, told in found["figures"].items():
        print(told_difference(name, told), file=sys.stderr)
    for name in found["scored_differently"]:
        print(f"{name}: not compared, since other judges, rubrics or models scored it", file=sys.stderr)
    print(json.dumps(found))
    return 0


def _study(options: argparse.Namespace) -> int:
    from .study.commands import serve_or_tell

    return serve_or_tell(options)


WITHOUT_INSPECT = (_study,)
"""Commands that need no Inspect."""


def pairs_of(given: Sequence[str]) -> dict[str, Any]:
    """Arguments `NAME=VALUE`; a value that is JSON is read as such.

    Raises:
        InputError: one has no `=`.
    """
    found: dict[str, Any] = {}
    for text in given:
        name, sign, value = text.partition("=")
        if not sign or not name.isidentifier():
            raise InputError(f"{text!r} must be NAME=VALUE")
        try:
            found[name] = json.loads(value)
        except ValueError:
            found[name] = value
    return found
