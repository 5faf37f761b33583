"""A change is taken back where everything causal is as it was, whatever lies unused beside it."""

from __future__ import annotations

from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.workflow.repair_rules import same_causes
from worldagent.worlds.named_materials import declared_by_name
from worldagent.worlds.patch import apply_patch
from worldagent.worlds.spec import WorldSpec


def test_a_material_that_an_edit_took_from_the_table_and_nothing_uses_any_more_is_no_change() -> None:
    before = WorldSpec.model_validate({**small_spec(), "prompt": PROMPT})
    path, stone = "/entities/floor/material", before.entities["floor"].material
    edited = declared_by_name(apply_patch(before, [{"op": "replace", "path": path, "value": "lead"}]))
    assert "lead" in edited.materials
    assert not same_causes(before, edited)
    back = apply_patch(edited, [{"op": "replace", "path": path, "value": stone}])
    assert "lead" in back.materials
    assert same_causes(before, back)
    heavier = apply_patch(back, [{"op": "replace", "path": f"/materials/{stone}/density", "value": 2000}])
    assert not same_causes(before, heavier), "a material that something is made of counts"


def test_the_lists_of_what_was_made_of_interiors_decide_nothing() -> None:
    """Who takes a thing out and puts it back need not restore a record that the server keeps."""
    house = {"rooms": {"hall": {"kind": "hall"}}, "entities": ["shelf", "b1"]}
    spec = WorldSpec.model_validate({**small_spec(), "prompt": PROMPT})
    before = apply_patch(spec, [{"op": "add", "path": "/interiors", "value": {"house": house}}])
    block = before.model_dump(mode="json", exclude_none=True)["entities"]["b1"]
    out = apply_patch(before, [{"op": "remove", "path": "/entities/b1"}])
    assert not same_causes(before, out)
    assert same_causes(before, apply_patch(out, [{"op": "add", "path": "/entities/b1", "value": block}]))
    other = apply_patch(before, [{"op": "add", "path": "/interiors/house/seed", "value": 3}])
    assert not same_causes(before, other)
