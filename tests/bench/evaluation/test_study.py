"""The study of people's judgement: order, answers, the page over real requests, means and strengths."""

from __future__ import annotations

import http.client
import json
import re
import threading
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from itertools import pairwise
from math import log
from pathlib import Path
from types import MappingProxyType
from typing import Any
from urllib.parse import urlencode

import cv2
import numpy as np
import pytest
from worldagent.bench.evaluation.study.answers import CRITERIA, AnswerFile, read_lines
from worldagent.bench.evaluation.study.design import Study, williams
from worldagent.bench.evaluation.study.films import StudyFilms, read_films
from worldagent.bench.evaluation.study.results import study_results
from worldagent.bench.evaluation.study.serving import StudyPage, study_server
from worldagent.bench.evaluation.study.strengths import Comparison, bradley_terry, strengths
from worldagent.server.cli import main as command_line
from worldagent.worlds.errors import InputError

PAPER = Study(tuple("mops" + c for c in "abcdef"), tuple(f"task{k}" for k in range(13)))
"""Six methods, thirteen tasks, eight of them for each rater."""
METHODS = ("direct_prompting", "tool_calls", "verified_worlds")
PROMPTS = {"volcano": "A volcano erupts.", "aquarium": "A pane breaks & water runs out."}


def small_film(path: Path, *, frames: int = 4, size: tuple[int, int] = (48, 64)) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"VP80"), 24.0, (size[1], size[0]))
    for k in range(frames):
        writer.write(np.full((*size, 3), 20 * k, dtype=np.uint8))
    writer.release()


@pytest.fixture
def films(tmp_path: Path) -> StudyFilms:
    for method in METHODS:
        for task in PROMPTS:
            small_film(tmp_path / "films" / method / f"{task}.webm", frames=4 + METHODS.index(method))
    return read_films(tmp_path / "films", PROMPTS)


@contextmanager
def served(films: StudyFilms, place: Path, **options: Any) -> Iterator[Rater]:
    study = Study(films.methods, tuple(films.tasks), **{"tasks_each": 2, "pairs_each": 1, **options})
    with study_server(StudyPage(films, AnswerFile(place, study, films.digest))) as server:
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01}, daemon=True)
        thread.start()
        try:
            yield Rater(server.server_address[1])
        finally:
            server.shutdown()
            thread.join(10)


class Rater:
    """A browser of one participant, and all that it was shown or asked for."""

    def __init__(self, port: int) -> None:
        self.port, self.place, self.cookie, self.seen = port, "/", "", ""

    def ask(
        self, method: str, path: str, form: dict[str, Any] | None = None, **headers: str
    ) -> tuple[int, dict[str, str], bytes]:
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=20)
        body = None if form is None else urlencode(form)
        connection.request(
            method,
            path,
            body,
            {**({"Cookie": self.cookie} if self.cookie else {}), **{k.replace("_", "-"): v for k, v in headers.items()}},
        )
        reply = connection.getresponse()
        data, told = reply.read(), dict(reply.getheaders())
        connection.close()
        if cookie := told.get("Set-Cookie"):
            self.cookie = cookie.partition(";")[0]
        self.seen += f"{method} {path} {told} {data.decode('utf-8', 'replace') if 'html' in told['Content-Type'] else ''}"
        return reply.status, told, data

    def begin(self) -> str:
        status, told, _ = self.ask("POST", "/", {"consent": "yes"})
        assert status == 303
        self.place = told["Location"]
        return self.page()

    def page(self) -> str:
        status, _, data = self.ask("GET", self.place)
        assert status == 200
        return data.decode()

    def send(self, page: str, score: int = 4, *, changes: Mapping[str, str] = MappingProxyType({})) -> tuple[int, str]:
        """Answer the page with the same score everywhere, and see what comes."""
        names = sorted(set(re.findall(r'type="radio" name="([\w-]+)"', page)))
        assert names
        form = (
            {n: "second" if n == "choice" else str(score) for n in names}
            | {"step": found(page, r'name="step" value="(\d+)"')}
            | changes
        )
        status, _, data = self.ask("POST", self.place, {k: v for k, v in form.items() if v})
        return status, data.decode() if status != 303 else self.page()


def found(page: str, pattern: str) -> str:
    match = re.search(pattern, page)
    assert match
    return match[1]


