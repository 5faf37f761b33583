"""The metrics as scorers of Inspect, over samples that an evaluation left: real logs, no key, no model service."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest
from inspect_ai import Task
from inspect_ai import eval as run_eval
from inspect_ai import score as score_log
from inspect_ai._util.registry import registry_info
from inspect_ai.dataset import MemoryDataset, Sample
from inspect_ai.model import get_model
from inspect_ai.scorer import Score
from inspect_ai.solver import Generate, Solver, TaskState, solver
from worldagent.bench.evaluation.metrics import scorers
from worldagent.bench.evaluation.metrics.sample import sample_output
from worldagent.bench.evaluation.prompts.reading import BenchPrompt, load_prompts
from worldagent.bench.evaluation.registry import SCORERS
from worldagent.tests.bench.evaluation.fake_judge import answering, perfect
from worldagent.tests.bench.evaluation.films import film_file
from worldagent.tests.bench.evaluation.folders import baked_folder
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.worlds.errors import EvidenceError

pytestmark = [
    pytest.mark.filterwarnings("ignore:The 'initial' parameter is deprecated:DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::ResourceWarning"),  # Inspect leaves its loop's sockets to the collector
]
VOLCANO = load_prompts("agenticsimbench")["volcano"]
BLOCKS = BenchPrompt.model_validate({**VOLCANO.model_dump(mode="json"), "id": "blocks", "text": PROMPT})


@solver
def idle() -> Solver:
    async def solve(state: TaskState, generate: Generate) -> TaskState:
        return state

    return solve


def run(
    tmp_path: Path, metadata: dict[str, Any], *chosen: Any, grader: Any = None, agent: Any = None
) -> tuple[dict[str, Score], Any]:
    """Scores of one sample by scorer, and the log."""
    task = Task(MemoryDataset([Sample(input="x", metadata=metadata)]), solver=idle(), scorer=list(chosen))
    roles = {"grader": grader} if grader is not None else {}
    (log,) = run_eval(
        task, model=agent or get_model("mockllm/model"), model_roles=roles, log_dir=str(tmp_path / "logs"), display="none"
    )
    assert log.status == "success", log.error
    (sample,) = log.samples or []
    return dict(sample.scores or {}), log


def told(score: Score) -> dict[str, Any]:
    assert score.metadata is not None
    return score.metadata


def scene(prompt: BenchPrompt = VOLCANO, **more: Any) -> dict[str, Any]:
    return {"scene": prompt.model_dump(mode="json"), **more}


def test_a_judge_scores_the_film_of_a_sample_and_the_log_says_who_and_how(tmp_path: Path) -> None:
    film = film_file(tmp_path / "film.avi", 40)
    model, provider = answering()
    found, log = run(
        tmp_path, scene(film=str(film)), scorers.caus(), scorers.qual(prices="3/15"), scorers.comp(), scorers.prod(), grader=model
    )
    assert {name: score.value for name, score in found.items()} == pytest.approx(
        {"caus": 0.85, "qual": 0.8, "comp": 1.0, "prod": 0.8}
    )
    assert told(found["caus"])["judge"]["model"] == "fakejudge/x"
    assert told(found["qual"])["forecast"].startswith("8 calls with 40 pictures")
    assert "USD" in told(found["qual"])["forecast"]
    assert told(found["comp"])["calls"] == len(VOLCANO.composition)
    assert len(provider.asked) == sum(told(score)["calls"] for score in found.values())
    assert {s.name: s.metrics["mean"].value for s in log.results.scores} == pytest.approx(
        {n: float(v.value) for n, v in found.items()}  # type: ignore[arg-type]
    )


def test_what_cannot_be_scored_is_unscored_with_its_reason(tmp_path: Path) -> None:
    film = film_file(tmp_path / "film.avi", 40)
    model, _ = answering(lambda text, _: "?" if '"link"' in text else perfect(text))
    found, log = run(
        tmp_path,
        scene(film=str(film), workspace=str(tmp_path)),
        scorers.pen(),
        scorers.caus(tries=1),
        scorers.qual(most_calls=7),
        grader=model,
    )
    assert all(math.isnan(float(score.value)) for score in found.values())  # type: ignore[arg-type]
    assert found["pen"].explanation == "the sample left no world of its prompt"
    assert "causal_link" in str(found["caus"].explanation)
    assert "7 calls are allowed" in str(found["qual"].explanation)
    assert all(s.unscored_samples == 1 for s in log.results.scores)


def test_without_a_judge_or_a_film_nothing_is_scored(tmp_path: Path) -> None:
    film = film_file(tmp_path / "film.avi", 40)
    found, _ = run(tmp_path, scene(film=str(film)), scorers.prod())
    assert "--model-role grader" in str(found["prod"].explanation)
    found, _ = run(tmp_path, scene(workspace=str(tmp_path)), scorers.imag(), scorers.alignment(), scorers.comp())
    assert set(found) == {"imag", "align", "comp"}
    assert all(score.explanation == "the sample left no film" for score in found.values())


def test_pen_scores_the_baked_world_of_a_samples_workspace(tmp_path: Path) -> None:
    baked_folder(tmp_path / "work" / "blocks", {**small_spec(), "prompt": PROMPT})
    found, _ = run(tmp_path, scene(BLOCKS, attempt={"workspace": str(tmp_path / "work")}), scorers.pen())
    assert found["pen"].value == 0.0
    assert len(told(found["pen"])["frames"]) == 24
    json.dumps(told(found["pen"]))


def test_a_world_of_another_prompt_is_none_of_the_samples(tmp_path: Path) -> None:
    for name, prompt in (("mine", PROMPT), ("other", PROMPT + " And more.")):
        (tmp_path / name).mkdir()
        (tmp_path / name / "world.json").write_text(json.dumps({"prompt": prompt}))
    (tmp_path / "broken").mkdir()
    (tmp_path / "broken" / "world.json").write_text("[")
    assert sample_output(scene(BLOCKS, workspace=str(tmp_path))).world == tmp_path / "mine"
    assert sample_output(scene(workspace=str(tmp_path))).world is None
    with pytest.raises(EvidenceError, match="no prompt of the benchmark"):
        sample_output({"scene": {"text": PROMPT}})


def test_of_several_worlds_the_one_with_the_newest_film_is_scored(tmp_path: Path) -> None:
    for name in ("first", "second", "third"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "world.json").write_text(json.dumps({"prompt": PROMPT}))
    final = tmp_path / "second" / "candidates" / "a" / "final"
    final.mkdir(parents=True)
    film_file(final / "final.avi", 9)
    found = sample_output(scene(BLOCKS, workspace=str(tmp_path)))
    assert found.world == tmp_path / "second"
    assert found.need_film().count == 9


def test_a_finished_log_is_scored_by_name_as_the_command_does(tmp_path: Path) -> None:
    """`inspect score LOG --scorer worldagent/NAME`: what it looks up is what the registry imports."""
    film = film_file(tmp_path / "film.avi", 40)
    _, log = run(tmp_path, scene(film=str(film)), scorers.pen())
    model, _ = answering()
    scored = score_log(log, SCORERS["qual"](), action="append", model_roles={"grader": model}, display="none")
    (sample,) = scored.samples or []
    assert sorted(sample.scores or {}) == ["pen", "qual"]
    assert (sample.scores or {})["qual"].value == pytest.approx(0.8)
    names = {registry_info(SCORERS[name]()).name.rpartition("/")[2] for name in scorers.METRIC_SCORERS}
    assert names == set(scorers.METRIC_SCORERS) == {"pen", "caus", "qual", "comp", "align", "imag", "prod"}
