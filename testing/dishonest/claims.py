"""Tricks with what a claim is bound to: another body, another kind of event, another number, order or negation than the words say."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .cases import GONE, Case
from .scenes import ball, beat, block
from .twins import BLOCKS, BLOCKS_DE, BOUNCE, DOMINOES, LIFT, PASSING, PASSING_FR, PUSH, PUSH_ES, SHELF, SHELF_DE, TURN, TURN_ZH

__all__ = ["MECHANISMS"]

AUDIT = "audit:claims"
_EXTRA = "/simulation/solvers/rigid/members"


def _joined(twin_members: list[str], name: str, body: Any) -> dict[str, Any]:
    """Changes that add a body."""
    return {f"/entities/{name}": body, _EXTRA: [*twin_members, name]}


_SHELF = ["floor", "shelf", "ball", "b1", "b2", "b3"]
_PASSING = ["floor", "ball", "cube", "wall"]
_FOURTH = block("wooden block 4", "wood", (0.03, 0.05, 0.05), (-0.35, 0.1, 0.326))
_NEVER = "/story/requirements/"
_WOODEN = {"/entities/plate/material": "wood", "/materials/wood": {"density": 600, "substance": "wood"}}
_GOLD = PUSH.marked.replace("[steel](property plate)", "[gold](property plate)")
_STEEL_BADGE = {"/entities/plate/parts/badge": {"shape": {"kind": "box", "size": [0.001, 0.01, 0.01]}, "material": "steel"}}


def _never(text: str, predicate: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {"text": text, "predicate": predicate, "never": True, **more}


MECHANISMS: Mapping[str, tuple[Case, ...]] = {
    "claim of another body": (
        Case("two things, one body", BLOCKS, AUDIT, "are both", marked=BLOCKS.marked.replace("[block](thing wooden_block)", "[block](thing steel_block)")),
        Case("a wooden block that is the steel one", BLOCKS, AUDIT, "asks for wood",
             marked="A [wooden](property steel_block) [block](thing steel_block) [slides](event slide) across a [floor](thing floor) and [hits](event hit) a [block](thing wooden_block)."),
        Case("the ball is the board", PASSING, AUDIT, "asks for steel",
             marked="A [steel](property wall) [board](thing wall) [hits](event strike) a [ball](thing ball) beside a [cube](thing cube)."),
        Case("the doer is done to", BLOCKS, AUDIT, "its words say the reverse", changes={"/story/beats/hit/predicate": {"kind": "hits", "entity": "wooden_block", "other": "steel_block"}}),
        Case("the pushed one pushes, in Spanish", PUSH_ES, "*:push*", changes={"/story/beats/push/predicate": {"kind": "pushes", "entity": "crate", "other": "plate"}}),
        Case("an entity that is not there", SHELF, says="which is nothing in the specification", marked=SHELF.marked.replace("(thing shelf)", "(thing cupboard)")),
        Case("a thing that is a beat", TURN_ZH, AUDIT, "a claim of type thing", marked=TURN_ZH.marked.replace("(thing left)", "(thing /story/beats/knock)")),
        Case("an event of an unclaimed body", SHELF, AUDIT, "which no claim of a thing names",
             marked="A [steel](property ball) [ball](thing ball) [rolls](event roll) along a [shelf](thing shelf) and [falls off](event fall) it."),
    ),
    "event of another body": (
        Case("the fall is that of a pebble", SHELF, AUDIT, "which no claim of a thing names",
             changes=_joined(_SHELF, "pebble", ball("stone pebble", "stone", 0.02, (0.5, 0.4, 0.6))) | {"/story/beats/fall": beat("it falls", "pebble", (0, 22), {"kind": "falls", "entity": "pebble"})}),
        Case("the roll is that of the block", BLOCKS, AUDIT, "'slides' is told of 'floor'", changes={"/story/beats/slide/predicate": {"kind": "slides", "entity": "floor"}, "/story/beats/slide/subject": "floor"}),
        Case("the one that falls is the first", SHELF, "audit:claims|*:fall", changes={"/story/beats/fall/predicate/entity": "b1", "/story/beats/fall/subject": "b1"}),
        Case("the second ball's fall told of the first", TURN, "audit:story|*second*", changes={"/story/beats/second/predicate/entity": "early", "/story/beats/second/subject": "early"}),
        Case("the beam's lift told of a post", LIFT, "audit:claims|*lift*", changes={"/story/beats/lift/predicate/other": "left_post", "/story/beats/lift/subject": "left_post"}),
    ),
    "weaker kind of event": (
        Case("falls, by a level shift", BOUNCE, AUDIT, "no kind of event", changes={"/story/beats/fall/predicate": {"kind": "displacement", "entity": "ball", "min": 0.05}}),
        Case("rolls, by its speed", SHELF, AUDIT, "no kind of event", changes={"/story/beats/roll/predicate": {"kind": "speed", "entity": "ball", "min": 0.1}}),
        Case("pushes, by nearness", PUSH, AUDIT, "no kind of event", changes={"/story/beats/push/predicate": {"kind": "separation", "a": "plate", "b": "crate", "max": 0.01, "when": "eventually"}}),
        Case("topples, by a tilt", DOMINOES, AUDIT, "no kind of event", changes={"/story/beats/follow/predicate": {"kind": "tilts", "entity": "second", "min": 0.1}}),
        Case("fällt herunter, durch Abstand", SHELF_DE, AUDIT, "no kind of event", changes={"/story/beats/fall/predicate": {"kind": "displacement", "entity": "b3", "axis": [1, 0, 0], "min": 0.01}}),
        Case("lifts, by a place", LIFT, AUDIT, "no kind of event", changes={"/story/beats/lift/predicate": {"kind": "displacement", "entity": "beam", "axis": [0, 0, 1], "min": 0.1}}),
    ),
    "kind that does not fit the verb": (
        Case("floats, by sliding", BLOCKS, says="'floats'",
             marked="A [steel](property steel_block) [block](thing steel_block) [floats](event slide) across a [stone](property floor) [floor](thing floor). [It](thing same_as=block) [hits](event hit) a [block](thing wooden_block)."),
        Case("rolls, by sliding", BLOCKS, says="'rolls'",
             marked="A [steel](property steel_block) [block](thing steel_block) [rolls](event slide) across a [stone](property floor) [floor](thing floor). [It](thing same_as=block) [hits](event hit) a [block](thing wooden_block)."),
        Case("explodes, by bouncing", BOUNCE, says="'explodes'",
             marked="A [rubber](property ball) [ball](thing ball) [falls](event fall) onto a [stone](property floor) [floor](thing floor) and [explodes](event bounce)."),
        Case("throws, by pushing", PUSH, says="'throws'",
             marked="A [steel](property plate) [plate](thing plate) [throws](event push) a [wooden](property crate) [crate](thing crate) across the [floor](thing floor)."),
        Case("melts, by falling", TURN, says="'melts'",
             marked="A [steel](property early) [ball](thing early) [melts](event first) beside a [block](thing left), [then](order first second) a [ball](thing late) [falls](event second) onto a [block](thing right)."),
        Case("breaks, by tipping", DOMINOES, says="'breaks'",
             marked="A [wooden](property first) [slab](thing first) [tips over](event tip), [knocks](event knock) a [second one](thing second), and [that](thing same_as=second_one) [breaks](event follow) too."),
    ),
    "event marked as a thing": (
        Case("explodes", PUSH, says="'explodes'", marked=PUSH.marked[:-1] + ", which [explodes](thing crate same_as=crate)."),
        Case("burns", BLOCKS, says="'burns'", marked=BLOCKS.marked[:-1] + " and [burns](thing wooden_block same_as=block_2)."),
        Case("flies away", BOUNCE, says="'flies away'", marked=BOUNCE.marked[:-1] + " and [flies](thing ball same_as=ball) away."),
        Case("left in filler", LIFT, says="'breaks'", marked=LIFT.marked[:-1] + " and breaks it."),
    ),
    "label": (
        Case("an iron anvil of foam", PUSH, AUDIT, "asks for iron",
             marked="A [steel](property plate) [plate](thing plate) [pushes](event push) an [iron](property crate) [anvil](thing crate) across the [floor](thing floor).",
             changes={"/entities/crate/role": "iron anvil", "/entities/crate/material": "foam", "/materials/foam": {"density": 30, "substance": "foam", "appearance": {"color": [0.1, 0.1, 0.1]}}}),
        Case("iron by name alone", PUSH, "audit:density:iron", marked="A [steel](property plate) [plate](thing plate) [pushes](event push) an [iron](property crate) [anvil](thing crate) across the [floor](thing floor).",
             changes={"/entities/crate/material": "iron", "/materials/iron": {"density": 30, "substance": "iron", "appearance": {"color": [0.1, 0.1, 0.1]}}}),
        Case("ein Amboss aus Stahl ist aus Holz", BLOCKS_DE, AUDIT, "asks for steel",
             marked="Ein [Amboss](thing wooden_block) aus [Stahl](property wooden_block) [rutscht](event push), weil ein [Klotz](thing steel_block) auf dem [Boden](thing floor) ihn [trifft](event hit).",
             changes={"/entities/wooden_block/role": "Amboss aus Stahl"}),
        Case("a glass ball of rubber", BOUNCE, AUDIT, "asks for glass",
             marked="A [glass](property ball) [ball](thing ball) [falls](event fall) onto a [stone](property floor) [floor](thing floor) and [bounces](event bounce)."),
        Case("bronce", PUSH_ES, says="reading: bronce", marked="Una [placa](thing plate) de [bronce](property plate) [empuja](event push) una [caja](thing crate) por el [suelo](thing floor)."),
        Case("of substance other", PUSH, AUDIT, "asks for steel", changes={"/entities/plate/material": "stuff", "/materials/stuff": {"density": 100, "substance": "other"}}),
        Case("gold that weighs as wood", PUSH, AUDIT, "asks for gold", marked=_GOLD, changes={"/entities/plate/material": "stuff", "/materials/stuff": {"density": 500, "substance": "other"}}),
        Case("lead by name alone", PUSH, "audit:masses", "is called lead", changes={"/entities/plate/material": "lead", "/materials/lead": {"density": 500, "substance": "other"}}),
        Case("gold of wood", PUSH, says="'gold' is the name of a material", marked=_GOLD, changes=_WOODEN),
        Case("cork of stone", PUSH, AUDIT, "asks for cork", marked=PUSH.marked.replace("[steel](property plate)", "[cork](property plate)"), changes={"/entities/plate/material": "stone"}),
        Case("one part of steel", PUSH, AUDIT, "steel",
             changes=_WOODEN | _STEEL_BADGE),
        Case("a part of steel, named alone", PUSH, AUDIT, "asks for steel", marked=PUSH.marked.replace("(property plate)", "(property /entities/plate/parts/badge)"), changes=_WOODEN | _STEEL_BADGE),
        Case("the steel of another part", PUSH, AUDIT, "beside it is of wood", marked=PUSH.marked.replace("(property plate)", "(property /materials/steel)"), changes=_WOODEN | _STEEL_BADGE),
        Case("the steel of the floor", PUSH, AUDIT, "beside it is of wood", marked=PUSH.marked.replace("(property plate)", "(property floor)"), changes=_WOODEN | {"/entities/floor/material": "steel"}),
    ),
    "count": (
        Case("one too few", SHELF, AUDIT, "counts 3", marked=SHELF.marked.replace("(count b1 b2 b3)", "(count b1 b2)")),
        Case("five for three", SHELF, AUDIT, "counts 5", marked=SHELF.marked.replace("[three]", "[five]")),
        Case("cinco", PUSH_ES, AUDIT, "counts 5", marked="[Cinco](count plate) [placas](thing plate) de [acero](property plate) [empujan](event push) una [caja](thing crate) por el [suelo](thing floor)."),
        Case("a fourth one of the same make", SHELF, AUDIT, "same shape and material", changes=_joined(_SHELF, "b4", _FOURTH)),
        Case("a fourth one a hair larger", SHELF, "audit:claims|claim:count:*", "b4", changes=_joined(_SHELF, "b4", _FOURTH | {"parts": {"body": {"shape": {"kind": "box", "size": [0.0301, 0.05, 0.05]}}}})),
        Case("parts of one body", SHELF, AUDIT, "a part of one body", marked=SHELF.marked.replace("(count b1 b2 b3)", "(count /entities/b1/parts/body /entities/b1 /entities/b2)")),
        Case("the floor is one of them", SHELF, "audit:claims|claim:count:*", "floor", marked=SHELF.marked.replace("(count b1 b2 b3)", "(count b1 b2 floor)")),
        Case("a number that happens to be three", SHELF, AUDIT, "three", marked=SHELF.marked.replace("(count b1 b2 b3)", "(count /entities/floor/dimensions/size/0)").replace("[three]", "[three]"), changes={"/entities/b1/role": "block"}),
        Case("drei, nur zwei fallen", SHELF_DE, AUDIT, "is told of", marked="Eine [Stahlkugel](thing ball) [rollt](event roll) gegen [drei](count b1 b2 b3) [Klötze](thing b1 b2 b3) auf einem [Regal](thing shelf). Alle [fallen herunter](event fall)."),
    ),
    "quantity": (
        Case("twice", BLOCKS, AUDIT, "says at least 0.16", marked=BLOCKS.marked.replace("8 cm", "16 cm")),
        Case("half the shelf", SHELF, AUDIT, "is 0.3", marked=SHELF.marked.replace("30 cm", "60 cm")),
        Case("millimetres", PUSH, AUDIT, "is 0.2", marked=PUSH.marked.replace("20 cm", "20 mm")),
        Case("metres", PUSH, AUDIT, "is 0.2", marked=PUSH.marked.replace("20 cm", "20 m")),
        Case("inches", PUSH, AUDIT, "is 0.2", marked=PUSH.marked.replace("20 cm", "20 inches")),
        Case("zwei Meter", BLOCKS_DE, AUDIT, "is 0.08",
             marked=BLOCKS_DE.marked.replace("weiter,", "[zwei Meter weit](quantity /story/beats/push/predicate/of/1/min),")),
        Case("an unrelated number that is equal", SHELF, "audit:claims|claim:quantity:*", "30 cm high", marked=SHELF.marked.replace("/entities/shelf/dimensions/size/2", "/entities/shelf/dimensions/size/1")),
        Case("a bound on another body", PUSH, "audit:claims|claim:quantity:*", "20 cm", marked=PUSH.marked.replace("/story/beats/push/predicate/min", "/story/requirements/way/predicate/min"),
             changes={"/story/requirements/way": {"text": "the plate goes on", "predicate": {"kind": "displacement", "entity": "plate", "min": 0.2}}, "/story/beats/push/predicate/min": 0.06}),
        Case("angle of view for degrees", DOMINOES, "audit:claims|claim:quantity:*", "40 degrees", marked=DOMINOES.marked.replace("[tips over](event tip)", "[tips over](event tip) by [40 degrees](quantity /shots/only/keys/a/fov_deg)")),
        Case("within a tenth, by the time before it begins", BLOCKS, AUDIT, "name what says it of the world", marked=BLOCKS.marked.replace("[hits](event hit)", "[within 0.1 s](quantity /simulation/preroll) [hits](event hit)"), changes={"/simulation/preroll": 0.1}),
        Case("the weight of another", PUSH, AUDIT, "is of another", marked=PUSH.marked.replace("[plate](thing plate)", "[plate](thing plate) of [3 kg](quantity /entities/crate/physics/mass)"), changes={"/entities/crate/physics": {"category": "rigid", "mass": 3}}),
        Case("a distance by its own size", BLOCKS, AUDIT, "says how far", marked=BLOCKS.marked.replace("[block](thing wooden_block)", "[block](thing wooden_block) [10 cm](quantity /entities/wooden_block/dimensions/size/0) off")),
        Case("a whole minute of two seconds", PUSH, AUDIT, "says 60", marked=PUSH.marked.replace("A [steel]", "For [a whole minute](quantity /simulation/frames) a [steel]")),
        Case("half a minute in filler", BOUNCE, AUDIT, "'half a minute'", marked=BOUNCE.marked.replace("A [rubber]", "For half a minute a [rubber]")),
        Case("a name, not a number", PUSH, AUDIT, "is none", marked=PUSH.marked.replace("/story/beats/push/predicate/min", "/story/beats/push/predicate/kind")),
    ),
    "order": (
        Case("the beats exchanged", TURN, AUDIT, "the reverse", marked=TURN.marked.replace("(order first second)", "(order second first)")),
        Case("先后颠倒", TURN_ZH, AUDIT, "the reverse", marked=TURN_ZH.marked.replace("(order first second)", "(order second first)")),
        Case("let go at once", TURN, "claim:order:*", "comes true at frame",
             changes={"/simulation/drivers/latch_late/time": 0.125, "/story/beats/second/frames": [3, 12], "/story/beats/blow/frames": [5, 16]}),
        Case("the later one first", TURN, "claim:order:*", "comes true at frame",
             changes={"/simulation/drivers/latch_early/time": 1.0, "/story/beats/first/frames": [20, 32], "/story/beats/knock/frames": [24, 40], "/story/beats/second/frames": [16, 28]}),
        Case("one beat for both", TURN, AUDIT, "name two beats", marked=TURN.marked.replace("(order first second)", "(order first)")),
        Case("of other beats than the words", TURN, "audit:claims|claim:order:*|claim:event:*", marked=TURN.marked.replace("[falls](event first)", "[falls](event second)").replace("(event second) onto a [block](thing right)", "(event first) onto a [block](thing right)")),
    ),
    "negation": (
        Case("of another body", PASSING, "audit:claims|claim:negation:*", marked=PASSING.marked.replace("(negation apart)", "(negation other)"),
             changes={"/story/requirements/apart": GONE, "/story/requirements/other": _never("floor tips", {"kind": "contact", "a": "cube", "b": "wall"})}),
        Case("of what cannot happen", BLOCKS, "audit:claims|claim:negation:*", changes={"/story/requirements/upright": _never("the floor tips", {"kind": "tips", "entity": "floor"})}),
        Case("of an event out of reach", BLOCKS_DE, "audit:claims|audit:bounds|claim:negation:*", changes={"/story/requirements/upright": _never("it tips", {"kind": "tips", "entity": "wooden_block", "min": 3.0})}),
        Case("over frames before it happens", PASSING, AUDIT, "holds over all frames", changes={"/story/requirements/apart/frames": [0, 3]}),
        Case("optional, in French", PASSING_FR, AUDIT, "is optional", changes={"/story/requirements/apart/mandatory": False}),
        Case("without never", PASSING, AUDIT, "never: true", changes={"/story/requirements/apart/never": False}),
        Case("of a state", BLOCKS, AUDIT, "tells of a state", changes={"/story/requirements/upright/predicate": {"kind": "supported", "entity": "wooden_block"}}),
        Case("a contact all the same", PASSING, "claim:negation:*", "contact",
             changes={"/entities/cube/pose/position": [-0.05, 0.088, 0.051], "/graph/relations/ball_cube": {"kind": "interacts", "a": "ball", "b": "cube"}}),
        Case("la bille le touche", PASSING_FR, "claim:negation:*", "contact",
             changes={"/entities/cube/pose/position": [-0.05, 0.088, 0.051], "/graph/relations/ball_cube": {"kind": "interacts", "a": "ball", "b": "cube"}}),
        Case("the vase that does not fall, falls", SHELF, "claim:negation:*",
             marked="A [ball](thing ball) [rolls](event roll) into [three](count b1 b2 b3) [blocks](thing b1 b2 b3) on a [shelf](thing shelf), and the last [block](thing b3 same_as=blocks) [does not fall](negation stays).",
             changes={"/story/requirements/stays": _never("the last block falls", {"kind": "falls", "entity": "b3"}), "/story/beats/fall": GONE, "/shots/only/covers": ["roll", "strike"]}),
        Case("proved by another kind", SHELF, "audit:claims|claim:negation:*",
             marked="A [ball](thing ball) [rolls](event roll) into [three](count b1 b2 b3) [blocks](thing b1 b2 b3) on a [shelf](thing shelf), and the last [block](thing b3 same_as=blocks) [does not fall](negation stays).",
             changes={"/story/requirements/stays": _never("the last block spins", {"kind": "spins", "entity": "b3"}), "/story/beats/fall": GONE, "/shots/only/covers": ["roll", "strike"]}),
    ),
    "same_as": (
        Case("two balls are one", TURN, "audit:claims|claim:event:*", marked=TURN.marked.replace("a [steel](property late) [ball](thing late) beside it", "a [steel](property late) [ball](thing same_as=ball) beside it")),
        Case("the crate is the plate", PUSH, "audit:claims|claim:event:*", marked="A [steel](property plate) [plate](thing plate) [pushes](event push) a [crate](thing same_as=plate) across the [floor](thing floor)."),
        Case("most things are the same", BLOCKS, says="are said to be the same as another",
             marked="A [dog](thing steel_block), a [cat](thing same_as=dog), a [horse](thing same_as=dog) and a [cow](thing same_as=dog) [walk](event slide) over a [bridge](thing same_as=dog)."),
        Case("of another type", BLOCKS, AUDIT, "must be another claim of type", marked=BLOCKS.marked.replace("[slides](event push)", "[slides](event same_as=block)")),
        Case("names more than the other", SHELF, AUDIT, "which does not name", marked=SHELF.marked.replace("(thing b3 same_as=blocks)", "(thing ball same_as=blocks)")),
    ),
    "contradictory claims": (
        Case("slides and never slides", BLOCKS, "audit:claims|audit:contradictions|claim:*", marked=BLOCKS.marked.replace("[without tipping over](negation upright)", "[without sliding](negation upright)"),
             changes={"/story/requirements/upright": _never("it slides", {"kind": "slides", "entity": "wooden_block", "min": 5.0})}),
        Case("hits and never touches", PASSING, "claim:negation:*", "contact", changes={"/story/requirements/apart/predicate": {"kind": "contact", "a": "ball", "b": "wall"}}),
        Case("two heights of one shelf", SHELF, AUDIT, "says 0.9", marked=SHELF.marked.replace("[30 cm high]", "[30 cm high](quantity /entities/shelf/dimensions/size/2) and [90 cm high]")),
        Case("wooden and steel", BLOCKS, AUDIT, "asks for", marked=BLOCKS.marked.replace("a [wooden](property wooden_block) [block]", "a [wooden](property wooden_block) [steel](property wooden_block) [block]")),
    ),
}  # fmt: skip
"""By name."""
