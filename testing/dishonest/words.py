"""Tricks with the words of the prompt: what nobody understands, what nobody claims, and letters that look like others."""

from __future__ import annotations

from collections.abc import Mapping

from .cases import Case
from .twins import BLOCKS, BLOCKS_DE, BOUNCE, DOMINOES, LIFT, PASSING, PASSING_FR, PUSH, PUSH_ES, SHELF, SHELF_DE, TURN, TURN_ZH

__all__ = ["MECHANISMS"]

AUDIT = "audit:claims"

MECHANISMS: Mapping[str, tuple[Case, ...]] = {
    "stranger's prompt": (
        Case("the pond in English", BLOCKS, prompt="An anvil floats on a pond.", says="the marked text without its marks is not the prompt"),
        Case("a pond in German, no claims", BLOCKS_DE, AUDIT, "no claim says which words", prompt="Ein Amboss schwimmt auf einem Teich.", marked=""),
        Case("no claims, in Chinese", TURN_ZH, AUDIT, "no claim says which words", prompt="铁砧漂在池塘上。", marked=""),
        Case("a pond in Russian, no claims", PUSH, AUDIT, "no claim says which words", prompt="Наковальня плавает в пруду.", marked=""),
        Case("claims of the old prompt under a new one", SHELF, AUDIT, "quote", prompt="A steel kettle boils over on a gas stove.", marked="",
             changes={"/claims": {"a": {"quote": "ball", "type": "thing", "by": ["/entities/ball"]}, "b": {"quote": "falls off", "type": "event", "by": ["/story/beats/fall"]}}}),
    ),
    "language without lists": (
        Case("a negation in Polish", BLOCKS, says="the language is none with reviewed word lists",
             marked="Stalowy [klocek](thing steel_block) [ślizga się](event slide) po [podłodze](thing floor) i nie [uderza](event hit) w "
                    "drewniany [klocek](thing wooden_block), który wcale się nie [przesuwa](event push)."),
        Case("a number in Finnish", SHELF, says="the language is none with reviewed word lists",
             marked="[Teräskuula](thing ball) [vierii](event roll) kohti viittä [palikkaa](thing b1 b2 b3), ja viimeinen [putoaa](event fall) [hyllyltä](thing shelf)."),
        Case("a negation in Turkish", PUSH, says="the language is none with reviewed word lists",
             marked="Çelik [levha](thing plate) tahta [sandığı](thing crate) [yerde](thing floor) asla [itmez](event push)."),
        Case("a negation in German in an English prompt", BLOCKS, says="mixed",
             marked="A [steel](property steel_block) [block](thing steel_block) [slides](event slide) across a [floor](thing floor) and [hits](event hit) a "
                    "[block](thing wooden_block). Der Klotz bewegt sich dabei aber überhaupt nicht von der Stelle."),
    ),
    "letters that look like others": (
        Case("a Cyrillic e in a negation", BLOCKS, says="'nеver'",
             marked="A [steel](property steel_block) [block](thing steel_block) nеver [slides](event slide) across a [floor](thing floor). [It](thing same_as=block) "
                    "[hits](event hit) a [block](thing wooden_block)."),
        Case("a zero-width space in a number", SHELF, says="at character",
             marked="A [steel](property ball) [ball](thing ball) [rolls](event roll) into s\u200beven [blocks](thing b1 b2 b3) on a [shelf](thing shelf). The last "
                    "[block](thing b3 same_as=blocks) [falls off](event fall)."),
        Case("a Greek o in not", PASSING, says="'nοt'",
             marked="A [steel](property ball) [ball](thing ball) [rolls](event roll) past a [wooden](property cube) [cube](thing cube) and does nοt [hit](event strike) a [board](thing wall)."),
        Case("a Cyrillic c in steel", PUSH, says="at character",
             marked="A [wооden](property plate) [plate](thing plate) [pushes](event push) a [wooden](property crate) [crate](thing crate) across the [floor](thing floor)."),
        Case("a soft hyphen in without", PUSH, says="at character",
             marked="A [steel](property plate) [plate](thing plate) [pushes](event push) a [crate](thing crate) across the [floor](thing floor) with\u00adout touching it."),
    ),
    "negation in filler": (
        Case("not", PASSING, AUDIT, "'not'",
             marked="A [ball](thing ball) [rolls](event roll) past a [cube](thing cube) and does not [hit](event strike) a [board](thing wall)."),
        Case("ohne", BLOCKS_DE, AUDIT, "'ohne'",
             marked="Ein [Stahlklotz](thing steel_block) [rutscht](event slide) über einen [Steinboden](thing floor), ohne den [Holzklotz](thing wooden_block) zu [treffen](event hit)."),
        Case("jamais", PASSING_FR, AUDIT, "jamais",
             marked="Une [bille](thing ball) [roule](event roll) à côté d'un [cube](thing cube) et ne [heurte](event strike) jamais la [planche](thing wall)."),
        Case("没有", TURN_ZH, AUDIT, "没",
             marked="[钢球](thing early)[落在](event first)[木块](thing left)上,旁边的[钢球](thing late)没有[落下](event second)。"),
        Case("nunca", PUSH_ES, AUDIT, "nunca",
             marked="Una [placa](thing plate) de [acero](property plate) nunca [empuja](event push) la [caja](thing crate) por el [suelo](thing floor)."),
        Case("in an event's own words", PUSH, AUDIT, "negation word",
             marked="A [plate](thing plate) [does not push](event push) the [crate](thing crate) across the [floor](thing floor)."),
    ),
    "number in filler": (
        Case("seven", SHELF, AUDIT, "'seven'",
             marked="A [ball](thing ball) [rolls](event roll) into seven [blocks](thing b1 b2 b3) on a [shelf](thing shelf). The last [block](thing b3 same_as=blocks) [falls off](event fall)."),
        Case("fünf", SHELF_DE, AUDIT, "fünf",
             marked="Eine [Stahlkugel](thing ball) [rollt](event roll) gegen fünf [Klötze](thing b1 b2 b3) auf einem [Regal](thing shelf). Der letzte [Klotz](thing b3 same_as=Klötze) [fällt herunter](event fall)."),
        Case("两米", TURN_ZH, AUDIT, "两",
             marked="[钢球](thing early)从两米高处[落在](event first)[木块](thing left)上,[然后](order first second)旁边的[钢球](thing late)[落下](event second)。"),
        Case("inside a thing", SHELF, AUDIT, "number word",
             marked="A [ball](thing ball) [rolls](event roll) into [nine blocks](thing b1 b2 b3) on a [shelf](thing shelf). The last [block](thing b3 same_as=nine_blocks) [falls off](event fall)."),
        Case("metres in an event", PUSH, AUDIT, "number word",
             marked="A [plate](thing plate) [pushes 3 m](event push) a [crate](thing crate) across the [floor](thing floor)."),
        Case("a dozen", LIFT, AUDIT, "dozen",
             marked="A [platform](thing platform) [lifts](event lift) a [beam](thing beam) off a dozen [posts](thing left_post right_post)."),
    ),
    "amount in filler": (
        Case("a pair that is one", PUSH, AUDIT, "says 2", marked=PUSH.marked.replace("a [wooden](property crate) [crate]", "a pair of [wooden](property crate) [crate]")),
        Case("a trio of one", PUSH, AUDIT, "says 3", marked=PUSH.marked.replace("A [steel]", "A trio of [steel]")),
        Case("a score of posts", LIFT, AUDIT, "says 20", marked=LIFT.marked.replace("[two](count left_post right_post) [posts]", "a score of [posts]")),
        Case("several", BLOCKS, AUDIT, "says at least 3", marked=BLOCKS.marked.replace("A [steel]", "Several [steel]")),
        Case("dozens, within a thing", SHELF, AUDIT, "says at least 24", marked=SHELF.marked.replace("[three](count b1 b2 b3) [wooden](property b1) [blocks]", "[dozens of blocks]").replace("same_as=blocks", "same_as=dozens_of_blocks")),
        Case("mehrere", BLOCKS_DE, AUDIT, "says at least 2", marked=BLOCKS_DE.marked.replace("einen [Holzklotz]", "mehrere [Holzklotz]")),
        Case("varias", PUSH_ES, AUDIT, "says at least 2", marked=PUSH_ES.marked.replace("una [caja]", "varias [caja]")),
        Case("both of one", BOUNCE, AUDIT, "says 2", marked=BOUNCE.marked.replace("A [rubber](property ball) [ball]", "Both [rubber](property ball) [ball]")),
        Case("a triple block", BLOCKS, says="'triple' says more than one", marked=BLOCKS.marked.replace("A [steel]", "A triple [steel]")),
    ),
    "event that does not happen": (
        Case("almost", BOUNCE, AUDIT, "does not happen", marked=BOUNCE.marked.replace("[bounces]", "almost [bounces]")),
        Case("all but, in its own words", PUSH, AUDIT, "does not happen", marked=PUSH.marked.replace("[pushes]", "[all but pushes]")),
        Case("would", BLOCKS, AUDIT, "does not happen", marked=BLOCKS.marked.replace("[hits]", "would [hit]")),
        Case("kept from", BLOCKS, AUDIT, "negation word", marked=BLOCKS.marked.replace("[hits](event hit)", "is kept from [hitting](event hit)")),
        Case("prevented from", PASSING, AUDIT, "negation word", marked=PASSING.marked.replace("and [hits](event strike)", "and is prevented from [hitting](event strike)")),
        Case("stops short of", PASSING, AUDIT, "negation word", marked=PASSING.marked.replace("and [hits](event strike)", "and stops short of [hitting](event strike)")),
        Case("too slow to", PASSING, AUDIT, "does not happen", marked=PASSING.marked.replace("and [hits](event strike)", "and is too slow to [hit](event strike)")),
        Case("seldom", DOMINOES, AUDIT, "negation word", marked=DOMINOES.marked.replace("[tips over](event follow)", "seldom [tips over](event follow)")),
        Case("beinahe", SHELF_DE, AUDIT, "does not happen", marked=SHELF_DE.marked.replace("[fällt herunter]", "beinahe [fällt herunter]").replace("Der letzte [Klotz](thing b3 same_as=Klötze) beinahe", "Der letzte [Klotz](thing b3 same_as=Klötze), der beinahe")),
        Case("might", BOUNCE, says="leaves open whether it happens", marked=BOUNCE.marked.replace("[bounces]", "might [bounce]")),
    ),
    "order in filler": (
        Case("after", TURN, AUDIT, "order word",
             marked="A [steel](property early) [ball](thing early) [falls](event first) onto a [block](thing left) after a [ball](thing late) beside it [falls](event second) onto a [block](thing right)."),
        Case("nachdem", SHELF_DE, AUDIT, "order word",
             marked="Eine [Stahlkugel](thing ball) [rollt](event roll), nachdem ein [Klotz](thing b3) vom [Regal](thing shelf) [gefallen ist](event fall)."),
        Case("然后", TURN_ZH, AUDIT, "order word",
             marked="[钢球](thing late)[落下](event second),然后旁边的[钢球](thing early)[落在](event first)[木块](thing left)上。"),
        Case("before", BLOCKS, AUDIT, "order word",
             marked="A [block](thing wooden_block) [slides](event push) over the [floor](thing floor) before a [block](thing steel_block) [hits](event hit) [it](thing same_as=block)."),
    ),
    "waived": (
        Case("a third of the prompt", PUSH, AUDIT, "are waived",
             marked="A [plate](thing plate) [pushes](event push) a [crate](thing crate) across the [floor](thing floor), [whereupon the crate bursts open](waived because=\"this is only decoration\")."),
        Case("everything but the things", BLOCKS, AUDIT, "are waived",
             marked="A [block](thing steel_block) [melts through a](waived because=\"no engine for it here\") [floor](thing floor) [and swallows another](waived because=\"no engine for it here\") [block](thing wooden_block)."),
        Case("a short one in print", SHELF, says="waived: gently: xxxxxxxxxx",
             marked=SHELF.marked.replace("[rolls](event roll) into", "[rolls](event roll) [gently](waived because=xxxxxxxxxx) into")),
        Case("the negation in print", PASSING, says="waived: never touches it",
             marked="A [steel](property ball) [ball](thing ball) [rolls](event roll) slowly past a [wooden](property cube) [cube](thing cube) on a stone floor in a large room, "
                    "[never touches it](waived because=\"too hard to judge\"), and [hits](event strike) a [board](thing wall) at the other end."),
    ),
    "filler in another script": (
        Case("a sentence in Arabic", PUSH, says="filler: ",
             marked=PUSH.marked + " ثم ينفجر الصندوق إلى قطع كثيرة."),
        Case("a sentence in Chinese", BOUNCE, says="filler: 然后球",
             marked=BOUNCE.marked + " 然后球变成一只猫。"),
        Case("a sentence in Russian", BLOCKS, says="filler: ", marked=BLOCKS.marked + " Потом блок взлетает в небо."),
        Case("a sentence in Hindi", LIFT, says="filler: ", marked=LIFT.marked + " फिर पूरा मकान गिर जाता है।"),
    ),
}  # fmt: skip
"""By name."""
