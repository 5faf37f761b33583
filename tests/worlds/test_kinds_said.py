"""Who renames what failed has not mended it: such an edit is told, and needs a reason (R157)."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
import worldagent
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.verifiers.scene.questions import HIDDEN
from worldagent.verifiers.things.questions import JOINT, KIND
from worldagent.worlds.by_claim import easier_by_claim
from worldagent.worlds.kinds_said import ASKED_BY_ROLE, role_weakenings
from worldagent.worlds.patch import apply_patch, parse_spec
from worldagent.worlds.spec import WorldSpec


def _spec(**roles: str) -> WorldSpec:
    document = small_spec()
    for name, role in roles.items():
        document["entities"][name]["role"] = role
    return parse_spec({**document, "prompt": PROMPT})


def _edited(spec: WorldSpec, pointer: str, value: Any) -> WorldSpec:
    return apply_patch(spec, [{"op": "add", "path": pointer, "value": value}])


def test_another_role_is_told_where_a_row_failed_that_it_asks() -> None:
    before = _spec(b1="dining table")
    after = _edited(before, "/entities/b1/role", "block")
    assert list(role_weakenings(before, after, {"b1"})) == [
        "/entities/b1/role 'dining table' -> 'block', by which a failing row was asked"
    ]
    assert list(role_weakenings(before, after, {"b2"})) == []
    assert list(role_weakenings(before, before, {"b1"})) == []


def test_hanging_a_thing_from_another_is_told_like_another_role() -> None:
    before = _spec(b1="dining table")
    joint = {"kind": "ball", "parent": "shelf", "child": "b1", "anchor": [0, 0, 0.4]}
    (line,) = role_weakenings(before, _edited(before, "/simulation/joints/hook", joint), {"b1"})
    assert "/entities/b1 is hung from another" in line


def test_another_maker_is_told_like_another_role() -> None:
    before = _edited(_spec(), "/entities/b1/asset", {"generator": "table"})
    (line,) = role_weakenings(before, _edited(before, "/entities/b1/asset/generator", "crate"), {"b1"})
    assert line.startswith("/entities/b1/asset/generator table -> crate")


def test_a_world_beside_that_says_it_is_another_thing_is_told() -> None:
    before = _spec(b1="dining table")
    said = "/entities/b1/role 'dining table' -> 'block 1', by which a failing row was asked"
    assert said in easier_by_claim(before, _spec(), {"b1"})
    assert easier_by_claim(before, _spec(b1="oak table"), {"b1"}) == []
    assert easier_by_claim(before, _spec()) == []


def test_every_verifier_that_reads_a_role_has_its_question_named() -> None:
    """A verifier that begins to read roles adds its question to `ASKED_BY_ROLE`, and its module here."""
    root = Path(worldagent.__file__).parent / "verifiers"
    reads = {p.relative_to(root).as_posix() for p in root.rglob("*.py") if re.search(r"\.role\b|\[.role.\]", p.read_text())}
    assert reads == {"scene/hidden.py", "things/openings.py", "things/sizes.py"}
    assert {KIND.id, HIDDEN.id, JOINT.id} == ASKED_BY_ROLE


@pytest.mark.parametrize("question", sorted(ASKED_BY_ROLE))
def test_the_questions_name_the_things_that_they_ask_about(question: str) -> None:
    found = {q.id: q for q in (KIND, HIDDEN, JOINT)}[question]
    assert found.subject in (("entity",), ("joint",))