@pytest.mark.parametrize("count", [2, 3, 5, 6])
def test_each_method_stands_everywhere_and_after_every_other_one_equally_often(count: int) -> None:
    square = williams(count)
    times = len(square) // count
    assert len(square) == (count if count % 2 == 0 else 2 * count)
    assert set(Counter((place, m) for row in square for place, m in enumerate(row)).values()) == {times}
    after = Counter(pair for row in square for pair in pairwise(row))
    assert set(after.values()) == {times}
    assert len(after) == count * (count - 1)


def test_the_papers_twenty_six_raters_see_every_task_and_place_equally_often() -> None:
    plans = [PAPER.steps(k) for k in range(26)]
    rated = [[s for s in plan if s.kind == "rate"] for plan in plans]
    assert all(len({s.task for s in steps}) == 8 for steps in rated)
    assert all(sorted(s.methods) == sorted(PAPER.methods) for steps in rated for s in steps)
    assert set(Counter(s.task for steps in rated for s in steps).values()) == {16}
    places = Counter((place, m) for steps in rated for s in steps for place, m in enumerate(s.methods))
    assert max(places.values()) - min(places.values()) <= 1
    pairs = Counter(frozenset(s.methods) for plan in plans for s in plan if s.kind == "pair")
    assert len(pairs) == 15
    assert max(pairs.values()) - min(pairs.values()) <= 1
    assert len({tuple(s.task for s in steps) for steps in rated}) == 26


def test_sides_of_a_pair_are_exchanged_when_it_comes_again() -> None:
    study = Study(tuple("abc"), ("t",), pairs_each=3)
    sides = Counter(s.methods for k in range(4) for s in study.steps(k) if s.kind == "pair")
    assert {sides[a, b] for a in "abc" for b in "abc" if a != b} == {2}


def test_the_plan_follows_from_its_seed() -> None:
    again = Study(PAPER.methods, PAPER.tasks)
    other = Study(PAPER.methods, PAPER.tasks, seed=2)
    assert [PAPER.steps(k) for k in range(3)] == [again.steps(k) for k in range(3)]
    assert PAPER.steps(0) != other.steps(0)


def test_a_rater_goes_through_all_pages_and_no_page_name_or_request_tells_a_method(films: StudyFilms, tmp_path: Path) -> None:
    place = tmp_path / "answers.jsonl"
    with served(films, place) as rater:
        page = rater.begin()
        assert "Page 1 of 3" in page
        for k in range(3):
            tokens = re.findall(r'src="/film/(\w+)"', page)
            assert len(tokens) == (2 if k == 2 else 3)
            bodies = [rater.ask("GET", f"/film/{t}") for t in tokens]
            assert {(status, told["Content-Type"]) for status, told, _ in bodies} == {(200, "video/webm")}
            assert len({body for _, _, body in bodies}) == len(tokens)
            _, page = rater.send(page)
        assert "All your answers are kept" in page
    lines = read_lines(place)
    assert [line["kind"] for line in lines] == ["study", "rater", "rate", "rate", "pair"]
    step = Study(films.methods, tuple(films.tasks), 2, 1).steps(0)[0]
    assert (lines[2]["task"], tuple(lines[2]["methods"])) == (step.task, step.methods)
    assert lines[2]["scores"] == [dict.fromkeys(CRITERIA, 4)] * 3
    assert lines[4]["choice"] == "second"
    assert not [word for word in (*METHODS, ".webm", "volcano.", "films/") if word in rater.seen]
    assert "A pane breaks &amp; water runs out." in rater.seen
    assert set(lines[2]) == {"kind", "rater", "step", "task", "methods", "scores"}, "no name, address or time"


def test_the_film_behind_a_name_is_that_of_the_method_whose_answer_is_kept(films: StudyFilms, tmp_path: Path) -> None:
    place = tmp_path / "answers.jsonl"
    with served(films, place) as rater:
        page = rater.begin()
        bodies = [rater.ask("GET", f"/film/{t}")[2] for t in re.findall(r'src="/film/(\w+)"', page)]
        rater.send(page, changes={"physical-1": "1"})
    line = read_lines(place)[2]
    assert bodies == [films.paths[m, line["task"]].read_bytes() for m in line["methods"]]
    assert [s["physical"] for s in line["scores"]] == [4, 1, 4]


