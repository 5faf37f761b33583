"""Runs that are done: metrics added to them, reports about them, comparisons between them."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
from inspect_ai.log import EvalLog, EvalSample, read_eval_log, write_eval_log
from scipy.stats import binom
from worldagent.bench.evaluation.compare import compare_runs, told_difference
from worldagent.bench.evaluation.figures import scored_value
from worldagent.bench.evaluation.records import Record
from worldagent.bench.evaluation.report.document import BeatNotes, report_document
from worldagent.bench.evaluation.report.films import film_sheets
from worldagent.bench.evaluation.report.page import report_page
from worldagent.bench.evaluation.results import samples_of
from worldagent.bench.evaluation.runs import open_run, run_name
from worldagent.bench.evaluation.scoring import forecast_films, metric_names, score_log
from worldagent.server.cli import main as command_line
from worldagent.tests.bench.evaluation.fake_judge import answering, perfect
from worldagent.tests.bench.evaluation.finished import finished_run, with_scores
from worldagent.worlds.errors import InputError, RefusedError

pytestmark = pytest.mark.filterwarnings(
    "ignore::pytest.PytestUnraisableExceptionWarning", "ignore::ResourceWarning", "ignore::DeprecationWarning"
)
PROMPTS = ("volcano", "hotel_corridor")


@pytest.fixture(scope="module")
def kept() -> dict[str, Any]:
    return {}


@pytest.fixture
def run(kept: dict[str, Any], tmp_path_factory: pytest.TempPathFactory, fake: Any, documents: Callable[..., Path]) -> EvalLog:
    """One finished run for the whole module, read anew."""
    if not kept:
        kept["log"] = finished_run(tmp_path_factory.mktemp("finished"), documents, PROMPTS).location
    return read_eval_log(kept["log"])


def volcano(log: EvalLog) -> EvalSample:
    """The first repeat of that prompt."""
    return next(s for s in log.samples or () if (s.id, s.epoch) == ("volcano", 1))


def at(log: EvalLog, place: Path) -> EvalLog:
    """The run with its log elsewhere, so that others find theirs as it was."""
    log.location = str(place)
    write_eval_log(log)
    return read_eval_log(str(place))


def test_a_finished_run_is_scored_by_a_judge_and_nothing_is_paid_for_twice(run: EvalLog, tmp_path: Path) -> None:
    log = at(run, tmp_path / "scored.eval")
    model, provider = answering(lambda text, _: "?" if "viewpoints" in text else perfect(text))
    told = forecast_films(log.samples or (), ("caus",), prices=(3.0, 15.0))
    assert told.calls == 4 * 9
    assert score_log(log, ("pen", "caus", "qual"), judge=model) == 12
    again = read_eval_log(str(tmp_path / "scored.eval"))
    assert [scored_value(s, "caus") for s in again.samples or ()] == pytest.approx([0.85] * 4)
    assert {str(s.scores["pen"].explanation) for s in again.samples or () if s.scores} == {
        "the sample left no world of its prompt"
    }
    assert {s.name for s in again.results.scores if s.metrics and s.scorer in ("caus", "pen", "qual")} == {"caus", "pen", "qual"}
    assert again.results.scores[0].scorer == "verified"
    asked = len(provider.asked)
    assert forecast_films(again.samples or (), ("caus",)).calls == 0
    assert score_log(again, ("caus",), judge=model) == 0
    assert len(provider.asked) == asked
    assert score_log(again, ("caus", "qual"), judge=answering()[0]) == 4
    assert [scored_value(s, "qual") for s in read_eval_log(str(tmp_path / "scored.eval")).samples or ()] == pytest.approx(
        [0.8] * 4
    )
    assert [r.outcome for r in samples_of(again)] == ["refused"] * 4


def test_the_command_scores_a_run_by_its_folder_and_says_before_what_it_costs(
    run: EvalLog, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = str((run.eval.metadata or {})["run"])
    words = ["eval", "score", folder, "--metrics", "comp", "--judge", "fakejudge/x", "--prices", "3/15"]
    assert command_line(words) == 0
    said = capsys.readouterr()
    assert re.match(r"judge fakejudge/x for comp, at most: \d+ calls with \d+ pictures, .* USD", said.err)
    told = json.loads(said.out)
    assert (told["asked"], told["metrics"]["comp"]["average"], told["unscored"]) == (4, 1.0, [])
    assert command_line(["eval", "score", folder, "--metrics", "comp"]) == 2
    assert "comp ask a judge; name its model with --judge PROVIDER/MODEL" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["run", "small", "--agent", "scripted", "--metrics", "pen,fun"], "metrics fun must be among pen, caus"),
        (["run", "small", "--agent", "scripted", "--metrics", "all"], "caus, qual, comp, prod ask a judge"),
        (["run", "smoke", "--agent", "scripted", "--metrics", "pen"], "has no prompt of the benchmark"),
        (["score", "/nowhere", "--metrics", "pen"], "no run '/nowhere'"),
        (["report", "/nowhere"], "no run '/nowhere'"),
    ],
)
def test_misuse_is_refused_before_anything_starts(words: list[str], text: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert command_line(["eval", *words]) == 2
    assert text in capsys.readouterr().err


def test_a_run_may_be_scored_by_metrics_at_once_and_forecasts_the_judge_first(
    tmp_path: Path, fake: Any, documents: Callable[..., Path], capsys: pytest.CaptureFixture[str]
) -> None:
    folder = documents(crate_slides=[{}], study=[{}])
    words = ["--agent", "scripted", "--agent-arg", f"folder={folder}", "--samples", "study", "--root", str(tmp_path / "runs")]
    assert command_line(["eval", "run", "small", *words, "--metrics", "qual,pen", "--judge", "fakejudge/x"]) == 0
    said = capsys.readouterr()
    assert said.err.startswith("judge fakejudge/x for qual, at most: 8 calls with 48 pictures")
    log = read_eval_log(json.loads(said.out)["log"])
    (sample,) = log.samples or []
    assert set(sample.scores or {}) == {"verified", "pen", "qual"}
    assert "no film" in str((sample.scores or {})["qual"].explanation)
    assert json.loads(said.out)["samples"][0]["outcome"] == "refused"


def test_metrics_are_named_in_any_order_and_come_in_that_of_the_table() -> None:
    assert metric_names("prod, pen") == ("pen", "prod")
    assert metric_names("all") == ("pen", "caus", "qual", "comp", "align", "imag", "prod")
    assert metric_names("") == ()


def test_a_run_is_found_by_folder_log_or_place_of_its_log(run: EvalLog, tmp_path: Path) -> None:
    folder = Path(str((run.eval.metadata or {})["run"]))
    assert open_run(folder).location == open_run(Path(run.location)).location == open_run(folder.parent).location
    assert run_name(run) == folder.name
    for place in (tmp_path, tmp_path / "nothing.eval"):
        with pytest.raises(InputError, match=r"0 logs|no run"):
            open_run(place)


def test_a_comparison_has_the_known_answer_and_leaves_out_what_others_scored(run: EvalLog) -> None:
    first = with_scores(run, {"caus": {"volcano": 0.2, "hotel_corridor": 0.4}, "pen": dict.fromkeys(PROMPTS, 0.1)}, judge="a")
    second = with_scores(run, {"caus": {"volcano": 0.3, "hotel_corridor": 0.4}}, judge="a")
    other = with_scores(run, {"caus": {"volcano": 0.3, "hotel_corridor": 0.4}}, judge="b")
    found = compare_runs(first, second, seed=2)
    caus = found["figures"]["caus"]
    low, high = 0.1 * binom.ppf([0.025, 0.975], 2, 0.5) / 2
    assert (caus["difference"], caus["low"], caus["high"]) == pytest.approx((0.05, low, high))
    assert caus["same_sign"] == pytest.approx(0.75, abs=0.02)
    assert (caus["moved"], "pen" in found["figures"]) == (False, False)
    assert found["figures"]["calls"]["difference"] == 0.0
    assert told_difference("caus", caus).startswith(
        "Caus: no movement seen: 0.3000 -> 0.3500 (+0.0500, 95 % from +0.0000 to +0.1000; 7"
    )
    apart = compare_runs(first, other)
    assert apart["scored_differently"] == {"caus": {"first": [{"judge": "a"}], "second": [{"judge": "b"}]}}
    assert "caus" not in apart["figures"]


def test_a_prompt_that_one_run_has_no_value_of_is_left_out_by_name(run: EvalLog) -> None:
    first = with_scores(run, {"imag": {"volcano": 0.2, "hotel_corridor": 0.4}})
    second = with_scores(run, {"imag": {"volcano": 0.3, "hotel_corridor": float("nan")}})
    told = compare_runs(first, second)["figures"]["imag"]
    assert (told["prompts"], told["without"]) == (1, ["hotel_corridor"])
    assert told["difference"] == pytest.approx(0.1)


@pytest.mark.parametrize(("key", "changed"), [("prompts", {"version": "99"}), ("template", {"version": 99})])
def test_runs_of_other_prompts_or_templates_are_refused_by_name(run: EvalLog, key: str, changed: dict[str, Any]) -> None:
    other = run.model_copy(deep=True)
    told = dict(other.eval.metadata or {})
    other.eval.metadata = {**told, "run": "/runs/other", key: {**told[key], **changed}}
    with pytest.raises(RefusedError, match=rf"different .*{run_name(run)} has .*other has .*99"):
        compare_runs(run, other)
    with pytest.raises(RefusedError, match="do not compare"):
        report_document(run, [other])


class Seen(HTMLParser):
    """Tags and text of a page."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        self.text += data


