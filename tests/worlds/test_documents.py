"""A specification as JSON: the bytes that pydantic writes, made once for each, and untouched by patches."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.bench.edit_latency import specification
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.workflow.creation import create
from worldagent.workflow.session import Session
from worldagent.worlds.documents import KEPT, bare_document, document_of, text_of
from worldagent.worlds.errors import SpecError
from worldagent.worlds.patch import apply_patch, parse_spec
from worldagent.worlds.spec import WorldSpec

OPERATIONS: tuple[list[dict[str, Any]], ...] = (
    [{"op": "replace", "path": "/entities/ball/pose/position/0", "value": 9.0}],
    [{"op": "remove", "path": "/story/beats/fall/causes/0"}],
    [
        {"op": "copy", "from": "/entities/b1", "path": "/entities/b9"},
        {"op": "replace", "path": "/entities/b9/motion", "value": "static"},
    ],
    [
        {"op": "move", "from": "/entities/b1", "path": "/entities/b9"},
        {"op": "move", "from": "/entities/b9", "path": "/entities/b1"},
    ],
    [{"op": "add", "path": "/story/beats/fall/causes/-", "value": "roll"}],
    [{"op": "add", "path": "/entities/b1/parts/x~1y", "value": {}}],
    [{"op": "replace", "path": "", "value": {}}],
    [{"op": "test", "path": "/title", "value": "other"}],
)


def small() -> WorldSpec:
    return parse_spec({**small_spec(), "prompt": PROMPT})


def test_the_text_is_that_of_the_model() -> None:
    for spec in (small(), parse_spec({**specification(5), "prompt": "Boxes stand on a floor."})):
        assert text_of(spec).decode() == spec.model_dump_json(exclude_none=True)
        assert text_of(spec, indent=1).decode() == spec.model_dump_json(exclude_none=True, indent=1)


def test_equal_models_have_documents_of_their_own_and_one_has_always_the_same() -> None:
    one, other = small(), small()
    assert document_of(one) is document_of(one)
    assert document_of(one) is not document_of(other)
    assert document_of(one.model_copy(update={"title": "x"}))["title"] == "x"


def test_many_models_are_each_read_as_they_are() -> None:
    specs = [small().model_copy(update={"title": f"t{k}"}) for k in range(3 * KEPT)]
    for _ in range(2):
        assert [document_of(s)["title"] for s in specs] == [s.title for s in specs]


@pytest.mark.parametrize("operations", OPERATIONS)
def test_a_patch_leaves_the_kept_document_as_it_was(operations: list[dict[str, Any]]) -> None:
    spec = small()
    before = bare_document(spec)
    try:
        after = apply_patch(spec, operations)
    except SpecError:
        after = None
    assert bare_document(spec) is before
    assert before == spec.model_dump(mode="json", exclude_none=True)
    assert after is None or bare_document(after) == after.model_dump(mode="json", exclude_none=True)


def test_an_edit_dumps_the_new_specification_twice_and_no_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With and without nulls: digests, differences, recipes, texts and the audit share the two."""
    create(tmp_path, "small", PROMPT, small_spec(), None)
    dumped: list[bool] = []
    dump, text = WorldSpec.model_dump, WorldSpec.model_dump_json

    def spied(self: WorldSpec, **settings: Any) -> Any:
        dumped.append(settings.get("exclude_none", False))
        return dump(self, **settings)

    def written(self: WorldSpec, **settings: Any) -> Any:
        dumped.append(settings.get("exclude_none", False))
        return text(self, **settings)

    monkeypatch.setattr(WorldSpec, "model_dump", spied)
    monkeypatch.setattr(WorldSpec, "model_dump_json", written)
    session = Session.open(tmp_path, "small")
    operations = [{"op": "replace", "path": "/entities/ball/pose/position/2", "value": 0.75}]
    session.commit(apply_patch(session.spec, operations), patch=operations)
    session.audit()
    assert sorted(dumped) == [False, True]