def test_what_is_missing_is_asked_for_and_what_was_chosen_stays(films: StudyFilms, tmp_path: Path) -> None:
    with served(films, tmp_path / "answers.jsonl") as rater:
        page = rater.begin()
        status, again = rater.send(page, 2, changes={"content-0": "", "shots-2": "9"})
        assert status == 422
        assert "2 of 12 ratings are missing" in again
        assert len(re.findall(r'value="2" required checked', again)) == 10
        status, _, data = rater.ask("POST", "/", {})
        assert (status, b"Tick the box" in data) == (422, True)
    assert [line["kind"] for line in read_lines(tmp_path / "answers.jsonl")] == ["study", "rater"]


def test_answers_survive_a_restart_and_an_answer_sent_twice_counts_once(films: StudyFilms, tmp_path: Path) -> None:
    place = tmp_path / "answers.jsonl"
    with served(films, place) as rater:
        first = rater.begin()
        rater.send(first, 5)
        rater.send(first, 1)
    with place.open("ab") as stream:
        stream.write(b'{"kind": "rate", "ra')  # a crash in the middle of a line
    with served(films, place) as later:
        later.place = rater.place
        page = later.page()
        assert "Page 2 of 3" in page
        later.send(page, 3)
        other = Rater(later.port)
        other.begin()
    lines = read_lines(place)
    assert [(x["kind"], x.get("step"), x.get("number")) for x in lines[1:]] == [
        ("rater", None, 0), ("rate", 0, None), ("rate", 1, None), ("rater", None, 1),
    ]  # fmt: skip
    assert [s["physical"] for x in lines if x["kind"] == "rate" for s in x["scores"]] == [5, 5, 5, 3, 3, 3]


def test_answers_to_another_study_are_refused_with_what_differs(films: StudyFilms, tmp_path: Path) -> None:
    place = tmp_path / "answers.jsonl"
    study = Study(films.methods, tuple(films.tasks))
    AnswerFile(place, study, films.digest)
    with pytest.raises(InputError, match="another study: films_sha256, seed differ"):
        AnswerFile(place, Study(films.methods, tuple(films.tasks), seed=2), "other")
    place.write_text("nonsense\n")
    with pytest.raises(InputError, match="line 1"):
        AnswerFile(place, study, films.digest)


def test_strangers_get_nothing(films: StudyFilms, tmp_path: Path) -> None:
    with served(films, tmp_path / "answers.jsonl") as rater:
        token = found(rater.begin(), r'src="/film/(\w+)"')
        other = Rater(rater.port)
        assert other.ask("GET", f"/film/{token}")[0] == 404
        other.begin()
        assert other.ask("GET", f"/film/{token}")[0] == 404
        for path in ("/film/../answers.jsonl", "/answers.jsonl", "/r/nobody", "/films/a/b.webm"):
            assert rater.ask("GET", path)[0] == 404
        assert rater.ask("GET", "/", Host="evil.example")[0] == 403
        assert rater.ask("POST", "/", {"consent": "yes"}, Origin="http://evil.example")[0] == 403
        assert rater.ask("POST", rater.place, {"x": "y" * 30_000})[0] == 413


def test_a_player_gets_the_range_that_it_asks_for(films: StudyFilms, tmp_path: Path) -> None:
    with served(films, tmp_path / "answers.jsonl") as rater:
        path = "/film/" + found(rater.begin(), r'src="/film/(\w+)"')
        _, _, whole = rater.ask("GET", path)
        status, told, part = rater.ask("GET", path, Range="bytes=10-19")
        assert (status, told["Content-Range"], part) == (206, f"bytes 10-19/{len(whole)}", whole[10:20])
        assert rater.ask("GET", path, Range="bytes=-5")[2] == whole[-5:]
        assert rater.ask("GET", path, Range="bytes=100-")[2] == whole[100:]
        assert rater.ask("GET", path, Range=f"bytes={len(whole)}-")[0] == 416


def test_films_that_are_not_alike_or_not_complete_are_refused(films: StudyFilms, tmp_path: Path) -> None:
    folder = tmp_path / "films"
    with pytest.raises(InputError, match="tasks aquarium have no prompt"):
        read_films(folder, {"volcano": "x"})
    small_film(folder / "tool_calls" / "volcano.webm", size=(96, 128))
    with pytest.raises(InputError, match=r"share one format.*64 x 48 at 24 frames/s; .webm 128 x 96"):
        read_films(folder, PROMPTS)
    (folder / "tool_calls" / "volcano.webm").unlink()
    with pytest.raises(InputError, match="missing are tool_calls/volcano"):
        read_films(folder, PROMPTS)
    with pytest.raises(InputError, match="films of 0 methods"):
        read_films(tmp_path, PROMPTS)


