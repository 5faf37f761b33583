"""The audit of bodies that declare lift: refused where nothing carries them, where no hull is known, where they are no plates."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.testing.worlds.carried_worlds import JET_PROMPT, stream_spec
from worldagent.tests.physics.rigid_world import ball, box, floor, world
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.requirements import Row
from worldagent.worlds.slices import motion_slice
from worldagent.worlds.spec import WorldSpec
from worldagent.worlds.writers import writers_of

AIR = {"air": {"kind": "field", "field": {"kind": "drag"}}}


def lifted(thing: dict[str, Any], **more: Any) -> dict[str, Any]:
    thing["physics"]["lift"] = True
    return thing | more


def row(thing: dict[str, Any], drivers: dict[str, Any]) -> Row | None:
    spec = world({"ground": floor(), "b": thing}, drivers=drivers)
    return next((r for r in audit(spec).rows if r.id == "audit:fields"), None)


def card(**more: Any) -> dict[str, Any]:
    return lifted(box(0.2, 0.2, 0.002, at=(0, 0, 1)), **more)


def test_a_card_in_air_passes() -> None:
    found = row(card(), AIR)
    assert found is not None
    assert found.status == "pass"


WATER = {"sea": {"kind": "field", "field": {"kind": "drag", "density": 1000.0}}}
PULL = {"pull": {"kind": "field", "field": {"kind": "attraction", "center": (0, 0, 0), "acceleration": 1.0, "distance": 1.0}}}
ELSEWHERE = {"air": {**AIR["air"], "entities": ["ground"]}}
BROKEN = {"pattern": {"kind": "bricks", "size": (0.1, 0.1, 0.002)}, "bond": {"tension": 1e5, "shear": 1e5}}
ROPE = {"kind": "rope", "points": [(0, 0, 1), (0, 0, 2)], "radius": 0.01, "segments": 8}
WRONG: list[tuple[dict[str, Any], dict[str, Any], str]] = [
    (card(), {}, "so that it has no medium; add a field"),
    (card(), PULL, "so that it has no medium"),
    (card(), WATER, "the medium of field 'sea' has 1000 kg/m^3"),
    (card(motion="static"), AIR, "'b' is static; make it dynamic"),
    (card(breakable=BROKEN), AIR, "'b' is breakable"),
    (card(generator=ROPE, parts={}), AIR, "has no parts whose hull"),
    (lifted(ball(0.1, at=(0, 0, 1))), AIR, "is 0, at least 0.2 has lift to speak of; make it thinner"),
    (lifted(box(0.2, 0.2, 0.19, at=(0, 0, 1))), AIR, "it is 0.19 m thick and 0.2 m wide"),
]


@pytest.mark.parametrize(("thing", "drivers", "said"), WRONG)
def test_lift_without_sense_is_refused_with_the_next_step(thing: dict[str, Any], drivers: dict[str, Any], said: str) -> None:
    found = row(thing, drivers)
    assert found is not None
    assert found.status == "fail"
    texts = [c.action for c in found.corrections]
    assert any(said in t and t.endswith("or set lift to false") for t in texts), texts


def test_no_row_is_asked_where_neither_field_nor_lift_is() -> None:
    assert row(box(0.2, 0.2, 0.002, at=(0, 0, 1)), {}) is None


def carried(direction: str, resolution: float) -> tuple[WorldSpec, str]:
    document = stream_spec(thing="card", resolution=resolution)
    document["simulation"]["couplings"]["carries"]["direction"] = direction
    spec = WorldSpec.model_validate({"prompt": JET_PROMPT, **document})
    rows = [r for r in audit(spec).rows if r.id in ("audit:couplings", "audit:fields")]
    return spec, " ".join(c.action for r in rows if r.status != "pass" for c in r.corrections)


def test_a_gas_may_lift_a_card_and_feel_one_no_wider_than_its_cells() -> None:
    assert carried("one_way", 0.05)[1] == ""
    assert carried("two_way", 0.1)[1] == ""
    said = carried("two_way", 0.05)[1]
    assert "'card' declares lift, is 0.1 m long, and the gas that feels it has cells of 0.05 m" in said
    assert "Make the coupling one_way" in said


def test_only_instances_with_lift_write_twists() -> None:
    spec = carried("one_way", 0.05)[0]
    assert "rigid lifted" in writers_of(spec, "bodies")
    plain = world({"b": box(0.2, 0.2, 0.002)}, drivers=AIR)
    assert "rigid lifted" not in writers_of(plain, "main")


def test_what_declares_no_lift_moves_by_the_same_recipe_as_before() -> None:
    plain, with_lift = (motion_slice(world({"b": thing}, drivers=AIR)) for thing in (box(0.2, 0.2, 0.002), card()))
    assert "lift" not in plain["entities"]["b"]["physics"]
    assert with_lift["entities"]["b"]["physics"]["lift"] is True
