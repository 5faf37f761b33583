"""The judge's plumbing against a fake provider behind Inspect's model layer (R145-R147, R150, R151, S16)."""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import Any

import anyio
import cv2
import numpy as np
import pytest
from worldagent.bench.evaluation.metrics.film import Film
from worldagent.bench.evaluation.metrics.forecast import forecast
from worldagent.bench.evaluation.metrics.formulas import (
    causal_score,
    composition_score,
    macro_average,
    production_score,
    shots_score,
)
from worldagent.bench.evaluation.metrics.judge import InspectJudge
from worldagent.bench.evaluation.metrics.judged import Judged, judge_film
from worldagent.bench.evaluation.metrics.questions import JUDGED, questions_of
from worldagent.bench.evaluation.prompts.reading import load_prompts
from worldagent.tests.bench.evaluation.fake_judge import answering, perfect
from worldagent.tests.bench.evaluation.films import film_file

pytestmark = pytest.mark.filterwarnings(
    "ignore:The 'initial' parameter is deprecated:DeprecationWarning"
)  # Inspect's use of tenacity
PROMPT = load_prompts("agenticsimbench")["volcano"]
SMALL = load_prompts("small")["crate_slides"]
VALUES = {"caus": 0.7 + 0.3 * 0.5, "qual": 12 / 15, "comp": 1.0, "prod": 16 / 20}
"""Scores of the perfect judge's answers, by the paper's formulas."""


@pytest.fixture(scope="module")
def film(tmp_path_factory: pytest.TempPathFactory) -> Film:
    return Film(film_file(tmp_path_factory.mktemp("worldagent") / "worldagent_final.avi", 100))


def judged(film: Film, metric: str, model: Any, **more: Any) -> Judged:
    async def run() -> Judged:
        return await judge_film(InspectJudge(model), film, more.pop("prompt", PROMPT), metric, **more)

    return anyio.run(run)


@pytest.mark.parametrize("metric", JUDGED)
def test_a_metric_joins_its_answers_by_the_papers_formula(film: Film, metric: str) -> None:
    model, provider = answering()
    found = judged(film, metric, model)
    assert found.value == pytest.approx(VALUES[metric])
    assert found.reason == ""
    assert len(provider.asked) == sum(a.tries for a in found.answers)
    told = found.as_json()
    assert (told["calls"], told["input_tokens"], told["output_tokens"]) == (
        len(provider.asked),
        100 * len(provider.asked),
        7 * len(provider.asked),
    )
    assert told["judge"]["model"] == "fakejudge/x"
    assert told["judge"]["backend"].startswith("inspect_ai 0.")
    assert len(told["rubric"]["sha256"]) == len(told["questions_sha256"]) == 64
    json.dumps(told)


