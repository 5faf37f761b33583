"""A world whose physics does not do what the prompt asks, and every way in which its specification may be made easier.

The ball is too slow: the last block never falls. Each attempt is a fresh world that would be accepted if the server asked for
no more than the specification does (R154-R157).
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from worldagent.tests.stories.inline_jobs import run_jobs_inline
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.claim_marks import claim_operations
from worldagent.worlds.claims import prompt_record
from worldagent.worlds.patch import apply_patch, parse_spec
from worldagent.worlds.spec import Supports, WorldSpec

Spec = dict[str, Any]
FALL = ("story", "beats", "fall")


def _slow() -> Spec:
    spec = small_spec()
    spec["entities"]["ball"]["physics"] |= {"linear_velocity": [0.4, 0, 0], "angular_velocity": [0, 20, 0]}
    return spec


def _beat(spec: Spec, **change: Any) -> None:
    spec["story"]["beats"]["fall"] |= change


def _without_the_beat(spec: Spec) -> None:
    del spec["story"]["beats"]["fall"]
    spec["shots"]["only"]["covers"] = ["roll", "strike"]
    spec["claims"]["falls_off"]["by"] = ["/entities/b3"]


def _another_beat_in_its_place(spec: Spec) -> None:
    """The words are judged by a beat that happens anyhow, but says nothing of the block."""
    _without_the_beat(spec)
    spec["claims"]["falls_off"]["by"] = ["/story/beats/strike"]


def _optional(spec: Spec) -> None:
    _beat(spec, mandatory=False)


def _unseen(spec: Spec) -> None:
    _beat(spec, observe=False, predicate={"kind": "contact", "a": "ball", "b": "b3"})


def _noise(spec: Spec) -> None:
    _beat(spec, predicate={"kind": "displacement", "entity": "b3", "axis": [0, 0, 1], "max": -1e-6})


def _already_true(spec: Spec) -> None:
    _beat(spec, predicate={"kind": "displacement", "entity": "b3", "axis": [0, 0, 1], "max": 0.1})


def _already_true_in_an_or(spec: Spec) -> None:
    easy = {"kind": "displacement", "entity": "b3", "max": 1.0}
    _beat(spec, predicate={"kind": "or", "of": [spec["story"]["beats"]["fall"]["predicate"], easy]})


def _lasting(spec: Spec) -> None:
    _beat(spec, predicate={"kind": "supported", "entity": "b3"}, causes=[])


def _kinematic(spec: Spec) -> None:
    """The block itself follows a path off the shelf."""
    x, y, z = spec["entities"]["b3"]["pose"]["position"]
    spec["entities"]["b3"]["motion"] = "kinematic"
    spec["simulation"]["drivers"] = {
        "path": {"kind": "path", "entity": "b3", "keys": {
            "a": {"time": 0.2, "pose": {"position": [x, y, z]}},
            "b": {"time": 0.4, "pose": {"position": [x + 0.06, y, z]}},
            "c": {"time": 0.7, "pose": {"position": [x + 0.06, y, 0.1]}}}}
    }  # fmt: skip


def _kinematic_as_a_trigger(spec: Spec) -> None:
    _kinematic(spec)
    _beat(spec, owner="path", causes=[])


def _kinematic_as_a_trigger_of_something(spec: Spec) -> None:
    """The staged fall is called the cause of a further beat, which is staged with it."""
    _kinematic_as_a_trigger(spec)
    spec["story"]["beats"]["land"] = {
        "text": "it is down", "owner": "rigid", "subject": "b3", "frames": [8, 30], "causes": ["fall"],
        "predicate": {"kind": "displacement", "entity": "b3", "axis": [0, 0, 1], "max": -0.15}}  # fmt: skip
    spec["shots"]["only"]["covers"].append("land")


def _pushed_by_hand(spec: Spec) -> None:
    """A force on the block itself, while the specification says that the blow does it."""
    spec["simulation"]["drivers"] = {"hand": {"kind": "force", "entity": "b3", "force": [1.5, 0, 0], "start": 0.2, "end": 0.4}}


def _overlap_declared(spec: Spec) -> None:
    """The blocks stand inside each other, so that the engine throws them apart; all overlaps are called intended."""
    for k, name in enumerate(("b1", "b2", "b3")):
        spec["entities"][name]["pose"]["position"][0] = 0.19 + 0.004 * k
    for a, b in (("b1", "b2"), ("b2", "b3"), ("b1", "b3")):
        spec["graph"]["relations"][f"glue_{a}_{b}"] = {"kind": "fastened", "a": a, "b": b, "max_depth": 0.03, "reason": "they are meant to be so"}  # fmt: skip


def _through_the_shelf(spec: Spec) -> None:
    """The block falls through a shelf that does not collide with it."""
    spec["entities"]["shelf"]["parts"]["body"]["collides"] = False


def _unsupported(spec: Spec) -> None:
    """The block starts in the air beside the shelf, without a word about support."""
    spec["entities"]["b3"]["pose"]["position"][0] = 0.26
    del spec["graph"]["relations"]["on_shelf_b3"]


def _short_interval(spec: Spec) -> None:
    _beat(spec, frames=[30, 30], predicate={"kind": "speed", "entity": "b3", "max": 0.5})


def _given_up(spec: Spec) -> None:
    _without_the_beat(spec)
    kept = ("quote", "nth", "type")
    spec["claims"] = {
        name: {**{k: claim[k] for k in kept}, "waived": "not in this version of the world"}
        for name, claim in spec["claims"].items()
    }


def _impossible_density(spec: Spec) -> None:
    """A ball of steel as heavy as nothing is."""
    spec["materials"]["steel"]["density"] = 60000.0


ATTEMPTS: tuple[Callable[[Spec], None], ...] = (
    _without_the_beat, _another_beat_in_its_place, _optional, _unseen, _noise, _already_true, _already_true_in_an_or, _lasting, _kinematic, _kinematic_as_a_trigger,
    _kinematic_as_a_trigger_of_something, _pushed_by_hand, _overlap_declared, _through_the_shelf, _unsupported, _short_interval, _given_up,
    _impossible_density,
)  # fmt: skip


@pytest.fixture(scope="module")
def agents(tmp_path_factory: pytest.TempPathFactory, agent_of: Callable[[Path], Any]) -> Iterator[Any]:
    with pytest.MonkeyPatch.context() as patch, agent_of(tmp_path_factory.mktemp("weakened")) as made:
        run_jobs_inline(patch)
        yield made


def _as_far_as_it_goes(agent: Any, world: str, spec: Spec, prompt: str = PROMPT, **more: Any) -> tuple[str, dict[str, Any]]:
    """Every step in order, whatever the one before said; the text of refusals and the last verdict."""
    said = []
    for tool, arguments in (
        ("edit_spec", {"prompt": prompt, "spec": spec, **more}),
        ("place_object", {}),
        ("probe_sim", {}),
        ("bake_sim", {}),
        ("run_checks", {"scope": "acceptance"}),
        ("render_shot", {"kind": "final", "width": 64, "height": 64, "samples": 1}),
    ):
        answer = agent.result(tool, world=world, **arguments)
        assert not answer.content[0].text.startswith("internal error"), answer.content[0].text
        said.append(answer.content[0].text)
    return "\n".join(said), agent.call("inspect_world", world=world)


@pytest.mark.slow
def test_the_sound_world_is_accepted(agents: Any) -> None:
    """Otherwise nothing below would prove anything."""
    assert _as_far_as_it_goes(agents, "sound", small_spec())[1]["last_verdict"]["verdict"] == "accepted"


def test_the_slow_ball_is_not_enough(agents: Any) -> None:
    text, overview = _as_far_as_it_goes(agents, "slow", _slow())
    assert "beat:fall" in text
    assert overview.get("last_verdict") is None


@pytest.mark.parametrize("attempt", ATTEMPTS, ids=lambda a: a.__name__.strip("_"))
def test_no_easier_specification_is_accepted(agents: Any, attempt: Callable[[Spec], None]) -> None:
    spec = _slow()
    attempt(spec)
    world = attempt.__name__.strip("_")
    text, overview = _as_far_as_it_goes(agents, world, spec)
    verdict = (overview.get("last_verdict") or {}).get("verdict")
    assert verdict != "accepted", text
    assert not list((agents.workspace / world).glob("candidates/*/final"))
    assert "fail" in text or "not validate" in text or "unverified" in text


ATTEMPTED = Path(__file__).parent / "attempts"
"""Worlds of docs/trials/adversary."""


@pytest.mark.parametrize("path", sorted(ATTEMPTED.glob("*.json")), ids=lambda p: p.stem)
def test_what_an_adversary_once_got_accepted_is_accepted_no_more(agents: Any, path: Path) -> None:
    attempt = json.loads(path.read_text())
    text, overview = _as_far_as_it_goes(agents, path.stem, **attempt)
    assert (overview.get("last_verdict") or {}).get("verdict") != "accepted", text
    assert '"status": "fail"' in text or '"status":"fail"' in text or "refused" in text


REASONS = {
    "bottles_by_drivers": "'knocks over' is told of 'b1', which stands behind it: ball does it, but beat 'fall1' names no causes",
    "bottles_thrown": "'knocks over' is told of 'b1', which stands behind it: ball does it, but beat 'fall1' names no causes",
    "one_bottle": "'five' counts 5, by names 1",
    "no_bottle_falls": "nothing that is claimed says what becomes of 'five' (b1, b2, b3)",
    "hidden_torques": "a causal margin of 1e-09 rad is within noise",
    "crates_held_in_the_air": "lets go of 'c1' at 100 s, after the last frame",
    "crates_in_each_other": "an intended overlap of",
}


@pytest.mark.parametrize("name", REASONS)
def test_the_audit_says_why_it_refuses_what_an_adversary_once_got_accepted(name: str) -> None:
    told = [p for row in audit(_attempted(name)).rows if row.status == "fail" for p in row.evidence["problems"]]
    assert any(REASONS[name] in p for p in told), told


def test_what_only_a_reader_can_tell_stands_with_the_verdict() -> None:
    """Known gap: no rule tells that "knocks over" is no touch of the floor; who claims anything of a bottle besides passes the audit."""
    spec = _attempted("no_bottle_falls", ("a row of", "a [row](property b1) of"))
    assert audit(spec).passed
    told = "'bottles' can move, and nothing that is claimed to happen is about b1, b2, b3"
    assert told in prompt_record(spec)["warnings"]
    assert not any("can move" in w for w in prompt_record(parse_spec({**small_spec(), "prompt": PROMPT}))["warnings"])


def test_what_a_claim_of_place_says_of_some_frames_is_about_its_bodies() -> None:
    """Something bears the bottles later on, by a claimed relation: the warning goes; it stays where the relation says nothing of when."""
    told = "'bottles' can move, and nothing that is claimed to happen is about b1, b2, b3"
    spec = _attempted("no_bottle_falls", ("a row of", "a [row](property b1) of"))
    for frames, warned in ((None, True), ((1, 2), False)):
        relation = Supports(a=next(n for n, e in spec.entities.items() if e.motion == "static"), b="b1", frames=frames)
        graph = spec.graph.model_copy(update={"relations": {**spec.graph.relations, "later": relation}})
        claims = {
            n: c.model_copy(update={"by": [*c.by, "/graph/relations/later"]}) if c.type == "property" else c
            for n, c in spec.claims.items()
        }
        held = spec.model_copy(update={"graph": graph, "claims": claims})
        assert (told in prompt_record(held)["warnings"]) is warned


def _attempted(name: str, *changes: tuple[str, str]) -> WorldSpec:
    attempt = json.loads((ATTEMPTED / f"{name}.json").read_text())
    spec = parse_spec({**attempt["spec"], "prompt": attempt["prompt"]})
    marked = attempt["claims"]
    for old, new in changes:
        assert old in marked
        marked = marked.replace(old, new)
    return apply_patch(spec, claim_operations(marked, spec))
