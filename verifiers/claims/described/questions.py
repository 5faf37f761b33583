"""Questions of the check `claim` about words that describe: property, place, time, weather, look and way."""

from __future__ import annotations

from ...rows.questions import Question

__all__ = ["COLOUR", "FORM", "LOOK", "PLACE", "QUESTIONS", "ROUTE", "TIME", "WEATHER"]

COLOUR = Question(
    "claim:property:colour",
    "what the claim {0} names shows the colour that it says in the light of the film",
    "share of its pixels that are nearest to that colour term, of the body that shows least",
    "1",
    ">=",
    "claims.described.bounds.COLOURED, times the share of a body that a part is",
    ("claim",),
    matrix_group="observational",
)
FORM = Question(
    "claim:property",
    "what the claim {0} names has the size, shape, weight or slope that it says",
    "what the word is about, as the finding says, of the word that is met least",
    "various",
    ">=",
    "claims.described.bounds",
    ("claim",),
    matrix_group="spatial",
)
PLACE = Question(
    "claim:place",
    "what the claim {0} is about is where its words say",
    "largest share of the words that hold at one frame",
    "1",
    ">=",
    "1",
    ("claim",),
    matrix_group="spatial",
)
TIME = Question(
    "claim:time",
    "the sun stands where the words of the claim {0} have it",
    "elevation of the sun",
    "deg",
    "in",
    "claims.described.times.BANDS",
    ("claim",),
    matrix_group="observational",
)
WEATHER = Question(
    "claim:weather",
    "the weather of the claim {0} is simulated, or in the light",
    "what the word is about, as the finding says",
    "various",
    "in",
    "claims.described.weather.BEAUFORT, or what falls",
    ("claim",),
    matrix_group="physical",
)
LOOK = Question(
    "claim:look",
    "a shot is taken as the words of the claim {0} say",
    "what the word is about, as the finding says, of the shot that meets it best",
    "various",
    ">=",
    "claims.described.bounds",
    ("claim",),
    matrix_group="observational",
)
ROUTE = Question(
    "claim:route",
    "the way of the claim {0} is open, or something goes it as the words say",
    "ways and motions that are not as the words say",
    "1",
    "<=",
    "0",
    ("claim",),
    matrix_group="spatial",
)

QUESTIONS = (COLOUR, FORM, PLACE, TIME, WEATHER, LOOK, ROUTE)
