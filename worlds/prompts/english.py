"""Reviewed English words: closed classes that the labelling of a prompt needs, and shares of claim types where WordNet's old texts mislead."""

from __future__ import annotations

from .function_words import FUNCTION_WORDS

__all__ = [
    "AUXILIARIES", "BE", "CONJUNCTIONS", "DETERMINERS", "KINDS", "LOOK", "MADE_OF",
    "MATERIALS", "NUMBERS", "PARTICLES", "PHRASES", "POSTURES", "PREPOSITIONS", "PRONOUNS", "REQUESTS",
    "REVIEWED", "SHARES", "TIMES", "UNITS_OF_MEASURE", "WEATHER",
]  # fmt: skip


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


DETERMINERS = _words(
    "a an the this that these those its his her my your our their whose which what some any such each every both all another either"
)
PRONOUNS = _words(
    "i you he she it we they me him us them who whom this that these those itself himself herself themselves everything something anything "
    "one ones others nobody somebody someone everyone anybody there here how why where whatever whoever else"
)
BE = _words("be is are was were been being am 'm 's 're get gets got getting becomes start starts begin begins keep keeps stops")
AUXILIARIES = _words(
    "will would shall should can could may might must do does did to 'll 'd n't not never ought let lets please cannot ca wo"
)
"""Words after which a bare verb is a verb."""
CONJUNCTIONS = _words(
    "and or but then so while when until till before after once as because if than yet though although whereas since"
)
PREPOSITIONS = _words(
    "of in on at by with from to into onto off over under above below across along through down up out around round past near beside between behind "
    "beyond against inside outside toward towards upon within among amid beneath underneath for about via per except like during upward downward next around"
)
PARTICLES = _words("off over up down out away apart through back into onto around loose along aside together on in")
"""Words that make a verb of two words, where the lexicon has the pair or the word stands before no noun phrase."""
REQUESTS = _words(
    "want wants wanted need needs show shows see make let make made making please like imagine picture create create render simulate give take try trying show-me think know "
    "compare wish love help suppose say tell ask happen happens happening explain teach keep begin begins start starts ought lot kind sort bit part "
    "scene shot class lesson prompt video clip film movie animation world thing things way side end ends ends do does did done have has had having "
    "use used using includes include means mean seem seems seen ready sure video"
)
"""Words of asking and telling: they say nothing about the world."""
NUMBERS = _words(
    "one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen sixteen seventeen eighteen nineteen twenty thirty forty "
    "fifty sixty seventy eighty ninety hundred thousand dozen several few many couple half twice"
)
UNITS_OF_MEASURE = _words(
    "m cm mm km metre metres meter meters centimetre centimetres centimeter centimeters millimetre millimetres kilometre kilometres kg g t gram grams "
    "kilo kilos kilogram kilograms tonne tonnes ton tons litre litres liter liters l ml degree degrees ° s ms second seconds minute minutes min h hour "
    "hours n j w pa kpa mpa newton newtons % percent storey storeys storeys foot feet inch inches mile miles pound pounds mph kph fps m³ m² ft"
)
LOOK = _words(
    "camera lens telephoto fps shot close-up closeup handheld angle cinematic stylised stylized cartoon footage slow-motion backlit torchlight "
    "photorealistic realistic lighting lit framing locked-off zoom pan bokeh style look feel colours colors palette overhead aerial dolly tracking"
)
TIMES = _words(
    "dawn dusk morning noon afternoon evening night midnight sunrise sunset twilight winter summer spring autumn daybreak nightfall today tonight "
    "a.m p.m overnight midday"
)
WEATHER = _words(
    "fog foggy mist misty rain raining rainy snowing snowy overcast cloudy clear sunny sunshine storm stormy wind windy breeze gust gusts gusty crosswind "
    "drizzle hail blizzard snowstorm thunder thunderstorm lightning hurricane typhoon downpour shower draught frost freezing haze hazy windless sleet humid"
)
MADE_OF = _words("wooden woollen woolen golden leaden earthen silken metallic glassy waxen")
MATERIALS = _words(
    "steel iron brass copper bronze tin lead gold silver aluminium aluminum metal rubber plastic wood glass stone concrete brick paper cardboard cloth "
    "leather velvet wool cotton silk canvas linen ceramic porcelain clay wax chalk ice straw bamboo oak pine larch birch granite marble limestone foam cork"
)
"""Solids that a body can be of: before a noun they are a property of it, where water or oil would only say what it is for (water tower, oil drum)."""
POSTURES = _words("hang dangle stand sit lie lean rest perch")
"""Verbs that in a claim of place say how something is there, which the rows of that claim judge; no event has to take them up."""
STANCES = _words("stand lie sit hang lean rest stay remain")
"""Verbs that say how something is, not what happens: the stance verbs of Quirk et al. (1985), A Comprehensive Grammar of the English Language, 4.32, and
their like."""
RESTING = _words("in on at by from against")
"""Prepositions of place that such a verb keeps its meaning with; with a particle (`sits down`) it tells of an event."""
SUBJECTS = _words("i you he she it we they who which that somebody someone")
"""Pronouns after which a verb follows."""
GERUNDS = _words("without by before after from while for")
"""Words after which a form in -ing is a verb."""
ALWAYS_PARTICLES = _words("off away apart")
CLASSES: tuple[tuple[str, frozenset[str]], ...] = (
    ("filler", DETERMINERS | PRONOUNS | BE | AUXILIARIES | CONJUNCTIONS | PREPOSITIONS | REQUESTS | FUNCTION_WORDS["en"]),
    ("time", TIMES),
    ("weather", WEATHER),
    ("look", LOOK),
    ("property", MADE_OF),
)
"""Types of closed classes, in the order in which a word is looked for."""
PHRASES: dict[str, str] = {
    "step by step": "order",
    "at the same instant": "order",
    "once more": "order",
    "side by side": "property",
    "half a dozen": "count",
    "a dozen": "count",
    "a pair of": "count",
    "a couple of": "count",
    "a single": "count",
    "slow motion": "look",
    "close up": "look",
    "wide shot": "look",
    "wide angle": "look",
    "low angle": "look",
    "long lens": "look",
    "low camera": "look",
    "aerial shot": "look",
    "from the side": "look",
    "from above": "look",
    "seen from": "look",
    "push in": "look",
    "year 8": "filler",
    "high street": "place",
    "of course": "filler",
    "give up": "event",
    "gives up": "event",
    "give way": "event",
    "gives way": "event",
    "let go": "event",
    "lets go": "event",
    "come to rest": "event",
    "comes to rest": "event",
    "such as": "filler",
    "so that": "filler",
    "as if": "filler",
    "at all": "filler",
    "by itself": "property",
    "from rest": "property",
    "at rest": "property",
    "upside down": "property",
}
"""Expressions of several words and their types; longest first when they are looked for."""

