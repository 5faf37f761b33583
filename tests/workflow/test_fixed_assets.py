"""Generated things whose leaves and drawers are fixed: made so, made anew, loosed again, and told where they still move."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.tests.stories.small_run import small_spec
from worldagent.workflow.arrangements import AssetAsk
from worldagent.workflow.generated import asset_operations
from worldagent.worlds.errors import InputError
from worldagent.worlds.kinds_said import role_weakenings
from worldagent.worlds.patch import apply_patch, parse_spec
from worldagent.worlds.spec import WorldSpec


def placed(spec: WorldSpec, name: str = "door", **asked: Any) -> tuple[WorldSpec, dict[str, Any]]:
    operations, told = asset_operations(spec, name, AssetAsk.model_validate({"generator": "door", **asked}))
    return apply_patch(spec, operations), told


@pytest.fixture
def spec() -> WorldSpec:
    return parse_spec({**small_spec(), "prompt": "A block topples another."})


def test_a_door_is_fixed_made_anew_and_loosed_again(spec: WorldSpec) -> None:
    shut, told = placed(spec, fixed=True, motion="static")
    assert "still_moving" not in told
    assert shut.entities["door_leaf"].motion == "static"
    assert "door_leaf" not in {j.child for j in shut.simulation.joints.values()}
    assert shut.graph.relations["door_leaf_fixed"].kind == "fastened"
    wider, _ = placed(shut, parameters={"width": 0.9})
    assert wider.entities["door_leaf"].motion == "static", "it stays fixed where the call does not say"
    loose, _ = placed(wider, fixed=False)
    assert loose.entities["door_leaf"].motion == "dynamic"
    assert "door_leaf" in {j.child for j in loose.simulation.joints.values()}
    assert "door_leaf_fixed" not in loose.graph.relations


def test_a_static_door_whose_leaf_still_turns_is_told(spec: WorldSpec) -> None:
    loose, told = placed(spec, motion="static")
    assert loose.entities["door_leaf"].motion == "dynamic"
    assert "fixed: true" in told["still_moving"]


def test_a_static_thing_without_joints_may_be_called_fixed(spec: WorldSpec) -> None:
    operations, _ = asset_operations(spec, "jar", AssetAsk(generator="glass", fixed=True, motion="static"))
    jar = apply_patch(spec, operations).entities["jar"]
    assert jar.motion == "static"
    assert jar.asset is not None
    assert not jar.asset.fixed


def test_a_lid_that_lies_loosely_is_told_and_fixed(spec: WorldSpec) -> None:
    operations, told = asset_operations(spec, "jam", AssetAsk(generator="jar", motion="static"))
    assert apply_patch(spec, operations).entities["jam_lid"].motion == "dynamic"
    assert "jam_lid lie loosely" in told["still_moving"]
    operations, told = asset_operations(spec, "jam", AssetAsk(generator="jar", motion="static", fixed=True))
    made = apply_patch(spec, operations)
    assert made.entities["jam_lid"].motion == "static"
    assert "still_moving" not in told
    wider, _ = asset_operations(made, "jam", AssetAsk(generator="jar", parameters={"height": 0.16}))
    assert apply_patch(made, wider).entities["jam_lid"].motion == "static", "it stays fixed where the call does not say"


def test_a_static_row_or_pile_is_static_as_far_as_it_stands(spec: WorldSpec) -> None:
    """A pile of blocks asked for as static kept its other blocks dynamic, and floated by their skins."""
    made = apply_patch(spec, asset_operations(spec, "row", AssetAsk(generator="dominoes", motion="static"))[0])
    assert {made.entities[n].motion for n in made.entities if n.startswith("row")} == {"static"}
    pile, told = asset_operations(spec, "pile", AssetAsk(generator="building_blocks", motion="static"))
    made = apply_patch(spec, pile)
    assert made.entities["pile_block_2"].motion == "static"
    assert any(made.entities[n].motion == "dynamic" for n in made.entities if n.startswith("pile")), "the upper ones lie loosely"
    assert "lie loosely" in told["still_moving"]
    again, said = asset_operations(made, "pile", AssetAsk(generator="building_blocks", motion="static"))
    assert again == [] or "kept_as_changed_by_hand" not in said
    castle = apply_patch(spec, asset_operations(spec, "castle", AssetAsk(generator="castle", motion="static"))[0])
    assert castle.entities["castle_tower_a"].motion == "dynamic", "a thing that is static by itself says which of it moves"


def test_a_static_pile_is_told_what_lies_loose_on_it_and_is_fixed_as_a_whole(spec: WorldSpec) -> None:
    pile = {"generator": "pile_of_books", "parameters": {"count": 3}, "motion": "static"}
    loose, told = placed(spec, "pile", **pile)
    bodies = ["pile", *loose.entities["pile"].asset.bodies]
    assert [loose.entities[n].motion for n in bodies] == ["static", "dynamic", "dynamic"]
    assert "pile_book_2, pile_book_3 lie loose" in told["still_moving"]
    still, told = placed(spec, "pile", **pile, fixed=True)
    assert {still.entities[n].motion for n in bodies} == {"static"}
    assert "still_moving" not in told
    moving, _ = placed(spec, "pile", **{**pile, "motion": "dynamic"}, fixed=True)
    assert {moving.entities[n].motion for n in bodies} == {"dynamic"}


def test_what_has_no_joints_cannot_be_fixed(spec: WorldSpec) -> None:
    with pytest.raises(InputError, match="no leaves, drawers or lids"):
        asset_operations(spec, "jar", AssetAsk(generator="glass", fixed=True))


def test_fixing_what_failed_to_open_is_a_weakening(spec: WorldSpec, tmp_path: Path) -> None:
    loose, shut = placed(spec)[0], placed(spec, fixed=True)[0]
    assert any("hangs on no joint any more" in line for line in role_weakenings(loose, shut, {"door_leaf"}))
    assert list(role_weakenings(loose, shut, set())) == []