def test_the_mean_is_that_of_participants_means() -> None:
    """Two raters: one rated a method 1 and 3, the other 5 alone. The mean is (2 + 5) / 2, not 3."""
    study = {"kind": "study", "version": 1, "films_sha256": "", **Study(("a", "b"), ("s", "t"), 2, 0).told()}

    def rated(rater: str, step: int, a: int) -> dict[str, Any]:
        scores = [dict.fromkeys(CRITERIA, 3), dict.fromkeys(CRITERIA, a)]
        return {"kind": "rate", "rater": rater, "step": step, "task": "t", "methods": ["b", "a"], "scores": scores}

    raters = [{"kind": "rater", "rater": r, "number": k} for k, r in enumerate("xy")]
    told = study_results([study, *raters, rated("x", 0, 1), rated("x", 1, 3), rated("y", 0, 5)])
    found = told["means"]["a"]["shots"]
    assert (found["mean"], found["raters"], found["ratings"]) == (3.5, 2, 3)
    assert found["interval"] == pytest.approx([3.5 - 12.7062 * 1.5, 3.5 + 12.7062 * 1.5], rel=1e-4)
    assert (told["raters"], told["raters_done"], told["strengths"]) == (2, 1, None)


def test_strengths_of_two_methods_are_the_log_odds() -> None:
    found = bradley_terry(np.array([[0.0, 7.0], [3.0, 0.0]]))
    assert found is not None
    assert found == pytest.approx([log(7 / 3) / 2, -log(7 / 3) / 2], abs=1e-8)


def test_strengths_of_expected_wins_are_those_that_made_them_and_a_sure_winner_has_none() -> None:
    true = np.array([0.8, 0.1, -0.3, -0.6])
    chance = 1.0 / (1.0 + np.exp(true[None, :] - true[:, None]))
    np.fill_diagonal(chance, 0.0)
    found = bradley_terry(50.0 * chance)
    assert found is not None
    assert found == pytest.approx(true, abs=1e-7)
    chance[:, 0], chance[0, 1:] = 0.0, 1.0
    assert bradley_terry(chance) is None


def test_intervals_of_strengths_go_over_raters() -> None:
    """Forty raters of whom thirty prefer a: the log odds are ln 3, their standard error is sqrt(1/30 + 1/10) = 0.365."""
    told = [Comparison(f"r{k}", "a", "b", "first" if k < 30 else "second") for k in range(40)]
    found = strengths(("a", "b"), told)
    assert found is not None
    assert found["a"].value - found["b"].value == pytest.approx(log(3))
    assert found["a"].low is not None
    assert found["a"].high is not None
    assert 2 * (found["a"].high - found["a"].low) == pytest.approx(2 * 1.96 * 0.365, rel=0.25)
    assert found["b"].low == pytest.approx(-found["a"].high)
    copied = strengths(("a", "b"), [Comparison(f"r{k % 2}", "a", "b", c.choice) for k, c in enumerate(told)])
    assert copied is not None
    assert copied["a"].high is not None
    assert copied["a"].high - copied["a"].value < 0.5 * (found["a"].high - found["a"].value), "two raters who agree are no forty"
    few = strengths(("a", "b"), [Comparison("x", "a", "b", "first"), Comparison("y", "a", "b", "second")])
    assert few is not None
    assert few["a"].low is None, "half of the resamples have one answer alone"
    ties = strengths(("a", "b"), [Comparison("x", "a", "b", "equal")])
    assert ties is not None
    assert ties["a"].value == pytest.approx(0.0)


def test_the_command_tells_results_and_refuses_what_does_not_fit(
    films: StudyFilms, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = str(tmp_path / "films")
    assert command_line(["eval", "study", folder, "--results"]) == 2
    assert "no answers in" in capsys.readouterr().err
    place = tmp_path / "films.answers.jsonl"
    with served(films, place) as rater:
        rater.send(rater.begin())
    assert command_line(["eval", "study", folder, "--results"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["means"]["verified_worlds"]["aesthetics"]["mean"] == 4.0
    assert (told["raters"], told["raters_done"]) == (1, 0)
    assert command_line(["eval", "study", folder, "--answers", str(tmp_path / "films" / "a.jsonl")]) == 2
    assert "must lie outside the folder of films" in capsys.readouterr().err
