"""Honest worlds: a scene with a prompt that is true of it, marked, in several languages."""

from __future__ import annotations

from . import scenes
from .cases import Twin

__all__ = [
    "BLOCKS", "BLOCKS_DE", "BOUNCE", "DOMINOES", "LIFT", "PASSING", "PASSING_FR", "PUSH", "PUSH_ES", "SHELF", "SHELF_DE", "TURN", "TURN_ZH",
]  # fmt: skip

BLOCKS = Twin(
    "blocks",
    scenes.blocks,
    "A [steel](property steel_block) [block](thing steel_block) [slides](event slide) across a [stone](property floor) [floor](thing floor). "
    "[It](thing same_as=block) [hits](event hit) a [wooden](property wooden_block) [block](thing wooden_block), and [that](thing same_as=block_2) "
    "[slides](event push) [at least 8 cm](quantity /story/beats/push/predicate/of/1/min) [without tipping over](negation upright).",
    {
        "/story/requirements/upright": {
            "text": "the wooden block tips",
            "predicate": {"kind": "tips", "entity": "wooden_block"},
            "never": True,
        }
    },
)
BLOCKS_DE = Twin(
    "blocks_de",
    scenes.blocks,
    "Ein [Stahlklotz](thing steel_block) [rutscht](event slide) über einen [Steinboden](thing floor). [Er](thing same_as=stahlklotz) "
    "[trifft](event hit) einen [Holzklotz](thing wooden_block), und [der](thing same_as=holzklotz) [rutscht](event push) weiter, "
    "[ohne zu kippen](negation upright).",
    BLOCKS.changes,
)
SHELF = Twin(
    "shelf",
    scenes.shelf,
    "A [steel](property ball) [ball](thing ball) [rolls](event roll) into [three](count b1 b2 b3) [wooden](property b1) [blocks](thing b1 b2 b3) on a "
    "[shelf](thing shelf) that is [30 cm high](quantity /entities/shelf/dimensions/size/2). The last [block](thing b3 same_as=blocks) "
    "[falls off](event fall).",
)
SHELF_DE = Twin(
    "shelf_de",
    scenes.shelf,
    "Eine [Stahlkugel](thing ball) [rollt](event roll) gegen [drei](count b1 b2 b3) [Klötze](thing b1 b2 b3) auf einem [Regal](thing shelf). "
    "Der letzte [Klotz](thing b3 same_as=Klötze) [fällt herunter](event fall).",
)
PASSING = Twin(
    "passing",
    scenes.passing,
    "A [steel](property ball) [ball](thing ball) [rolls](event roll) past a [wooden](property cube) [cube](thing cube), "
    "[never touches it](negation apart), and [hits](event strike) a [board](thing wall).",
    {
        "/story/requirements/apart": {
            "text": "the ball touches the cube",
            "predicate": {"kind": "contact", "a": "ball", "b": "cube"},
            "never": True,
        }
    },
)
PASSING_FR = Twin(
    "passing_fr",
    scenes.passing,
    "Une [bille](thing ball) d'[acier](property ball) [roule](event roll) à côté d'un [cube](thing cube) de [bois](property cube) "
    "[sans jamais le toucher](negation apart) et [heurte](event strike) une [planche](thing wall).",
    PASSING.changes,
)
PUSH = Twin(
    "push",
    scenes.push,
    "A [steel](property plate) [plate](thing plate) [pushes](event push) a [wooden](property crate) [crate](thing crate) "
    "[20 cm](quantity /story/beats/push/predicate/min) across the [floor](thing floor).",
)
PUSH_ES = Twin(
    "push_es",
    scenes.push,
    "Una [placa](thing plate) de [acero](property plate) [empuja](event push) una [caja](thing crate) de [madera](property crate) "
    "por el [suelo](thing floor).",
)
DOMINOES = Twin(
    "dominoes",
    scenes.dominoes,
    "A [wooden](property first) [slab](thing first) [tips over](event tip), [knocks](event knock) a [second one](thing second), "
    "and [that](thing same_as=second_one) [tips over](event follow) too.",
)
BOUNCE = Twin(
    "bounce",
    scenes.bounce,
    "A [rubber](property ball) [ball](thing ball) [falls](event fall) onto a [stone](property floor) [floor](thing floor) and "
    "[bounces](event bounce).",
)
LIFT = Twin(
    "lift",
    scenes.lift,
    "A [steel](property platform) [platform](thing platform) [lifts](event lift) a [wooden](property beam) [beam](thing beam) off "
    "[two](count left_post right_post) [posts](thing left_post right_post).",
)
TURN = Twin(
    "turn",
    scenes.in_turn,
    "A [steel](property early) [ball](thing early) [falls](event first) onto a [wooden](property left) [block](thing left), "
    "[then](order first second) a [steel](property late) [ball](thing late) beside it [falls](event second) onto a [block](thing right).",
)
TURN_ZH = Twin(
    "turn_zh",
    scenes.in_turn,
    "[钢球](thing early)[落在](event first)[木块](thing left)上,[然后](order first second)旁边的[钢球](thing late)[落下](event second)。",
)