def test_the_report_has_the_papers_table_intervals_outcomes_and_films_and_asks_nothing_of_a_network(run: EvalLog) -> None:
    log = with_scores(run, {"pen": {"volcano": 0.0, "hotel_corridor": 0.1}, "caus": dict.fromkeys(PROMPTS, 0.5)}, judge="a")
    sample = volcano(log)
    assert sample.scores is not None
    sample.scores["caus"].value = 0.7
    sample.scores["verified"].explanation = "<script>alert(1)</script>"
    beside = with_scores(run, {"pen": dict.fromkeys(PROMPTS, 0.2)})
    document = report_document(log, [beside])
    json.dumps(document, allow_nan=False)
    pen, caus = (document["figures"][n] for n in ("pen", "caus"))
    assert (pen["average"], pen["interval"]) == (0.05, [0.05, 0.05])
    assert caus["by_prompt"]["volcano"]["values"] == [0.7, 0.5]
    assert caus["by_prompt"]["volcano"]["mean"] == pytest.approx(0.6)
    assert caus["by_prompt"]["volcano"]["interval"] == pytest.approx([0.6 - 12.7062 * 0.1, 0.6 + 12.7062 * 0.1], rel=1e-4)
    assert document["outcomes"]["refused"] == 4
    assert document["figures"]["accepted"]["interval"] == pytest.approx([0.0, 3.8415 / (4 + 3.8415)], rel=1e-4)
    assert document["samples"][0]["film"]["frames"] == 40
    page = report_page(document, film_sheets([log, beside]))
    seen = Seen(page)
    assert not [t for t, _ in seen.tags if t in ("script", "link", "iframe")]
    pictures = [a for t, a in seen.tags if t == "img"]
    assert len(pictures) == 8
    assert all(str(a["src"]).startswith("data:image/") and a["alt"] for a in pictures)
    assert "default-src 'none'" in page
    for words in ("Pen ↓", "Prod ↑", "0.0500 [0.0500, 0.0500]", "<script>alert(1)</script>", "macro average", "4 refused"):
        assert words in seen.text
    assert [a["scope"] for t, a in seen.tags if t == "th"].count("row") > 10


