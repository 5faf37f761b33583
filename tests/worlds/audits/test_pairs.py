"""Contacts of a pair with friction or restitution of their own: near what the materials give, or with a reason."""

from __future__ import annotations

from typing import Any

import pytest
from worldagent.testing.worlds.small_worlds import ball, ground, world
from worldagent.verifiers.register.scene import scene_lines
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.audits.pairs import surface_problems
from worldagent.worlds.spec import ContactPair, Material, WorldSpec

WOOD = {"wood": Material(density=600.0, friction=0.3, restitution=0.4, substance="wood")}


def with_pair(**own: Any) -> WorldSpec:
    entities = {"floor": ground(), "ball": ball(0.1, motion="dynamic", at=(0, 0, 0.1))}
    spec = world(entities, materials=WOOD)
    plan = spec.simulation.model_copy(update={"contacts": {"c": ContactPair(a="ball", b="floor", **own)}})
    return spec.model_copy(update={"simulation": plan})


@pytest.mark.parametrize(
    "own", [{"friction": 0.15}, {"friction": 0.6}, {"restitution": 0.2}, {"restitution": 0.6}, {"friction": 0.3}]
)
def test_values_near_what_the_materials_give_need_no_reason(own: dict[str, float]) -> None:
    assert list(surface_problems(with_pair(**own))) == []


@pytest.mark.parametrize(
    ("field", "value", "nearest"),
    [
        ("friction", 0.0, 0.15),
        ("friction", 0.149, 0.15),
        ("friction", 0.601, 0.6),
        ("restitution", 1.0, 0.6),
        ("restitution", 0.19, 0.2),
    ],
)
def test_values_far_from_it_are_refused_with_the_range_and_a_patch(field: str, value: float, nearest: float) -> None:
    spec = with_pair(**{field: value})
    (found,) = surface_problems(spec)
    assert found.pointer == f"/simulation/contacts/c/{field}"
    assert f"{value:g}" in found.text
    assert found.patch is not None
    assert found.patch["value"] == pytest.approx(nearest)
    (row,) = (r for r in audit(spec).rows if r.id == "audit:bounds")
    assert row.status == "fail"


def test_a_reason_lets_it_pass_and_is_printed(tmp_path: Any) -> None:
    from worldagent.testing.worlds.small_worlds import make_candidate

    spec = with_pair(friction=0.0, reason="the floor is wet ice there")
    assert list(surface_problems(spec)) == []
    said = [line["what"] for line in scene_lines(make_candidate(tmp_path, spec))]
    assert any("friction of 0, where their materials give 0.3: the floor is wet ice there" in text for text in said)


def test_parts_of_several_materials_widen_the_range() -> None:
    spec = with_pair(friction=0.15)
    slick = {**spec.materials, "ice": Material(density=917.0, friction=0.02, restitution=0.1, substance="ice")}
    floor = spec.entities["floor"].model_copy(update={"material": "ice"})
    # The larger of both holds, so that ice beneath wood still rubs like wood.
    spec = spec.model_copy(update={"materials": slick, "entities": {**spec.entities, "floor": floor}})
    assert list(surface_problems(spec)) == []
    (found,) = surface_problems(
        spec.model_copy(
            update={
                "simulation": spec.simulation.model_copy(
                    update={"contacts": {"c": ContactPair(a="ball", b="floor", friction=0.02)}}
                )
            }
        )
    )
    assert "their materials give 0.3" in found.text
