"""Pages of runs: tables as in the paper, values per task, contact sheets, and what everything was made with; one file, no script."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

from ....rendering.report.markup import cell, escaped, figure, table, tag
from ....rendering.report.style import STYLE
from ....worlds.folder import write_atomically
from .averages import Estimate, macro, per_task
from .comparing import Comparison, compare
from .runs import METRICS, Metric, Run, SampleScores, write_run

__all__ = ["comparison_page", "run_page", "write_comparison", "write_report"]

Sheets = Mapping[str, bytes]
"""Contact sheets by name of their file."""


def run_page(run: Run, sheets: Sheets) -> str:
    """The page of one run."""
    notes = "".join(tag("p", escaped(note), class_="fail") for note in run.notes)
    return _page(
        f"{run.method} on {run.prompts.get('name', 'prompts')}",
        tag("p", escaped(f"{run.model}, {len(run.tasks)} tasks, {len(run.samples)} samples, {run.created}"), class_="dim")
        + notes
        + _section("Macro averages", _macro_table([run]))
        + _section("Tasks", _task_table(run))
        + _section("Without a score", _reasons(run))
        + _section("Films", "".join(_film(sample, sheets) for sample in run.samples))
        + _section("Made with", _made_with(run)),
    )


def comparison_page(first: Run, second: Run, compared: Mapping[str, Comparison], sheets: tuple[Sheets, Sheets]) -> str:
    """The page of two runs side by side."""
    films = "".join(_both(task, first, second, sheets) for task in dict.fromkeys([*first.tasks, *second.tasks]))
    return _page(
        f"{first.method} and {second.method}",
        _section("Macro averages", _macro_table([first, second]))
        + _section("Differences, second less first", _differences(compared))
        + _section("Films", films)
        + _section("Made with", _made_with(first) + _made_with(second)),
    )


def write_report(run: Run, folder: Path, sheets: Sheets) -> tuple[Path, Path]:
    """Write page, JSON file and contact sheets of a run into a folder; returns the first two."""
    page, data = folder / "report.html", folder / "report.json"
    for name, picture in sheets.items():
        write_atomically(folder / name, picture)
    write_run(run, data)
    write_atomically(page, run_page(run, sheets).encode())
    return page, data


def write_comparison(first: Run, second: Run, path: Path, sheets: tuple[Sheets, Sheets], *, seed: int = 0) -> dict[str, Comparison]:
    """Compare two runs and write the page."""
    compared = compare(first, second, seed=seed)
    write_atomically(path, comparison_page(first, second, compared, sheets).encode())
    return compared


def _page(title: str, inner: str) -> str:
    head = f'<meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{escaped(title)}</title><style>{STYLE}</style>'
    return f'<!doctype html><html lang="en"><head>{head}</head><body>{tag("h1", escaped(title))}{inner}</body></html>'


def _section(title: str, inner: str) -> str:
    return tag("section", tag("h2", escaped(title)) + inner) if inner else ""


def _title(metric: Metric) -> str:
    return f"{metric.title} {'↑' if metric.higher else '↓'}"


def _shown(metrics: Sequence[Metric], runs: Sequence[Run]) -> list[Metric]:
    """Metrics that anyone was asked for."""
    return [m for m in metrics if any(m.name in s.scores for run in runs for s in run.samples)]


def _number(estimate: Estimate) -> str:
    if estimate.value is None:
        told = f"{estimate.scored} of {estimate.samples}" if estimate.samples else ""
        return cell(f"–<br>{tag('small', told, class_='dim')}", "n")
    around = "" if estimate.low is None or estimate.high is None else f"<br>{tag('small', f'[{estimate.low:.4f}, {estimate.high:.4f}]', class_='dim')}"
    return cell(f"{estimate.value:.4f}{around}", "n")


def _macro_table(runs: Sequence[Run]) -> str:
    shown = _shown(METRICS, runs)
    rows = [[cell(escaped(run.method), "n"), *(_number(macro(run, m.name)) for m in shown)] for run in runs]
    groups = "; ".join(f"{group}: {', '.join(m.title for m in shown if m.group == group)}" for group in dict.fromkeys(m.group for m in shown))
    words = f"{groups}. A dash: not every sample has a score. In brackets: 95 % over repeats."
    return table(["Method", *(_title(m) for m in shown)], rows) + tag("p", escaped(words), class_="dim")


def _task_table(run: Run) -> str:
    shown = _shown(METRICS, [run])
    columns = {m.name: per_task(run, m.name) for m in shown}
    rows = []
    for task in run.tasks:
        outcomes = Counter(s.outcome for s in run.of_task(task))
        told = ", ".join(f"{count} {outcome}" for outcome, count in outcomes.items())
        rows.append([cell(escaped(task), "n"), cell(escaped(told), "n"), *(_number(columns[m.name][task]) for m in shown)])
    return table(["Task", "Outcome", *(_title(m) for m in shown)], rows)


def _reasons(run: Run) -> str:
    rows = [
        [cell(escaped(f"{s.task} {s.repeat}"), "id"), cell(escaped(metric)), cell(escaped(reason))]
        for s in run.samples
        for metric, reason in s.reasons.items()
        if s.scores.get(metric) is None
    ]
    return table(["Sample", "Metric", "Reason"], rows) if rows else ""


def _film(sample: SampleScores, sheets: Sheets) -> str:
    return figure(sheets.get(sample.sheet), f"{sample.task}, repeat {sample.repeat}", f"frames of the film of {sample.task}")


def _both(task: str, first: Run, second: Run, sheets: tuple[Sheets, Sheets]) -> str:
    """The first film of a task of either run, side by side."""
    cells, runs = [], (first, second)
    if not any(s.sheet in own for run, own in zip(runs, sheets, strict=True) for s in run.of_task(task)):
        return ""
    for run, own in zip(runs, sheets, strict=True):
        sample = next((s for s in run.of_task(task) if s.sheet in own), None)
        cells.append(cell(escaped("no film") if sample is None else figure(own[sample.sheet], run.method, f"frames of the film of {task}")))
    return tag("h3", escaped(task)) + table([first.method, second.method], [cells])


def _differences(compared: Mapping[str, Comparison]) -> str:
    rows = []
    for metric in METRICS:
        found = compared.get(metric.name)
        if found is None or found.difference is None:
            continue
        around = "" if found.low is None or found.high is None else f"[{found.low:+.4f}, {found.high:+.4f}]"
        words = f"{found.difference:+.4f} {tag('span', around, class_='dim')}"
        left = f"{len(found.tasks)}" + (f", without {', '.join(found.left_out)}" if found.left_out else "")
        rows.append([cell(_title(metric)), cell(words, "n"), cell(escaped(found.better)), cell(escaped(left))])
    told = "Paired bootstrap over tasks, 95 %. Better: the run that the whole interval is in favour of."
    return table(["Metric", "Difference", "Better", "Tasks"], rows) + tag("p", told, class_="dim") if rows else ""


def _made_with(run: Run) -> str:
    known = {**{f"prompts {k}": v for k, v in run.prompts.items()}, **run.versions}
    judges = {str(d["judge"]["model"]) for s in run.samples for d in s.details.values() if isinstance(d, Mapping) and isinstance(d.get("judge"), Mapping)}
    rubrics = {str(d["rubric"]["sha256"]) for s in run.samples for d in s.details.values() if isinstance(d, Mapping) and isinstance(d.get("rubric"), Mapping)}
    told = {**known, **({"judge": ", ".join(sorted(judges))} if judges else {}), **({"rubric": ", ".join(sorted(rubrics))} if rubrics else {})}
    return tag("h3", escaped(run.method)) + table(["", ""], [[cell(escaped(k)), cell(escaped(v), "id")] for k, v in sorted(told.items())])
