"""A yard made by the client alone: stones scattered, a cart copied and turned with its wheels, a table beside it; no number computed by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.small_liquids import CRATE, LINER, tank_spec
from worldagent.testing.worlds.small_liquids import PROMPT as TANK
from worldagent.tests.stories.inline_jobs import run_jobs_inline
from worldagent.tests.stories.yard import CART, MARKED, PROMPT, WHEELS, yard_spec
from worldagent.worlds.ledger import Ledger
from worldagent.worlds.requirements import Correction, Row

STONES = {
    "kind": "scatter",
    "count": 25,
    "polygon": [[-5.5, -5.5], [-1.5, -5.5], [-1.5, -1.5], [-5.5, -1.5]],
    "size": [0.5, 1.4],
    "seed": 5,
}
WHY = "the cart stands where nothing can roll, so it is moved as one"


@pytest.fixture
def yard(agent: Any) -> Any:
    created = agent.call("edit_spec", world="w", prompt=PROMPT, spec=yard_spec(), claims=MARKED)
    assert created["audit"]["passed"], created
    return agent


def _spec(agent: Any, pointer: str) -> Any:
    return agent.call("inspect_world", world="w", part="spec", pointer=pointer)["value"]


def test_stones_are_scattered_a_cart_is_copied_and_both_carts_roll(yard: Any) -> None:
    assert yard.call("place_object", world="w", entity="stone", on="ground", lay=True)["static_passed"]
    many = yard.call("place_object", world="w", entity="stone", on="ground", lay=True, array=STONES)
    assert many["static_passed"], many["open_rows"]
    assert (many["placed_total"], many["revision"]) == (25, 3)
    assert [p["id"] for p in many["placed"][:3]] == ["stone", "stone_002", "stone_003"]
    assert many["placed_more"].startswith("stone_021 to stone_025")
    assert all(-5.5 < c < -1.5 for p in many["placed"] for c in p["position"][:2])
    again = yard.call("place_object", world="w", entity="stone", on="ground", lay=True, array=STONES)
    assert again["summary"].startswith("stone stays where it was"), "equal seeds, equal places"

    cart = yard.call("place_object", world="w", entity="body", group=WHEELS, copy="_b", on="ground", at=[1.0, 2.5], yaw_deg=90)
    assert cart["static_passed"], cart["open_rows"]
    assert [p["id"] for p in cart["placed"]] == [f"{n}_b" for n in CART]
    assert _spec(yard, "/simulation/joints/axle_fl_b/parent") == "body_b"
    assert _spec(yard, "/simulation/joints/axle_fl_b/axis") == pytest.approx([-1, 0, 0], abs=1e-8)
    table = yard.call(
        "place_object", world="w", entity="table", on="ground", beside={"entity": "body_b", "side": "left", "gap": 0.4}
    )
    assert table["static_passed"]
    # The ends of the axles are nearest, 0.075 m past the corners of the table.
    assert table["pose"]["position"][:2] == pytest.approx([1.0 - 0.459 - np.sqrt(0.4**2 - 0.075**2) - 0.6, 2.5], abs=1e-5)

    roll = _spec(yard, "/story/beats/roll")
    second = {**roll, "owner": "drive_br_b", "subject": "wheel_fr_b", "predicate": {**roll["predicate"], "entity": "wheel_fr_b"}}
    yard.edit(("/story/beats/roll_b", second), ("/shots/all/covers", ["roll", "roll_b"]))
    probe = yard.call("probe_sim", world="w")
    assert probe["passed"], probe["open_rows"]
    first, second = (yard.call("inspect_world", world="w", part="row", row=f"beat:{b}")["row"] for b in ("roll", "roll_b"))
    assert second["measured"] == pytest.approx(first["measured"], rel=0.01), "the copy rolls as the original does"


def test_a_group_moves_as_one_change_after_a_failure(yard: Any) -> None:
    """Poses, anchors and velocities are three groups of parameters to edit_spec, and one move here."""
    scene = (Correction(cause="c", edit_class="scene", group="placement", action="a"),)
    row = Row(id="beat:roll", check="beat", group="physical", predicate="p", status="fail", artifact="x", corrections=scene)
    Ledger(yard.workspace / "w" / "ledger.sqlite").put_rows([row], revision=1, stage="probe")
    move = {"entity": "body", "group": WHEELS, "at": [0.5, 0.5], "yaw_deg": 45}
    assert "hypothesis" in yard.refused("place_object", world="w", **move)
    done = yard.call("place_object", world="w", **move, hypothesis=WHY)
    assert done["groups"] == ["joints", "placement"]
    (tried,) = yard.call("inspect_world", world="w", part="iterations")["iterations"]
    assert tried["grp"] == "placement"
    patch = [
        {"op": "replace", "path": "/entities/body/pose/position/0", "value": 0.0},
        {"op": "replace", "path": "/simulation/joints/axle_fl/anchor/0", "value": 0.0},
    ]
    assert "2 causal parameter groups" in yard.refused("edit_spec", world="w", patch=patch, hypothesis=WHY)


def test_an_array_made_anew_after_a_failure_is_one_change(yard: Any) -> None:
    """Other sizes and other places of the same stones: the shape is what changes, and where they lie goes along."""
    call = {"world": "w", "entity": "stone", "on": "ground", "lay": True}
    yard.call("place_object", **call, array=STONES)
    scene = (Correction(cause="c", edit_class="scene", group="shape", action="a"),)
    row = Row(id="beat:roll", check="beat", group="physical", predicate="p", status="fail", artifact="x", corrections=scene)
    Ledger(yard.workspace / "w" / "ledger.sqlite").put_rows([row], revision=2, stage="probe")
    yard.call("place_object", **call, array={**STONES, "seed": 6}, hypothesis="smaller stones leave the cart more room to roll")
    (tried,) = yard.call("inspect_world", world="w", part="iterations")["iterations"]
    assert tried["grp"] == "shape"


def test_one_of_many_things_is_put_afloat(agent: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    run_jobs_inline(monkeypatch)
    depth = 0.15
    spec = tank_spec(spacing=0.03, depth=depth, frames=24, closed=True, crate_at=LINER + depth + CRATE / 2)
    agent.call("edit_spec", world="w", prompt=TANK, spec=spec)
    agent.call("place_object", world="w", things=[{"entity": "crate", "afloat": "water"}])
    told = agent.call("inspect_world", world="w", part="spec", pointer="/entities/crate/pose/position")
    assert told["value"] == pytest.approx([0, 0, LINER + depth], abs=1e-6)


def test_a_crate_of_half_the_density_is_put_at_its_float_line(agent: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    run_jobs_inline(monkeypatch)
    depth = 0.15
    spec = tank_spec(spacing=0.03, depth=depth, frames=24, closed=True, crate_at=LINER + depth + CRATE / 2)
    assert agent.call("edit_spec", world="w", prompt=TANK, spec=spec)["audit"]["passed"]
    put = agent.call("place_object", world="w", entity="crate", afloat="water")
    assert put["static_passed"], put["open_rows"]
    assert put["pose"]["position"] == pytest.approx([0, 0, LINER + depth], abs=1e-6)
    told = put["afloat"]
    assert (told["draught"], told["freeboard"]) == pytest.approx((CRATE / 2, CRATE / 2), abs=1e-4)
    assert told["mass"] == pytest.approx(500 * CRATE**3)
    assert "is not at x, y" in agent.refused("place_object", world="w", entity="crate", afloat="water", at=[5.0, 0.0])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"entity": "stone", "at": [3, 3], "on": "ground"}, "would overlap"),
        ({"entity": "stone", "at": [0, 0], "beside": {"entity": "table", "side": "+x"}}, "both say where"),
        ({"entity": "stone", "beside": {"entity": "stone", "side": "+x"}}, "cannot stand beside itself"),
        ({"entity": "stone", "beside": {"entity": "tabel", "side": "+x"}}, "did you mean 'table'"),
        ({"entity": "stone", "tilt": True}, "tilt needs on"),
        ({"entity": "stone", "copy": ""}, "suffix"),
        ({"entity": "stone", "copy": "_b", "array": STONES}, "one of them"),
        ({"entity": "stone", "array": {"kind": "scatter"}}, "needs polygon"),
        ({"entity": "stone", "array": {"kind": "circle", "count": 3}}, "needs center"),
        ({"entity": "stone", "array": {"kind": "grid", "counts": [1, 1]}}, "2 to 500"),
        ({"entity": "stone", "array": {**STONES, "size": [2, 1]}}, "least factor comes first"),
        ({"entity": "stone", "afloat": "ground"}, "no liquid"),
        ({"entity": "stone", "river": {"reach": 0, "station": 1}}, "give river.terrain"),
        ({"array": STONES}, "need entity"),
        ({"entity": "stone", "array": {**STONES, "count": 501}}, "500"),
    ],
)
def test_what_cannot_be_placed_is_refused_with_the_next_step(yard: Any, arguments: dict[str, Any], words: str) -> None:
    assert words in yard.refused("place_object", world="w", **arguments)


def test_what_only_grazes_is_told_how_far_to_move(yard: Any) -> None:
    """A clock 0.2 mm in its wall was told to choose another place; what it needed was 0.4 mm."""
    beside = {"entity": "table", "side": "+x", "gap": 0.001}
    x, y, _ = yard.call("place_object", world="w", entity="stone", on="ground", beside=beside)["pose"]["position"]
    told = yard.refused("place_object", world="w", entity="stone", on="ground", at=[x - 0.004, y])
    assert "m away from it is enough" in told
    away = float(told.split(" m away from it")[0].rsplit(" ", 1)[1])
    assert 0.001 < away < 0.005
    yard.call("place_object", world="w", entity="stone", on="ground", at=[x - 0.004 + away, y])
