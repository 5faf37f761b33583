"""Tricks with words that bind others: orders, numbers and negations of other events, bodies and sides than the words beside them say."""

from __future__ import annotations

from collections.abc import Mapping

from .cases import Case
from .twins import BLOCKS, BLOCKS_DE, BOUNCE, DOMINOES, PUSH, PUSH_ES, SHELF, SHELF_DE, TURN, TURN_ZH
from .twins_seen import COLOURS_DE

__all__ = ["MECHANISMS"]

AUDIT = "audit:claims"
_BALLS = "on a [shelf](thing shelf). The last [block](thing b3 same_as=blocks) [falls off](event fall)."

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
}  # fmt: skip
"""By name."""
