"""Materials that are rows of the table: taken by an edit, held by the audit, told by the register (R154)."""

from __future__ import annotations

import copy
from typing import Any

import pytest
from worldagent.testing.worlds import small_worlds as sw
from worldagent.testing.worlds.small_grains import SAND_PROMPT, sand_spec
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.verifiers.register.scene import _materials
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.canonical import spec_digest
from worldagent.worlds.categories.particles.models import ParticlePhysics
from worldagent.worlds.errors import SpecError
from worldagent.worlds.materials import material_table
from worldagent.worlds.named_materials import departures
from worldagent.worlds.patch import apply_patch, parse_edit, parse_spec
from worldagent.worlds.slices import motion_slice
from worldagent.worlds.spec import Material, WorldSpec

OAK = material_table().materials["oak"]
RUBS = OAK.figures["friction"].range


def _edited(**materials: Any) -> WorldSpec:
    return parse_edit({**small_spec(), "prompt": PROMPT, "materials": {**small_spec()["materials"], **materials}})


def _problems(spec: WorldSpec) -> str:
    return "\n".join(p for r in audit(spec).rows if r.status == "fail" for p in r.evidence["problems"])


def test_a_name_alone_takes_density_friction_substance_and_look_into_the_specification() -> None:
    after = apply_patch(
        parse_edit({**small_spec(), "prompt": PROMPT}), [{"op": "replace", "path": "/entities/b2/material", "value": "oak"}]
    )
    oak = after.materials["oak"]
    assert (oak.of, oak.substance, oak.density, oak.friction) == ("oak", "wood", OAK.figures["density"].range[1], RUBS[1])
    assert list(oak.appearance.color) == OAK.look["color"]
    assert after.entities["b2"].material == "oak"
    assert _problems(after) == ""
    assert parse_spec(after.model_dump(mode="json")) == after, "what is written down is whole"


def test_what_a_material_says_itself_stays_and_the_row_gives_the_rest() -> None:
    plank = _edited(plank={"of": "oak", "friction": 0.4, "appearance": {"color": [0.8, 0.1, 0.1]}}).materials["plank"]
    assert (plank.friction, plank.density, plank.appearance.color) == (0.4, OAK.figures["density"].range[1], (0.8, 0.1, 0.1))


def test_grains_weigh_as_grains_and_what_stands_for_a_heap_as_the_heap() -> None:
    spec = sand_spec()
    spec["entities"]["sand"]["material"] = spec["entities"]["tray"]["material"] = "gravel"
    both = parse_edit({**spec, "prompt": SAND_PROMPT})
    assert both.materials["gravel"].density == material_table().materials["gravel"].figures["density"].range[1]
    spec["entities"]["tray"]["material"] = "oak"
    grains = parse_edit({**spec, "prompt": SAND_PROMPT})
    assert grains.materials["gravel"].density == material_table().materials["gravel"].figures["grain_density"].range[1]
    assert list(departures(grains.materials["gravel"])) == []


def test_another_name_of_a_row_is_written_as_the_row() -> None:
    assert _edited(rail={"of": "Steel"}).materials["rail"].of == "mild_steel"


def test_a_row_that_is_not_there_is_told_with_the_nearest() -> None:
    with pytest.raises(SpecError, match=r"/materials/plank/of: the table of materials has no 'oaks'; did you mean 'oak'\?"):
        _edited(plank={"of": "oaks"})


def test_a_stored_specification_is_read_as_it_is() -> None:
    """Only edits take from the table: reading must not change what a digest binds."""
    spec = small_spec()
    spec["entities"]["b2"]["material"] = "oak"
    parsed = parse_spec({**spec, "prompt": PROMPT})
    assert "oak" not in parsed.materials
    assert "unknown material 'oak'" in _problems(parsed)