REVIEWED: dict[str, str] = {
    "nTvE": "bat beam bear block board bolt bowl bridge bubble bucket cap cart cloud cork crowd cup ditch duck dust fan fire flame foam funnel gutter hammer "
    "hatch hook hose knot mill nail pan pin plug pool rock saw scale screw shell shovel slope smoke spring stack tap taper thread track trap tunnel wave "
    "wheel",
    "nT": "air arrow bus campfire circus cable canoe card carpet chalk cobble cobblestone coin crane crate cricket feather fork grain hedge jar jug key kite log mirror "
    "neighbour nest net object peg pen pit plank pole pot puddle raft rail ramp sack seesaw sled sledge sponge spoon spruce stone string textbook tile "
    "tyre wire",
    "vE": "creak dangle hang leave lie miss rattle sit snap stand stay tow unspool unstack",
    "nM": "flour gravel honey milk oil paper sand snow tin wood",
    "aP": "clear cool empty loose round solid total",
    "nTvS": "fish frame handle match post train",
    "nT=vE": "land orbit spray stick swing",
    "nMvE": "iron water wax",
    "aPvE": "dry slow wet",
    "nLnT": "field garden",
    "nTnM": "glass marble",
    "nL": "gorge harbour",
    "aP=vE": "close open",
    "aPnT": "hollow level",
    "aP=nL": "left right",
    "aP=rA": "fast still",
    "nT=vS": "can",
    "nLvS": "desert study",
    "nTnL": "ground",
    "nTaP": "orange",
    "nTnN": "weight",
    "nTnQ": "yard",
    "vS": "hold",
    "vEaP": "lean",
    "vE=nN": "rest",
    "vEnT": "shear",
    "vE=nT": "buckle",
    "nN=aP": "light",
    "aPrA": "hard",
    "nT=nP": "square",
    "nP": "speed height width length depth size colour color shape distance",
}
"""Reviewed by hand: words of prompts that WordNet's texts of the 1960s to 1990s use in other senses, by part of speech and type, likelier first. `=`
stands between two that are about equally likely."""


def _shares(code: str) -> str:
    first, even, second = code[:2], "=" in code, code[-2:]
    return f"{first}f" if len(code) == 2 else f"{first}{8 if even else 11:x}{second}{7 if even else 4:x}"


SHARES: dict[str, str] = {word: _shares(code) for code, words in REVIEWED.items() for word in words.split()}
"""The same as the data has them, in fifteenths."""


def _kinds(verbs: str, particle: str, *kinds: str) -> dict[str, frozenset[str]]:
    return {f"{verb}{particle}": frozenset(kinds) for verb in verbs.split()}


KINDS: dict[str, frozenset[str]] = {
    **_kinds("burst swing fly spring blow break fling throw push pull creak slam crash", "_open", "opens"),
    **_kinds("slam swing fall bang blow push pull crash click", "_shut", "closes"),
    **_kinds("slam swing fall bang blow push pull crash click", "_closed", "closes"),
    **_kinds("come", "_to_rest", "stops"),
    **_kinds("rush surge", "", "flows"),
    **_kinds("carry", "", "drifts", "floats", "lifts"),
    **_kinds("go come get fall throw knock bring", "_of_balance", "tips", "topples", "falls"),
    **_kinds("go come get fall throw knock", "_off_balance", "tips", "topples", "falls"),
    **_kinds("lose", "_balance", "tips", "topples", "falls"),
    **_kinds("overbalance", "", "tips", "topples", "falls"),
    **_kinds("bob", "", "bobs"),
    **_kinds("bob", "_up", "rises", "bobs"),
}
"""Reviewed by hand: kinds of event of verbs that are one thing with the word behind them and another without, and of verbs that the lexicon's
seeds do not reach. A door that bursts open neither breaks nor jumps."""
