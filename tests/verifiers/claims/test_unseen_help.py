"""Help that nobody sees fails `claim:unseen`; the same bodies seen, named or out of the way pass it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.testing.defects._films import film_of
from worldagent.testing.worlds.event_worlds import event_world
from worldagent.verifiers.claims import unseen_help
from worldagent.worlds.patch import apply_patch, parse_spec
from worldagent.worlds.requirements import Row

CLEAR = {"density": 2500, "friction": 0.3, "appearance": {"color": [1, 1, 1], "roughness": 0, "transmission": 1}}
SEEN = {**CLEAR, "appearance": {"color": [0.2, 0.2, 0.2]}}
NAMED = {
    "box": {"quote": "box", "type": "thing", "by": ["/entities/box"]},
    "hitter": {"quote": "another box", "type": "thing", "by": ["/entities/hitter"]},
}
SPRING = {
    "kind": "spring",
    "parent": "hitter",
    "child": "box",
    "parent_point": [0, 0, 1],
    "child_point": [0.2, 0, 1],
    "stiffness": 50.0,
    "rest_length": 0.1,
}


def row(folder: Path, *operations: tuple[str, Any], claims: dict[str, Any] = NAMED) -> Row | None:
    document = event_world("hit").model_dump(mode="json")
    document |= {"spec_version": "2", "prompt": "A box hits another box and a pane.", "claims": claims}
    document.pop("clauses", None)
    document["materials"]["pane"] = SEEN
    spec = apply_patch(parse_spec(document), [{"op": "add", "path": p, "value": v} for p, v in operations])
    found = unseen_help.check(film_of(spec).candidate(folder))
    return found[0] if found else None


@pytest.mark.parametrize(
    ("operations", "claims", "status"),
    [
        ((), NAMED, "pass"),
        ((("/materials/pane", CLEAR), ("/entities/hitter/material", "pane")), {"box": NAMED["box"]}, "fail"),
        ((("/entities/hitter/material", "pane"),), {"box": NAMED["box"]}, "pass"),
        ((("/materials/pane", CLEAR), ("/entities/hitter/material", "pane")), NAMED, "pass"),
        ((("/simulation/joints", {"s": SPRING}),), NAMED, "fail"),
    ],
)
def test_what_is_clear_and_not_named_may_not_push_or_pull_what_is_named(
    tmp_path: Path, operations: tuple[tuple[str, Any], ...], claims: dict[str, Any], status: str
) -> None:
    found = row(tmp_path, *operations, claims=claims)
    assert found is not None
    assert (found.status, bool(found.corrections)) == (status, status == "fail")


LOOSE = {
    "text": "the box comes loose", "owner": "rigid", "subject": "box", "frames": [0, 10], "predicate": {"kind": "comes_loose", "entity": "box"},
}  # fmt: skip
CUT = {"kind": "detach", "joint": "s", "time": 0.1}


@pytest.mark.parametrize(
    ("beat", "drivers", "status"),
    [
        (LOOSE, {"cut": CUT}, "pass"),
        ({**LOOSE, "owner": "cut", "predicate": {"kind": "falls", "entity": "box"}}, {"cut": CUT}, "pass"),
        (LOOSE, {}, "fail"),
        ({**LOOSE, "mandatory": False}, {"cut": CUT}, "fail"),
        ({**LOOSE, "predicate": {"kind": "falls", "entity": "box"}}, {"cut": CUT}, "fail"),
        ({**LOOSE, "predicate": {"kind": "comes_loose", "entity": "box", "other": "floor"}}, {"cut": CUT}, "fail"),
    ],
)
def test_a_spring_is_no_unseen_help_where_the_story_tells_that_it_lets_go(
    tmp_path: Path, beat: dict[str, Any], drivers: dict[str, Any], status: str
) -> None:
    """Choice: a spring that stands for a screw or a hook is told of by `comes_loose` of what it holds, or by the beat of its opening."""
    operations = [("/simulation/joints", {"s": SPRING}), ("/simulation/drivers", drivers), ("/story/beats", {"loose": beat})]
    found = row(tmp_path, *operations)
    assert found is not None
    assert found.status == status


@pytest.mark.parametrize(("leg", "status"), [(CLEAR, "fail"), (SEEN, "pass")])
def test_a_clear_leg_that_holds_a_body_up_is_no_hovering(tmp_path: Path, leg: dict[str, Any], status: str) -> None:
    size = event_world("hit").entities["box"].dimensions.size[2]
    thin = {
        "shape": {"kind": "box", "size": [0.004, 0.004, 0.2]},
        "material": "pane",
        "pose": {"position": [0, 0, 0.5 * size + 0.1]},
    }
    top = {"shape": {"kind": "box", "size": [0.05, 0.05, 0.05]}, "pose": {"position": [0, 0, 0.5 * size + 0.225]}}
    found = row(tmp_path, ("/materials/pane", leg), ("/entities/box/parts/leg", thin), ("/entities/box/parts/top", top))
    assert found is not None
    assert found.status == status
    assert ("leg" in str(found.evidence.get("unseen"))) is (status == "fail")


def test_a_world_of_which_no_claim_names_a_body_is_not_asked(tmp_path: Path) -> None:
    assert row(tmp_path, claims={}) is None