def test_materials_without_a_row_are_written_as_before() -> None:
    assert set(Material(density=600.0).model_dump()) & {"of", "departs"} == set()
    spec = sw.world({"crate": sw.box(0.1, 0.1, 0.1)})
    named = spec.model_copy(update={"materials": {k: m.model_copy(update={"of": "oak"}) for k, m in spec.materials.items()}})
    assert motion_slice(spec) == motion_slice(named), "which row it is decides nothing that moves"
    assert spec_digest(spec) != spec_digest(named)


@pytest.mark.parametrize(
    ("field", "value", "said"),
    [
        ("friction", 0.05, f"{RUBS[0]:g} to {RUBS[2]:g}"),
        ("density", 1100.0, "oak has"),
        ("substance", "steel", "of substance wood, not steel"),
    ],
)
def test_a_material_that_departs_from_its_row_is_refused_with_the_range(field: str, value: Any, said: str) -> None:
    text = _problems(_edited(plank={"of": "oak", field: value}))
    assert f"/materials/plank/{field}: " in text
    assert said in text


def test_a_departure_that_says_why_passes_and_is_told_by_the_register() -> None:
    spec = _edited(plank={"of": "oak", "friction": 0.05, "departs": "waxed on its upper side"})
    assert _problems(spec) == ""
    told = [text for text, _ in _materials(spec)]
    assert len(told) == 1
    assert "'plank' is oak with a friction of 0.05" in told[0]
    assert "waxed on its upper side" in told[0]


def test_no_reason_lets_a_material_weigh_what_its_substance_does_not() -> None:
    spec = _edited(plank={"of": "oak", "density": 1900.0, "departs": "soaked with water for years"})
    assert "1900 kg/m^3 is no wood" in _problems(spec)
    iron = _edited(iron={"density": 30.0, "substance": "other", "departs": "it is very hollow inside"})
    assert "called iron" in _problems(iron)


def test_a_material_that_is_called_like_a_row_weighs_what_it_does_or_says_why() -> None:
    light = {"density": 300.0, "substance": "wood"}
    assert "is called oak and weighs 300" in _problems(_edited(dark_oak=light))
    assert _problems(_edited(dark_oak={**light, "departs": "eaten hollow by worms"})) == ""
    assert _problems(_edited(gold={"density": 600.0, "substance": "wood"})) == "", "of another substance it is a colour"


def test_grains_weigh_what_one_of_them_does_and_a_body_what_a_heap_does() -> None:
    stone = {"density": 2500.0, "substance": "stone"}
    spec = _edited(gravel=stone)
    assert "is called gravel and weighs 2500" in _problems(spec), "no grain is of it"
    bed = spec.entities["b1"].model_copy(update={"material": "gravel", "physics": ParticlePhysics(radius=0.01)})
    assert "is called gravel" not in _problems(spec.model_copy(update={"entities": {**spec.entities, "bed": bed}}))
    body = spec.entities["b1"].model_copy(update={"material": "gravel"})
    both = spec.model_copy(update={"entities": {**spec.entities, "bed": bed, "body": body}})
    assert "is called gravel and weighs 2500" in _problems(both)


def test_friction_of_a_pair_that_the_table_has_needs_no_reason() -> None:
    spec = small_spec()
    spec["materials"] = {**spec["materials"], "teflon": {"of": "ptfe"}, "rail": {"of": "mild_steel", "friction": 0.57}}
    spec["entities"]["b2"]["material"], spec["entities"]["b1"]["material"] = "teflon", "rail"
    spec["simulation"]["contacts"] = {"slides": {"a": "b1", "b": "b2", "friction": 0.04}}
    assert "/simulation/contacts/slides" not in _problems(parse_edit({**spec, "prompt": PROMPT}))
    other = copy.deepcopy(spec)
    other["simulation"]["contacts"]["slides"]["friction"] = 0.2
    assert "/simulation/contacts/slides/friction" in _problems(parse_edit({**other, "prompt": PROMPT}))
