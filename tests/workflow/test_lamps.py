"""Lamps that follow from bulbs of generated things."""

from __future__ import annotations

from worldagent.testing.worlds import small_worlds as small
from worldagent.workflow.lamps import MOST, lamp_operations
from worldagent.worlds.patch import apply_patch
from worldagent.worlds.spec import Lamp, Look


def _spec(**lamps: Lamp):
    entities = {k: small.box(0.1, 0.1, 0.1, motion="static") for k in ("desk_lamp", "stool")}
    return small.world(entities, look=Look(lamps=lamps))


def _document(*parts: str) -> dict:
    return {"parts": {key: {} for key in parts}}


def test_each_bulb_becomes_a_lamp_and_nothing_else_does() -> None:
    operations = lamp_operations(_spec(), {"desk_lamp": _document("foot", "bulb"), "stool": _document("seat")})
    assert operations == [{"op": "add", "path": "/look/lamps/desk_lamp", "value": {"entity": "desk_lamp", "part": "bulb"}}]
    look = apply_patch(_spec(), operations).look
    assert (look.lamps["desk_lamp"].lumens, look.lamps["desk_lamp"].kelvin) == (806.0, 2700.0)


def test_a_thing_made_anew_keeps_the_light_that_was_set() -> None:
    spec = _spec(reading=Lamp(entity="desk_lamp", part="bulb", lumens=300.0))
    assert lamp_operations(spec, {"desk_lamp": _document("bulb")}, {"desk_lamp"}) == []


def test_a_thing_that_is_gone_takes_its_lamp_along() -> None:
    spec = _spec(reading=Lamp(entity="desk_lamp", part="bulb"))
    assert lamp_operations(spec, {}, {"desk_lamp"}) == [{"op": "remove", "path": "/look/lamps/reading"}]
    assert lamp_operations(spec, {"desk_lamp": _document("foot")}, {"desk_lamp"})[0]["op"] == "remove"


def test_no_more_lamps_are_lit_than_a_look_holds() -> None:
    many = {f"lamp{k}": _document("bulb") for k in range(MOST + 5)}
    assert len(lamp_operations(_spec(), many)) == MOST
