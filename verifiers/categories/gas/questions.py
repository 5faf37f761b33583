"""Questions about gas: one group per watch, in the order of their rows; `check.py` lists the watches."""

from __future__ import annotations

from ...rows.questions import Question, by_name
from ..questions import COUNTERS, FINITE, ITERATIONS, SPEED
from .bounds import ACROSS, CUT

__all__ = [
    "BOOKS",
    "ESCAPES",
    "FATE",
    "FIRES",
    "FLOW",
    "FOLLOWING",
    "KINDLING",
    "LIMITS",
    "NUMBERS",
    "PLACES",
    "PUSHING",
    "QUESTIONS",
    "RETURNING",
    "STEAM",
    "TRANSPORT",
]


def _asked(
    name: str, predicate: str, measures: str, unit: str, bound: str, *, comparison: str = "<=", mandatory: bool = True
) -> Question:
    return Question(f"category:gas:{name}", predicate, measures, unit, comparison, bound, ("solver",), mandatory=mandatory)  # type: ignore[arg-type]


NUMBERS = by_name(FINITE, SPEED, ITERATIONS, COUNTERS)
"""Questions of the numerical check, asked of other categories, too."""
BOOKS = by_name(
    _asked(
        "emitted",
        "sources let out what their drivers declare: volume, soot and heat",
        "largest difference over what is declared",
        "1",
        "EMITTED",
    ),
    _asked(
        "records",
        "recorded soot and heat are those of the cells",
        "largest difference over what was emitted",
        "1",
        "BOOKS",
    ),
    _asked(
        "soot",
        "soot in the box and what left it is what was emitted, at every frame",
        "largest soot that is missing or too much, over what was emitted",
        "1",
        "BOOKS",
    ),
    _asked(
        "heat",
        "heat in the box, what left it and what was given off is what was emitted, at every frame",
        "largest heat that is missing or too much, over what was emitted",
        "1",
        "BOOKS",
    ),
)
ESCAPES = by_name(
    _asked(
        "escape",
        "soot leaves through open sides as the velocities there carry it",
        "difference of the recorded escape from that of the velocities beyond what these leave open, over what was emitted",
        "1",
        "ESCAPE",
    ),
    _asked(
        "escape_heat",
        "heat leaves through open sides as the velocities there carry it",
        "difference of the recorded escape from that of the velocities beyond what these leave open, over what was emitted",
        "1",
        "ESCAPE",
    ),
)
TRANSPORT = by_name(
    _asked(
        "continuity",
        "no cell has more soot than was within the reach of the gas a frame ago, by ways through open cells, or than a source lets out",
        "largest excess over the greatest soot",
        "1",
        "SEEP",
    ),
    _asked(
        "gaps",
        "no cell has less soot than was within the reach of the gas a frame ago, by ways through open cells",
        "largest lack over the greatest soot",
        "1",
        "SEEP",
    ),
    _asked(
        "carried",
        "from frame to frame the middle of soot and heat moves as the velocities carry them",
        "largest difference of the way over that of the velocities, beyond what frames leave open",
        "1",
        "COURSE",
    ),
)
LIMITS = by_name(
    _asked(
        "temperature",
        "no gas is colder than the ambient air or hotter than a source or the hottest flame",
        "largest excess or lack over the excess of the hottest source",
        "1",
        "WARM",
    ),
    _asked(
        "dense",
        "soot is never negative and never denser than at a source, or than burning leaves it",
        "largest excess or lack over the soot at a source",
        "1",
        "SEEP",
    ),
)
FLOW = by_name(
    _asked(
        "divergence",
        "where nothing emits, as much flows into a cell as out of it, but for the room that fire makes",
        "largest net outflow of a cell and its neighbours per cell, over the largest speed",
        "1",
        "DIVERGENT",
    ),
    _asked(
        "outflow",
        "through surfaces around sources flows what these let out",
        "difference over the declared rate",
        "1",
        "EMITTED and DIVERGENT",
    ),
    _asked(
        "projection",
        "the recorded divergence after the projection is small",
        "largest, over the largest speed per cell",
        "1",
        "PROJECTED",
    ),
    _asked(
        "energy",
        "motion grows by no more than buoyancy, sources and what flows in give",
        "largest excess over the energy in play",
        "1",
        "ENERGY",
    ),
)
PLACES = by_name(
    _asked(
        "inside",
        "no gas is in cells that are inside bodies or closed",
        "most soot or excess heat there, over that of a source",
        "1",
        "THIN",
    ),
    _asked(
        "room",
        "cells in the middle of bodies are closed, and those away from all bodies open",
        "cells that are not",
        "cells",
        "0",
    ),
    _asked("source", "a source is inside the box, and not in a body", "share of it that is not", "1", "0"),
    _asked(
        "resolved", f"a source is at least {ACROSS:g} cells across", "least width of a source", "cells", "ACROSS", comparison=">="
    ),
    _asked(
        "cut",
        f"no open side cuts off smoke that is seen: the optical depth along the side is below {CUT:g}",
        "largest optical depth along an open side",
        "1",
        "CUT",
        mandatory=False,
    ),
    _asked(
        "stopped",
        "closed sides against which smoke comes are surfaces of bodies",
        "largest optical depth along a closed side where no body is",
        "1",
        "CUT",
        mandatory=False,
    ),
)

