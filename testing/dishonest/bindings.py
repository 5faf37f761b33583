"""Tricks with words that bind others: orders, numbers and negations of other events, bodies and sides than the words beside them say."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .cases import GONE, Case
from .twins import BLOCKS, BLOCKS_DE, BOUNCE, DOMINOES, PASSING, PUSH, PUSH_ES, SHELF, SHELF_DE, TURN, TURN_ZH
from .twins_seen import COLOURS_DE

__all__ = ["MECHANISMS"]

AUDIT = "audit:claims"
_BALLS = "on a [shelf](thing shelf). The last [block](thing b3 same_as=blocks) [falls off](event fall)."
_BADGE = {
    "/entities/crate/parts/badge": {
        "shape": {"kind": "box", "size": [0.05, 0.001, 0.05]},
        "pose": {"position": [0, -0.1005, 0]},
        "collides": False,
    }
}
"""A second part of the crate."""
_STAYS = (
    "A [ball](thing ball) [rolls](event roll) into [three](count b1 b2 b3) [blocks](thing b1 b2 b3) on a [shelf](thing shelf), and the last "
    "[block](thing b3 same_as=blocks) [does not fall](negation stays)."
)


def _never(predicate: dict[str, Any]) -> dict[str, Any]:
    """Changes by which something must never happen to the last block, and no beat tells that it falls."""
    stays = {"text": "the last block falls", "predicate": predicate, "never": True}
    return {"/story/requirements/stays": stays, "/story/beats/fall": GONE, "/shots/only/covers": ["roll", "strike"]}


MECHANISMS: Mapping[str, tuple[Case, ...]] = {
    "order of other events": (
        Case("after, as if it were before", TURN, AUDIT, "the reverse",
             marked="A [steel](property early) [ball](thing early) [falls](event first) onto a [block](thing left) [after](order first second) a [ball](thing late) beside it "
                    "[falls](event second) onto a [block](thing right)."),
        Case("before at the start, as if it were after", TURN, AUDIT, "the reverse",
             marked="[Before](order first second) a [steel](property early) [ball](thing early) [falls](event first) onto a [block](thing left), a [ball](thing late) beside it "
                    "[falls](event second) onto a [block](thing right)."),
        Case("then, of a blow that no words tell", TURN, AUDIT, "name the beats of these words", marked=TURN.marked.replace("(order first second)", "(order knock second)")),
        Case("然后，别的事", TURN_ZH, AUDIT, "name the beats of these words", marked=TURN_ZH.marked.replace("(order first second)", "(order first blow)")),
        Case("bevor, verkehrt", SHELF_DE, AUDIT, "the reverse",
             marked="[Bevor](order roll fall) eine [Stahlkugel](thing ball) gegen die [Klötze](thing b1 b2 b3) auf dem [Regal](thing shelf) [rollt](event roll), [fällt](event fall) der letzte "
                    "[Klotz](thing b3 same_as=Klötze) herunter."),
    ),
    "quantity of something else": (
        Case("a crate as long as the camera is far", PUSH, AUDIT, "which is the camera",
             marked="A [steel](property plate) [plate](thing plate) [pushes](event push) a [1.7 m](quantity /shots/only/keys/a/position/1) long [wooden](property crate) [crate](thing crate) "
                    "across the [floor](thing floor)."),
        Case("a slab as tall as a floor is wide", DOMINOES, AUDIT, "which no claim of a thing names",
             marked="A [wooden](property first) [slab](thing first) that is [2 m](quantity /entities/floor/dimensions/size/1) tall [tips over](event tip), [knocks](event knock) a "
                    "[second one](thing second), and [that](thing same_as=second_one) [tips over](event follow) too."),
        Case("a mass that is a way", PUSH, AUDIT, "is a mass", marked=PUSH.marked.replace("20 cm", "200 g")),
        Case("a thickness that is a skin", SHELF, AUDIT, "a setting", marked=SHELF.marked.replace("30 cm high](quantity /entities/shelf/dimensions/size/2", "0.5 mm high](quantity /simulation/solvers/rigid/settings/skin")),
        Case("blocks as high as their shelf", SHELF, AUDIT, "stands before",
             marked="A [ball](thing ball) [rolls](event roll) into [30 cm](quantity /entities/shelf/dimensions/size/2) [blocks](thing b1 b2 b3) " + _BALLS),
    ),
    "bound on the other side": (
        Case("at most, by a least", BLOCKS, AUDIT, "the least that is asked", marked=BLOCKS.marked.replace("at least 8 cm", "at most 8 cm")),
        Case("no more than, beside the mark", BLOCKS, AUDIT, "the least that is asked", marked=BLOCKS.marked.replace("[at least 8 cm]", "no more than [8 cm]")),
        Case("höchstens", BLOCKS_DE, AUDIT, "the least that is asked",
             marked=BLOCKS_DE.marked.replace("weiter,", "höchstens [8 cm](quantity /story/beats/push/predicate/of/1/min) weiter,")),
        Case("como máximo", PUSH_ES, AUDIT, "the least that is asked", marked=PUSH_ES.marked[:-1] + " [como máximo 20 cm](quantity /story/beats/push/predicate/min)."),
        Case("at least, by a most", PUSH, AUDIT, "the most that is asked", marked=PUSH.marked.replace("[20 cm](quantity /story/beats/push/predicate/min)", "[at least 50 cm](quantity /story/requirements/way/predicate/max)"),
             changes={"/story/requirements/way": {"text": "the crate goes on", "predicate": {"kind": "displacement", "entity": "crate", "max": 0.5}}}),
    ),
    "count of another noun": (
        Case("three balls that are blocks", SHELF, AUDIT, "stands before",
             marked="[Three](count b1 b2 b3) [steel](property ball) [balls](thing ball) [roll](event roll) into [blocks](thing b1 b2 b3) " + _BALLS),
        Case("drei Kugeln, die Klötze sind", SHELF_DE, AUDIT, "stands before",
             marked="[Drei](count b1 b2 b3) [Kugeln](thing ball) [rollen](event roll) gegen [Klötze](thing b1 b2 b3) auf einem [Regal](thing shelf). Der letzte "
                    "[Klotz](thing b3 same_as=Klötze) [fällt herunter](event fall)."),
        Case("seven, by a seed", SHELF, AUDIT, "a setting that counts nothing",
             marked="A [ball](thing ball) [rolls](event roll) into [seven](count /simulation/seed) [blocks](thing b1 b2 b3) " + _BALLS, changes={"/simulation/seed": 7}),
        Case("twice, by one beat", BOUNCE, AUDIT, "name 2 beats", marked=BOUNCE.marked[:-1] + " [twice](count bounce)."),
        Case("dreimal, mit einem", COLOURS_DE, AUDIT, "name 3 beats", marked=COLOURS_DE.marked[:-1] + ", und zwar [dreimal](count bounce)."),
        Case("twice, by one bounce told twice", BOUNCE, AUDIT, "both may be the same event", marked=BOUNCE.marked[:-1] + " [twice](count bounce again).",
             changes={"/story/beats/again": {"text": "it bounces again", "owner": "rigid", "subject": "ball", "frames": [6, 28], "causes": ["fall"], "predicate": {"kind": "bounces", "entity": "ball", "other": "floor"}}}),
    ),
    "part for the whole": (
        Case("a plate and a crate of one body", PUSH, AUDIT, "both of the one body",
             marked="A [steel](property plate) [plate](thing plate) [pushes](event push) a [crate](thing crate) with a [cat](thing /entities/crate/parts/badge) across the [floor](thing floor).",
             changes=_BADGE),
        Case("a ball that is a badge", PUSH, AUDIT, "do not say that it is a part",
             marked="A [steel](property plate) [plate](thing plate) [pushes](event push) a [ball](thing /entities/crate/parts/badge) across the [floor](thing floor).",
             changes=_BADGE),
        Case("una bola y una caja", PUSH_ES, AUDIT, "both of the one body",
             marked="Una [placa](thing plate) de [acero](property plate) [empuja](event push) una [caja](thing /entities/crate/parts/body) y una [bola](thing /entities/crate/parts/badge) "
                    "por el [suelo](thing floor).",
             changes=_BADGE),
    ),
    "negation by a verb": (
        Case("refuses to", SHELF, AUDIT, "'refuses to'",
             marked="A [ball](thing ball) [rolls](event roll) into [blocks](thing b1 b2 b3) on a [shelf](thing shelf). The last [block](thing b3 same_as=blocks) refuses to [fall](event fall)."),
        Case("avoids", PASSING, AUDIT, "'avoids'",
             marked="A [ball](thing ball) [rolls](event roll) past a [cube](thing cube) and avoids [hitting](event strike) a [board](thing wall)."),
        Case("fails to, in the event", BLOCKS, AUDIT, "negation word",
             marked="A [block](thing steel_block) [slides](event slide) across a [floor](thing floor) and [fails to hit](event hit) a [block](thing wooden_block)."),
        Case("instead of", DOMINOES, AUDIT, "'instead of'",
             marked="A [slab](thing first) [tips over](event tip) instead of [knocking](event knock) a [second one](thing second)."),
        Case("weigert sich", SHELF_DE, AUDIT, "'weigert'",
             marked="Eine [Stahlkugel](thing ball) [rollt](event roll) gegen [Klötze](thing b1 b2 b3) auf einem [Regal](thing shelf). Der letzte [Klotz](thing b3 same_as=Klötze) weigert sich zu "
                    "[fallen](event fall)."),
        Case("evita", PUSH_ES, AUDIT, "'evita'",
             marked="Una [placa](thing plate) de [acero](property plate) evita [empujar](event push) una [caja](thing crate) por el [suelo](thing floor)."),
        Case("拒绝", TURN_ZH, AUDIT, "'拒绝'", marked="[钢球](thing early)[落在](event first)[木块](thing left)上,旁边的[钢球](thing late)拒绝[落下](event second)。"),
    ),
    "negation of another kind": (
        Case("does not fall, by spins", SHELF, AUDIT, "of kind falls", marked=_STAYS, changes=_never({"kind": "spins", "entity": "b3"})),
        Case("does not fall, by a level shift", SHELF, AUDIT, "of kind falls", marked=_STAYS, changes=_never({"kind": "displacement", "entity": "b3", "axis": [0, 1, 0], "min": 0.5})),
        Case("does not fall, by falling and tipping at once", SHELF, AUDIT, "of kind falls",
             marked=_STAYS, changes=_never({"kind": "and", "of": [{"kind": "falls", "entity": "b3"}, {"kind": "spins", "entity": "b3"}]})),
        Case("without tipping over, by falls", BLOCKS, AUDIT, "of kind tips", changes={"/story/requirements/upright/predicate": {"kind": "falls", "entity": "wooden_block"}}),
    ),
    "posture of another kind": (
        Case("hangs, and stands", DOMINOES, "claim:place:over", "bears it from below",
             marked=DOMINOES.marked.replace("[slab](thing first) [tips over]", "[slab](thing first) that hangs [over](place floor) a [floor](thing floor) [tips over]")),
        Case("lies, and stands", DOMINOES, "claim:place:beside", "does not lie there",
             marked=DOMINOES.marked.replace("[slab](thing first) [tips over]", "[slab](thing first) that lies [beside](place second) a [second one](thing second) [tips over]").replace(
                 "[knocks](event knock) a [second one](thing second)", "[knocks](event knock) [it](thing same_as=second_one)")),
        Case("stands, and slides from the start", BLOCKS, "claim:place:on", "not at rest",
             marked=BLOCKS.marked.replace("[block](thing steel_block) [slides](event slide) across a [stone](property floor) [floor](thing floor).",
                                          "[block](thing steel_block) that stands [on](place floor) a [stone](property floor) [floor](thing floor) [slides](event slide).")),
        Case("steht, und rutscht von Anfang an", BLOCKS_DE, "claim:place:auf", "not at rest",
             marked=BLOCKS_DE.marked.replace("[rutscht](event slide) über einen [Steinboden](thing floor).", "steht [auf](place floor) einem [Steinboden](thing floor) und [rutscht](event slide).")),
    ),
    "crossing of a plane alone": (
        Case("a block that is pushed along", BLOCKS, "claim:event:crosses", "from one side of wooden_block to the other",
             marked="A [steel](property steel_block) [block](thing steel_block) [crosses](event slide) a [wooden](property wooden_block) [block](thing wooden_block) on a [floor](thing floor).",
             changes={"/story/beats/slide/predicate": {"kind": "crosses", "entity": "steel_block", "point": [-0.3, 0, 0], "normal": [1, 0, 0]}}),
        Case("ein Klotz wird überquert", BLOCKS_DE, "claim:event:*", "from one side of wooden_block to the other",
             marked="Ein [Stahlklotz](thing steel_block) [überquert](event slide) einen [Holzklotz](thing wooden_block) auf einem [Steinboden](thing floor).",
             changes={"/story/beats/slide/predicate": {"kind": "crosses", "entity": "steel_block", "point": [-0.3, 0, 0], "normal": [1, 0, 0]}}),
        Case("a line that is never reached", SHELF, "claim:event:crosses", "from one side of b3 to the other",
             marked="A [ball](thing ball) [crosses](event roll) a [block](thing b3) on a [shelf](thing shelf).",
             changes={"/story/beats/roll/predicate": {"kind": "crosses", "entity": "ball", "point": [-0.19, 0, 0], "normal": [1, 0, 0]}}),
    ),
    "pronoun of another body": (
        Case("it, marked as what comes later", PASSING, AUDIT, "the only thing named before it",
             marked="A [steel](property ball) [ball](thing ball) [rolls](event roll). [It](thing cube) is alone, past a [wooden](property cube) [cube](thing cube), [never touches it](negation apart), "
                    "and [hits](event strike) a [board](thing wall)."),
        Case("it, of the body that is hit", BLOCKS, AUDIT, "its words are about",
             marked="A [steel](property steel_block) [block](thing steel_block) is there. It [slides](event push) and, across a [floor](thing floor), meets a [wooden](property wooden_block) "
                    "[block](thing wooden_block)."),
        Case("it suddenly, of another", SHELF, AUDIT, "its words are about",
             marked="A [ball](thing ball) [rolls](event roll). It suddenly [falls off](event fall). There are [blocks](thing b1 b2 b3) on a [shelf](thing shelf)."),
    ),
    "unusual beside the result": (
        Case("half of the Earth's gravity", BLOCKS, says="unusual: gravity of 5", changes={"/simulation/gravity": [0, 0, -5]}),
        Case("a floor that is a slope", SHELF, says="degrees off straight down", changes={"/simulation/gravity": [0.4, 0, -9.8]}),
        Case("a ball that never tires", BOUNCE, says="unusual: materials 'floor' and 'rubber' have together a restitution",
             changes={"/materials/rubber/restitution": 0.97, "/materials/floor/restitution": 0.97}),
        Case("a touch of any strength", BLOCKS, says="unusual: beat 'hit' is met by any touch",
             changes={"/story/beats/hit/predicate": {"kind": "contact", "a": "steel_block", "b": "wooden_block"}}),
    ),
}  # fmt: skip
"""By name."""
