"""Warnings of the audit where no field is wrong: drivers that no beat owns, subjects too fast for any camera (R24, R97)."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.tests.stories.yard import MARKED as YARD
from worldagent.tests.stories.yard import PROMPT as YARD_PROMPT
from worldagent.tests.stories.yard import yard_spec
from worldagent.verifiers.shots.bounds import SCREEN_STEP as JUDGED
from worldagent.worlds.audits.audit import MOST_WARNINGS, audit
from worldagent.worlds.audits.foreseen import SCREEN_STEP
from worldagent.worlds.audits.story import story_problems
from worldagent.worlds.claim_marks import claim_operations
from worldagent.worlds.drivers import deed, in_secret
from worldagent.worlds.patch import apply_patch, parse_spec
from worldagent.worlds.spec import WorldSpec


def changed(*operations: tuple[str, Any], **members: Any) -> WorldSpec:
    base = parse_spec({**small_spec(**members), "prompt": PROMPT})
    return apply_patch(base, [{"op": "add", "path": p, "value": v} for p, v in operations])


PUSH = {"kind": "force", "entity": "b1", "force": [1, 0, 0], "start": 0.5, "end": 1.0}
AIR = {"kind": "field", "field": {"kind": "drag"}}
FAST = ("/entities/ball/physics/linear_velocity", [60, 0, 0])
FOLLOWED = ("/shots/only/follow", "ball")


def test_the_small_world_has_no_warning() -> None:
    assert audit(changed()).warnings == ()
    assert audit(changed()).told == ()


def test_a_driver_that_no_beat_owns_is_told_with_what_it_acts_on() -> None:
    report = audit(changed(("/simulation/drivers/push", PUSH), claims={}))
    (told,) = report.warnings
    assert told.startswith(
        "/simulation/drivers/push: 0 beats are owned by force 'push', which acts on b1 from 0.5 s on; 1 is wanted"
    )
    assert "audit:story" not in told
    assert told in report.told


@pytest.mark.parametrize(
    "driver",
    [PUSH, {"kind": "release", "entity": "b1", "time": 0.5}, {"kind": "motor", "joint": "bar", "velocity": 1.0, "max_effort": 1.0, "end": 1.0}, {"kind": "detach", "joint": "bar", "time": 0.5}],
    ids=lambda d: d["kind"],
)  # fmt: skip
def test_a_driver_that_acts_in_secret_on_what_the_prompt_names_is_refused(driver: dict[str, Any]) -> None:
    bar = {"kind": "weld", "parent": "shelf", "child": "b1", "anchor": [0, 0, 0.1]}
    starts = driver.get("time", driver.get("start", 0.0))
    secret = changed(("/simulation/joints/bar", bar), ("/simulation/drivers/f", driver))
    (told,) = [p for p in story_problems(secret) if p.pointer == "/simulation/drivers/f"]
    said = f"driver 'f' acts on 'b1', which the prompt names, from {starts:g} s on, and no beat tells of it: let a beat own it (owner f), or take it away"
    assert told.text == said
    assert told.patch == {"op": "remove", "path": "/simulation/drivers/f"}
    assert not [w for w in audit(secret).warnings if "owned by" in w]
    assert told not in story_problems(apply_patch(secret, [told.patch]))
    owned = [{"op": "add", "path": "/story/beats/fall/owner", "value": "f"}]
    assert told not in story_problems(apply_patch(secret, owned))


def test_a_beat_tells_of_all_motors_that_drive_its_body_at_the_same_time() -> None:
    """A beat has one owner, a cart two driven wheels."""
    both = parse_spec({**yard_spec(), "prompt": YARD_PROMPT})
    both = apply_patch(both, claim_operations(YARD, both))
    assert in_secret(both) == {}
    late = apply_patch(both, [{"op": "add", "path": "/simulation/drivers/drive_bl/start", "value": 0.5}])
    assert in_secret(late) == {"drive_bl": ("body", 0.5)}


@pytest.mark.parametrize(
    ("driver", "members"),
    [
        ({**PUSH, "start": 60.0, "end": 61.0}, {}),
        ({"kind": "release", "entity": "b1", "time": 0.0}, {}),
        (AIR, {}),
        (PUSH, {"claims": {}}),
    ],
    ids=["after the film", "as the film begins", "still air", "on what no words name"],
)
def test_a_driver_that_does_nothing_in_the_film_to_what_is_named_is_not_refused(driver: dict[str, Any], members: Any) -> None:
    assert in_secret(changed(("/simulation/drivers/f", driver), **members)) == {}


def test_a_field_that_blows_before_frame_0_is_told_from_then_on() -> None:
    pull = {"kind": "attraction", "center": [9, 0, 0], "acceleration": 1, "distance": 1, "exponent": 0}
    early = changed(
        ("/simulation/preroll", 0.3),
        ("/simulation/drivers/fld", {"kind": "field", "field": pull, "start": -0.2, "entities": ["b1"]}),
    )
    told = next(w for w in audit(early).warnings if "'fld'" in w)
    assert "acts on b1 from -0.2 s on, before frame 0; 1 is wanted" in told
    assert deed(early, "fld", "b1") == "driver fld acts on b1 from -0.2 s on, before frame 0"


def test_a_driver_that_a_beat_owns_and_still_air_are_not_told() -> None:
    owned = changed(("/simulation/drivers/push", {**PUSH, "entity": "ball"}), ("/story/beats/roll/owner", "push"))
    assert audit(owned).warnings == ()
    assert audit(changed(("/simulation/drivers/air", AIR))).warnings == ()


def test_a_state_from_frame_0_that_is_to_cause_something_is_told_and_one_that_causes_nothing_is_not() -> None:
    still = {"kind": "speed", "entity": "b1", "max": 0.1, "when": "always"}
    beat = {"text": "b1 rests", "owner": "rigid", "subject": "b1", "frames": [0, 4], "predicate": still}
    state = changed(("/story/beats/rests", beat))
    assert audit(state).warnings == ()
    cause = apply_patch(state, [{"op": "add", "path": "/story/beats/strike/causes/-", "value": "rests"}])
    (told,) = audit(cause).warnings
    assert told.startswith("/story/beats/rests: 'rests' lasts from frame 0 on and has no causes")
    assert "strike names it as a cause, so beat:vacuous:rests fails" in told
    caused = apply_patch(cause, [{"op": "replace", "path": "/story/beats/rests/frames", "value": [2, 4]}])
    assert audit(caused).warnings == ()


def test_of_many_warnings_a_reply_shows_the_first_and_how_many_more() -> None:
    many = [(f"/simulation/drivers/p{k}", PUSH) for k in range(MOST_WARNINGS + 3)]
    report = audit(changed(*many, claims={}))
    assert len(report.warnings) == MOST_WARNINGS + 3
    assert len(report.told) == MOST_WARNINGS + 1
    assert report.told[-1].startswith("3 more warnings")


def test_the_bound_of_the_picture_is_that_of_the_judge() -> None:
    assert SCREEN_STEP == JUDGED


def test_a_small_fast_subject_is_told_with_its_way_per_frame_and_the_rate_it_takes() -> None:
    (told,) = audit(changed(FAST)).warnings
    assert told.startswith("/story/beats/roll: 'ball' goes ")
    assert "m per frame (60 m/s at " in told
    assert "Let its shot follow ball from" in told
    fps = int(told.split("take at least ")[1].split(" frames/s")[0])
    quick = changed(FAST, ("/simulation/fps", fps))
    assert not [w for w in audit(quick).warnings if "per frame" in w], "at the rate that it says nothing is told"
    slow = changed(FAST, ("/simulation/fps", fps - 1))
    assert [w for w in audit(slow).warnings if "per frame" in w]


def test_a_fast_subject_that_is_large_followed_or_not_observed_is_not_told() -> None:
    assert audit(changed(("/entities/ball/physics/linear_velocity", [3, 0, 0]))).warnings == ()
    assert audit(changed(FAST, FOLLOWED)).warnings == ()
    assert audit(changed(FAST, ("/story/beats/roll/observe", False))).warnings == ()
    assert audit(changed(FAST, ("/entities/ball/dimensions/size", [3, 3, 3]))).warnings == ()


def test_a_subject_too_fast_for_any_camera_is_told_though_its_shot_follows() -> None:
    faster = ("/entities/ball/physics/linear_velocity", [1400, 0, 0])
    (told,) = audit(changed(faster, FOLLOWED)).warnings
    assert "follow" not in told


@pytest.mark.parametrize(("minimum", "count"), [(2.0, 0), (60.0, 1)])
def test_a_speed_that_a_beat_asks_for_counts(minimum: float, count: int) -> None:
    asked = changed(
        ("/story/beats/fall/predicate", {"kind": "speed", "entity": "b3", "min": minimum}),
        ("/entities/b3/dimensions/size", [0.05, 0.05, 0.05]),
    )
    assert len([w for w in audit(asked).warnings if "per frame" in w]) == count


def _seesaw(predicate: dict[str, Any], middle: float = 0.0) -> tuple[str, ...]:
    """Warnings of a beam of 3 cm on a hinge `middle` metres from its own middle, of which a beat asks something."""
    from worldagent.testing.worlds.event_worlds import event_world

    document = event_world("seesaw").model_dump(mode="json", exclude_none=True)
    document["simulation"]["joints"]["pivot"]["anchor"] = [middle, 0, 0.269]
    document["story"]["beats"] = {
        "turns": {"text": "it turns", "owner": "rigid", "subject": "beam", "frames": [0, 30], "predicate": predicate}
    }
    return tuple(w for w in audit(parse_spec(document)).warnings if w.startswith("/story/beats/turns"))


@pytest.mark.parametrize("kind", ["rises", "falls", "drifts"])
def test_a_beam_that_turns_about_its_middle_is_told_which_predicates_go_by_its_ends(kind: str) -> None:
    (told,) = _seesaw({"kind": kind, "entity": "beam"})
    assert "comes 0 m at most" in told
    assert "`tilts`" in told
    assert "`lifts`" in told
    assert _seesaw({"kind": kind, "entity": "beam"}, middle=0.3) == ()
    assert len(_seesaw({"kind": kind, "entity": "beam", "min": 0.7}, middle=0.3)) == 1


def test_what_goes_by_an_end_or_an_angle_is_not_told() -> None:
    assert _seesaw({"kind": "lifts", "entity": "beam", "other": "cube"}) == ()
    assert _seesaw({"kind": "tilts", "entity": "beam", "min": 0.2}) == ()
    assert len(_seesaw({"kind": "lifts", "entity": "cube", "other": "beam"})) == 1


BOUNCES = ("/story/beats/roll/predicate", {"kind": "bounces", "entity": "ball"})


def bouncing(*operations: tuple[str, Any]) -> list[str]:
    return [w for w in audit(changed(BOUNCES, *operations)).warnings if "is to bounce" in w]


def materials_with(restitution: float) -> list[tuple[str, Any]]:
    return [(f"/materials/{name}/restitution", restitution) for name in changed().materials]


def test_a_bounce_where_nothing_gives_restitution_is_told_before_any_run() -> None:
    (told,) = bouncing(*materials_with(0.0))
    assert told.startswith(
        "/story/beats/roll: 'ball' is to bounce, and with nothing that is there it has a restitution of 0.05 or more"
    )
    assert "the smaller one of its two materials, its own is 0" in told


def test_a_bounce_between_lively_materials_or_of_a_lively_pair_is_not_told() -> None:
    assert bouncing(*materials_with(0.5)) == []
    pair = ("/simulation/contacts/hop", {"a": "ball", "b": "b1", "restitution": 0.5, "reason": "a spring lies between the two"})
    assert bouncing(*materials_with(0.0), pair) == []


def test_one_lively_material_alone_gives_no_bounce() -> None:
    ball = changed().entities["ball"].material
    (told,) = bouncing(*materials_with(0.0), (f"/materials/{ball}/restitution", 0.9))
    assert "(the largest is 0)" in told
    assert "its own is 0.9" in told