FIRES = by_name(
    _asked(
        "fuel",
        "fuel in the box and what left it, burnt or not, is what was emitted, at every frame",
        "largest fuel that is missing or too much, over what was emitted",
        "1",
        "BOOKS",
    ),
    _asked(
        "burnt",
        "heat and soot are those of the fuel that is neither in the box nor left it",
        "largest difference in fuel, over what was emitted",
        "1",
        "BURNT",
    ),
    _asked(
        "released",
        "recorded heat of flames and light is that of the cells that burn at the frames",
        "difference beyond what lies between frames, over all heat",
        "1",
        "RELEASED",
    ),
    _asked(
        "flames",
        "flames are where fuel is, and heat or a spark, and give no more than flames do",
        "share of the heat that is released elsewhere",
        "1",
        "FLAMES",
    ),
    _asked(
        "lit",
        "what burns was reached by a spark or by gas that was hot enough a frame ago",
        "share of the heat that is released elsewhere",
        "1",
        "FLAMES",
    ),
    _asked(
        "oxygen",
        "fuel and products in a cell are part of its gas",
        "largest excess or lack over the gas of the cell",
        "1",
        "SEEP",
    ),
    _asked(
        "radiated",
        "what is radiated is the share that flames radiate, or what hot soot does",
        "largest excess or lack over the greatest power of a cell",
        "1",
        "RADIATED",
    ),
)

KINDLING = by_name(
    _asked(
        "surfaces",
        "surfaces that may burn are those of their parts, with the mass of these",
        "largest difference of area or mass of a part",
        "1",
        "BURNT",
    ),
    _asked(
        "carried_along",
        "pieces of surface that may burn keep their places on their bodies and their cloth",
        "farthest that one is from its place",
        "cells",
        "CARRIED",
    ),
    _asked(
        "gasified",
        "what surfaces give off is the mass that they lose, which only falls",
        "largest difference over all that they gave",
        "1",
        "BOOKS",
    ),
    _asked(
        "kindled",
        "surfaces give off gas where they are hot enough to",
        "share of it that others give over a frame",
        "1",
        "FLAMES",
    ),
    _asked(
        "stored",
        "heat in surfaces, and in the gas that they gave, is what they took",
        "largest heat that is missing or too much, over what they took",
        "1",
        "BOOKS",
    ),
    _asked(
        "heated",
        "surfaces get no more heat than the gas and the flames about them give",
        "heat beyond that, over all that they got",
        "1",
        "HEATED",
    ),
)

PUSHING = by_name(
    _asked(
        "pushed",
        "what it carries gets the impulse of its velocities past it, as far as it is free and in the box",
        "largest difference since frame 0 over all that it gave",
        "1",
        "PUSHED",
    ),
)
RETURNING = by_name(
    _asked(
        "returned",
        "it loses what a two_way coupling lets it give to what it carries",
        "largest difference since frame 0 over all that these got",
        "1",
        "RETURNED",
    ),
    _asked(
        "returned_there", "it loses that where these are", "share of it that it lost elsewhere, in any interval", "1", "ASTRAY"
    ),
)
STEAM = by_name(
    _asked(
        "boiled",
        "steam is what boils where hot matter touches water, by their caches and the boiling law",
        "largest difference of area, heat or mass over the most of each",
        "1",
        "EMITTED",
    ),
    _asked(
        "quenched",
        "heat of the steam is what hot matter lost as it cooled, which never gets colder than boiling water",
        "largest heat that is missing or too much, over what was given",
        "1",
        "BOOKS",
    ),
    _asked("above", "steam comes inside the box", "share of it that does not", "1", "EMITTED"),
    _asked("kept", "little of the water boils off, since its liquid keeps it", "share of the water", "1", "BOILED"),
)

FOLLOWING = by_name(
    _asked(
        "arrived",
        "where a part of the box follows the gas, nothing has come to the sides of that part inside the box",
        "most soot or excess heat along them, over that of a source",
        "1",
        "THIN",
    ),
    _asked(
        "slipped",
        "where a part of the box follows the gas, nothing leaves through the sides of that part inside the box",
        "soot or heat that did since frame 0, over what was emitted",
        "1",
        "BOOKS",
    ),
    _asked(
        "beyond",
        "where a part of the box follows the gas, there is ambient air at rest outside it",
        "cells outside that hold something else",
        "cells",
        "0",
    ),
    _asked(
        "followed",
        "where a part of the box follows the gas, sources that let out gas and bodies that move are in it",
        "cells of these outside",
        "cells",
        "0",
    ),
)

FATE = by_name(
    _asked(
        "fate",
        "smoke that is seen once stays in sight; where it does not, it is told whether the solver lost it, it left the box, thinned, or is out of the picture",
        "share of the smoke in the box that lies outside every picture taken at the frame; 1 where none is seen",
        "1",
        "CROPPED",
        mandatory=False,
    ),
)

QUESTIONS = tuple(
    q
    for group in (BOOKS, ESCAPES, TRANSPORT, LIMITS, FLOW, PLACES, FIRES, KINDLING, STEAM, PUSHING, RETURNING, FOLLOWING, FATE)
    for q in group.values()
)
