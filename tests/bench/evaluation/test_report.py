"""Reports of runs: averages, intervals, comparisons and pages, on hand-made runs and on a real log."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from inspect_ai.scorer import Score
from worldagent.bench.evaluation.metrics import scorers
from worldagent.bench.evaluation.metrics.film import Film
from worldagent.bench.evaluation.report.averages import macro, per_task
from worldagent.bench.evaluation.report.comparing import compare
from worldagent.bench.evaluation.report.from_log import run_of_log
from worldagent.bench.evaluation.report.page import run_page, write_comparison, write_report
from worldagent.bench.evaluation.report.runs import Run, SampleScores, read_run, write_run
from worldagent.bench.evaluation.report.sheets import film_sheet, sheets_beside
from worldagent.tests.bench.evaluation.fake_judge import answering
from worldagent.tests.bench.evaluation.films import film_file
from worldagent.tests.bench.evaluation.test_metric_scorers import run as evaluated
from worldagent.tests.bench.evaluation.test_metric_scorers import scene
from worldagent.worlds.errors import InputError

pytestmark = [
    pytest.mark.filterwarnings("ignore:The 'initial' parameter is deprecated:DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
]
PROMPTS = {"name": "agenticsimbench", "version": "1", "sha256": "ab"}


def run(values: Mapping[str, Sequence[float | None]], *, metric: str = "caus", method: str = "one", **more: Any) -> Run:
    samples = [
        SampleScores(task, k, "accepted", {metric: v}, {} if v is not None else {metric: "no film"})
        for task, repeats in values.items()
        for k, v in enumerate(repeats, 1)
    ]
    return Run(method, "m", PROMPTS, {"worldagent": "1"}, tuple(samples), **more)


def test_a_macro_average_is_over_tasks_and_its_interval_over_repeats() -> None:
    made = run({"a": [0.2, 0.4], "b": [0.6, 1.0]})
    found = macro(made, "caus")
    assert found.value == pytest.approx(0.55)
    # Macro averages of the repeats: 0.4 and 0.7; Student's factor for one degree of freedom is 12.7062.
    assert (found.low, found.high) == pytest.approx((0.55 - 12.7062 * 0.15, 0.55 + 12.7062 * 0.15), abs=1e-4)
    assert per_task(made, "caus")["a"].value == pytest.approx(0.3)


def test_a_missing_score_leaves_no_average_and_is_counted() -> None:
    found = macro(run({"a": [0.2, 0.4], "b": [0.6, None]}), "caus")
    assert (found.value, found.low, found.high, found.scored, found.samples) == (None, None, None, 3, 4)
    once = macro(run({"a": [0.2], "b": [0.6]}), "caus")
    assert (once.value, once.low) == (pytest.approx(0.4), None)


def test_a_comparison_is_paired_by_task_and_the_same_for_one_seed() -> None:
    tasks = [f"t{k}" for k in range(13)]
    base = {t: [0.1 * (k % 5) + 0.2] for k, t in enumerate(tasks)}
    better = {t: [v[0] + 0.05 + 0.001 * k] for k, (t, v) in enumerate(base.items())}
    found = compare(run(base), run(better))["caus"]
    assert found.difference == pytest.approx(0.056)
    assert 0.05 < found.low < 0.056 < found.high < 0.062  # pairs differ by far less than tasks do
    assert found.better == "second"
    assert compare(run(better), run(base))["caus"].better == "first"
    assert compare(run(base), run(base))["caus"].better == "neither"
    assert compare(run(base), run(better))["caus"] == found
    deeper = compare(run(base, metric="pen"), run(better, metric="pen"))["pen"]
    assert deeper.better == "first"  # lower is better


def test_tasks_that_one_run_did_not_score_are_left_out_and_named() -> None:
    found = compare(run({"a": [0.2], "b": [0.4], "c": [None]}), run({"a": [0.3], "b": [0.6], "d": [1.0]}))["caus"]
    assert (found.tasks, found.left_out) == (("a", "b"), ("c", "d"))
    assert (found.first, found.second) == (pytest.approx(0.3), pytest.approx(0.45))
    assert compare(run({"a": [None]}), run({"a": [0.1]}))["caus"].difference is None


def test_runs_of_different_prompts_do_not_compare() -> None:
    with pytest.raises(InputError, match="different prompts"):
        compare(run({"a": [1.0]}), replace(run({"a": [1.0]}), prompts={**PROMPTS, "version": "2"}))


def test_a_run_comes_back_from_its_file_and_nothing_else_passes_for_one(tmp_path: Path) -> None:
    made = run({"a": [0.2, None]}, notes=("ablation causal",))
    write_run(made, tmp_path / "run.json")
    assert read_run(tmp_path / "run.json") == made
    with pytest.raises(ValueError, match="JSON"):
        write_run(run({"a": [float("nan")]}), tmp_path / "bad.json")
    document = json.loads((tmp_path / "run.json").read_text())
    for change in ({"format": 2}, {"samples": [{"task": "a"}]}, {"extra": 1}, {"samples": [{**document["samples"][0], "scores": {"caus": True}}]}):
        (tmp_path / "other.json").write_text(json.dumps({**document, **change}))
        with pytest.raises(InputError, match="no run of the benchmark"):
            read_run(tmp_path / "other.json")


def test_the_page_shows_values_dashes_and_reasons_and_nothing_acts(tmp_path: Path) -> None:
    made = run({"volcano": [0.5], "<script>alert(1)</script>": [None]}, method="our <b>method</b>")
    text = run_page(made, {})
    assert "0.5000" in text
    assert "1 of 2" in text
    assert "no film" in text
    assert "<script>" not in text
    assert "<b>" not in text
    assert not re.search(r"(src|href)=\"(?!data:)", text)


def test_a_report_is_two_files_with_sheets_and_two_reports_compare_side_by_side(tmp_path: Path) -> None:
    sheet = film_sheet(Film(film_file(tmp_path / "film.avi", 30)))
    picture = cv2.imdecode(np.frombuffer(sheet, np.uint8), cv2.IMREAD_COLOR)
    assert picture is not None
    assert picture.shape[1] > picture.shape[0] * 0.5
    runs = []
    for name, value in (("one", 0.2), ("two", 0.7)):
        made = run({"a": [value], "b": [value + 0.1]}, method=name)
        made = replace(made, samples=tuple(replace(s, sheet=f"{s.task}_1.jpg") for s in made.samples))
        page, data = write_report(made, tmp_path / name, {"a_1.jpg": sheet})
        assert page.read_text().count("data:image/jpeg;base64,") == 1
        runs.append(read_run(data))
    found = write_comparison(runs[0], runs[1], tmp_path / "both.html", (sheets_beside(runs[0], tmp_path / "one"), sheets_beside(runs[1], tmp_path / "two")))
    assert found["caus"].difference == pytest.approx(0.5)
    text = (tmp_path / "both.html").read_text()
    assert text.count("data:image/jpeg;base64,") == 2
    assert "+0.5000" in text
    assert sheets_beside(replace(runs[0], samples=(replace(runs[0].samples[0], sheet="../film.avi"),)), tmp_path / "one") == {}


def test_a_run_is_read_from_a_log_with_scores_reasons_and_sheets(tmp_path: Path) -> None:
    film = film_file(tmp_path / "film.avi", 40)
    model, _ = answering()
    _, log = evaluated(tmp_path, scene(film=str(film)), scorers.caus(), scorers.pen(), grader=model)
    made, sheets = run_of_log(log, prompts=PROMPTS)
    (sample,) = made.samples
    assert sample.scores == {"caus": pytest.approx(0.85), "pen": None}
    assert sample.reasons == {"pen": "the sample left no world of its prompt"}
    assert (sample.outcome, made.method) == ("film", "idle")
    assert sample.details["caus"]["judge"]["model"] == "fakejudge/x"
    assert (sample.figures["tokens"], sample.figures["cost_usd"]) == (0, None)
    assert sample.details["caus"]["input_tokens"] == 900
    assert list(sheets) == [sample.sheet]
    page, data = write_report(made, tmp_path / "report", sheets)
    assert read_run(data).samples[0].scores["caus"] == pytest.approx(0.85)
    assert "fakejudge/x" in page.read_text()


def test_what_a_judge_used_is_not_the_agents_even_where_both_are_one_model(tmp_path: Path) -> None:
    film = film_file(tmp_path / "film.avi", 40)
    model, _ = answering()
    _, log = evaluated(tmp_path, scene(film=str(film)), scorers.caus(), grader=model, agent=model)
    (told,) = log.samples
    assert told.model_usage["fakejudge/x"].input_tokens == 900
    told.model_usage["fakejudge/x"].input_tokens += 5000  # as if the agent had asked too
    made, _ = run_of_log(log, prompts=PROMPTS, films=False, prices={"fakejudge/x": (10.0, 100.0)})
    assert made.samples[0].figures["tokens"] == 5000
    assert made.samples[0].figures["cost_usd"] == pytest.approx(0.05)


def test_a_log_with_the_servers_verdict_gives_outcome_and_its_figures(tmp_path: Path) -> None:
    """The scorer `verified` of the harness gives a table of values, and the answer of `worldagent verify` beside it."""
    _, log = evaluated(tmp_path, scene(attempt={"ablation": "causal"}), scorers.pen())
    (sample,) = log.samples
    verdict = {"verdict": "accepted", "says": "accepted", "rows": {"pass": 9}, "approximations": [1, 2]}
    sample.scores["verified"] = Score(value={"accepted": 1.0, "calls": 12.0}, metadata={"verdict": verdict, "server_verdict": {"weakenings": [{"weakenings": ["a"]}]}})
    made, sheets = run_of_log(log, prompts=PROMPTS, method="mine")
    (one,) = made.samples
    assert (one.outcome, one.scores["accepted"], sheets) == ("accepted", 1.0, {})
    assert (one.figures["calls"], one.figures["approximations"], one.figures["weakenings"], one.figures["rows"]) == (12, 2, 1, {"pass": 9})
    assert made.notes == ("ablation causal: nothing here is an acceptance",)
    assert "nothing here is an acceptance" in run_page(made, {})