@pytest.mark.parametrize("metric", JUDGED)
def test_frames_come_in_order_as_pictures_without_names(film: Film, metric: str) -> None:
    """R151: nothing tells who made the film; brightness grows with time."""
    model, provider = answering()
    judged(film, metric, model)
    by_text = {q.text: q for q in questions_of(metric, PROMPT, film.count, film.fps)}
    assert {text for text, _ in provider.asked} <= set(by_text)
    assert len(provider.asked) >= 2
    for text, images in provider.asked:
        raw = [base64.b64decode(i.removeprefix("data:image/jpeg;base64,")) for i in images]
        assert len(raw) == len(by_text[text].window.frames)
        shades = [float(np.mean(np.asarray(cv2.imdecode(np.frombuffer(r, np.uint8), cv2.IMREAD_COLOR))[..., 0])) for r in raw]
        assert shades == pytest.approx([10 + 200 * k // 99 for k in by_text[text].window.frames], abs=6)
        assert not any(word in r.lower() for r in raw for word in (b"worldagent", b"exif", b"final"))
        assert not any(word in text.lower() for word in ("worldagent", "blender", ".avi", "final"))


@pytest.mark.parametrize("metric", JUDGED)
def test_the_forecast_bounds_what_is_then_asked(film: Film, metric: str) -> None:
    told = forecast(PROMPT, film.count, film.fps, film.size, metrics=(metric,), prices=(2.0, 10.0))
    model, provider = answering(lambda text, _: perfect(text) if metric != "comp" else "no")
    judged(film, metric, model)
    assert (told.calls, told.pictures) == (len(provider.asked), sum(len(images) for _, images in provider.asked))
    assert told.cost_usd == pytest.approx((told.input_tokens * 2.0 + told.output_tokens * 10.0) / 1e6)
    assert f"{told.calls} calls" in told.words()
    assert forecast(PROMPT, film.count, film.fps, film.size, metrics=(metric,)).cost_usd is None


def test_forecasts_of_films_add_up() -> None:
    one = forecast(PROMPT, 240, 24.0, (1080, 1920), prices=(3.0, 15.0))
    assert (one + one).calls == 2 * one.calls
    assert one.calls == 9 + 8 + 8 * len(PROMPT.composition) + 4
    assert one.cost_usd is not None
    assert one.cost_usd > 0


def test_presence_stops_at_the_first_yes_and_no_needs_every_window(film: Film) -> None:
    model, provider = answering(lambda text, n: "yes" if "crater" in text else "no")
    found = judged(film, "comp", model)
    asked = [text for text, _ in provider.asked]
    assert sum("round crater" in text for text in asked) == 1
    assert sum("Is there a stone hut" in text for text in asked) == 8
    assert found.value == pytest.approx(1 / 12)


def test_a_nonsense_answer_is_asked_again_and_then_counts(film: Film) -> None:
    model, provider = answering(lambda text, n: "Nice film!" if n < 3 else perfect(text))
    found = judged(film, "qual", model)
    assert found.value == pytest.approx(VALUES["qual"])
    assert len(provider.asked) == 24
    assert all(a.reasons == ("no scores: 'Nice film!'",) * 2 for a in found.answers)


@pytest.mark.parametrize("metric", JUDGED)
@pytest.mark.parametrize(
    ("reply", "reason"),
    [("I would say eleven of ten.", "no scores"), (RuntimeError("boom"), "RuntimeError: boom"), ("hang", "no answer in 0.05 s")],
)
def test_a_judge_that_gives_no_scores_leaves_the_film_without_a_value(film: Film, metric: str, reply: Any, reason: str) -> None:
    model, provider = answering(lambda text, _: reply)
    found = judged(film, metric, model, tries=2, seconds=0.05 if reply == "hang" else 30.0)
    assert found.value is None
    assert reason in found.reason
    assert max(provider.times.values()) == 2


@pytest.mark.parametrize("metric", JUDGED)
def test_one_missing_answer_leaves_no_value_and_nothing_more_is_asked(film: Film, metric: str) -> None:
    lost = questions_of(metric, PROMPT, film.count, film.fps)[1].text
    model, provider = answering(lambda text, _: "?" if text == lost else "no" if metric == "comp" else perfect(text))
    found = judged(film, metric, model)
    assert found.value is None
    assert "has no scores after 3 tries" in found.reason
    assert provider.times[lost] == 3
    assert len(provider.times) <= 9 * 8  # of 96 of Comp: eight are open at once, each with all its windows


def test_a_yes_elsewhere_outweighs_a_window_without_an_answer(film: Film) -> None:
    model, _ = answering(lambda text, _: "?" if text.startswith("The video") and "at 0.00," in text else "yes")
    assert judged(film, "comp", model, tries=1).value == 1.0


def test_caus_needs_five_beats_and_a_film_eight_frames(film: Film, tmp_path: Path) -> None:
    model, provider = answering()
    assert "has 2" in judged(film, "caus", model, prompt=SMALL).reason
    short = Film(film_file(tmp_path / "short.avi", 5))
    found = judged(short, "qual", model)
    assert (found.value, found.answers) == (None, ())
    assert "at least 8" in found.reason
    assert provider.asked == []


def test_the_identity_of_a_judge_has_its_type_of_numbers_and_no_secret() -> None:
    model, _ = answering(torch_dtype="bfloat16", my_token="s3cret")
    who = InspectJudge(model).identity
    assert (who.model, who.dtype) == ("fakejudge/x", "bfloat16")
    assert "s3cret" not in json.dumps(who.arguments)


def test_formulas_on_paper_cases() -> None:
    assert causal_score([1, 1, 0.5, 0, 1], [1, 0.5, 0, 0.5]) == pytest.approx(0.7 * 0.7 + 0.3 * 0.5)
    assert shots_score([(5, 5, 5)] * 4 + [(1, 2, 3)] * 4) == pytest.approx(0.5 * (1 + 0.4))
    assert composition_score([True, True, False, True]) == 0.75
    assert production_score([(64, [5, 5, 5, 5]), (16, [1, 1, 1, 1])]) == pytest.approx((64 * 1.0 + 16 * 0.2) / 80)
    assert macro_average({"a": 0.25, "b": 0.75}) == 0.5
    assert macro_average({"a": 0.25, "b": None}) is None
    assert macro_average({}) is None
    with pytest.raises(ValueError, match="four links"):
        causal_score([1] * 5, [1] * 5)