def test_an_average_with_a_prompt_missing_is_none_and_says_of_how_many(run: EvalLog) -> None:
    log = with_scores(run, {"imag": {"volcano": 0.5, "hotel_corridor": float("nan")}})
    document = report_document(log)
    assert (document["figures"]["imag"]["average"], document["figures"]["imag"]["prompts_scored"]) == (None, 1)
    assert "– (1 of 2 prompts)" in Seen(report_page(document, {})).text
    assert {u["sample"] for u in document["unscored"]} == {"hotel_corridor"}


def test_beats_of_the_server_stand_beside_the_judges_and_disputed_ones_are_told(run: EvalLog, tmp_path: Path) -> None:
    sample = volcano(run)
    names = [b["id"] for b in sample.metadata["scene"]["beats"]]
    answers = [{"key": f"causal_beat:{b}:{k}:0", "scores": {"completion": 1.0 if k < 3 else 0.0}} for k, b in enumerate(names)]
    judged = with_scores(run, {"caus": dict.fromkeys(PROMPTS, 0.5)}, answers=answers)
    sample = volcano(judged)
    assert sample.scores is not None
    record = tmp_path / "record"
    record.mkdir()
    rows = {f"beat:w{k}": {"status": "pass"} for k in range(4)} | {"support:box": {"status": "pass"}}
    Record(record).write("matrix.json", {"w": {"rows": rows}})
    sample.metadata["attempt"]["record"] = str(record)
    verdict = {"verdict": "incomplete", "rows": {"pass": 3, "fail": 1}, "failing": [{"id": "beat:w1", "status": "fail"}]}
    sample.scores["verified"].answer, sample.scores["verified"].metadata = "w", {"verdict": verdict}
    note = BeatNotes(pairs={names[k]: (f"w{k}",) for k in range(4)}, ruled={names[1]: "did_not"})
    document = report_document(judged, notes={"volcano:1": note})
    beats = document["beats"]["samples"]["volcano:1"]
    assert [b["outcome"] for b in beats["beats"]] == ["agree", "disputed", "agree", "disputed", "undecided"]
    assert [b["server"] for b in beats["beats"]] == ["pass", "fail", "pass", "pass", "unmatched"]
    assert (beats["disputed"], beats["agreement"], beats["server_right"], beats["open"]) == ([names[1], names[3]], 0.5, 1, 1)
    assert "the server was right" in Seen(report_page(document, {})).text


def test_the_commands_write_a_report_and_compare_runs(run: EvalLog, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    notes = tmp_path / "beats.json"
    notes.write_text(json.dumps({"samples": {"volcano": {"pairs": {"a": ["b"]}}}}))
    assert command_line(["eval", "report", run.location, "--out", str(tmp_path / "out"), "--beats", str(notes)]) == 0
    made = json.loads(capsys.readouterr().out)
    assert Path(made["html"]).read_text().startswith("<!DOCTYPE html>")
    assert json.loads(Path(made["json"]).read_text())["made_with"]["prompts"]["name"] == "agenticsimbench"
    assert command_line(["eval", "compare", run.location, run.location]) == 0
    said = capsys.readouterr()
    assert "refused calls: no movement seen: 1.0 -> 1.0" in said.err
    assert json.loads(said.out)["figures"]["refused_calls"]["prompts"] == 2
    notes.write_text("{}")
    assert command_line(["eval", "report", run.location, "--beats", str(notes)]) == 2
    assert "holds no notes on beats" in capsys.readouterr().err
