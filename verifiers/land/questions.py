"""Questions of the check `terrain`."""

from __future__ import annotations

from ..rows.questions import Question

__all__ = ["DRAINAGE", "FILL", "GROUND", "LANDSCAPE", "MATTER", "PLANTS", "QUESTIONS", "TIGHT", "WATER"]


def _about(name: str, predicate: str, measures: str, unit: str, bound: str = "0") -> Question:
    return Question(f"terrain:{name}", predicate, measures, unit, "<=", bound, ("terrain",), f"terrain:{{0}}:{name}")


LANDSCAPE = Question("terrain", "the landscape is built and holds", subject=("terrain",))
FILL = _about("fill", "the surface height is the least fill of the ground (R34)", "largest difference from reconstruction", "m")
DRAINAGE = _about(
    "drainage", "every cell drains by steepest descent, without circles, and areas close (R36)", "cells that do not", "cells"
)
WATER = _about(
    "water",
    "lakes are level and full, reaches fall and end in water or at the edge (R35, R39, R40)",
    "lakes and reaches that do not",
    "problems",
)
MATTER = _about("ledger", "erosion neither loses nor makes matter (R46)", "share of the matter lost or made", "1", "LEDGER")
PLANTS = _about(
    "plants",
    "no plant stands in water, on a bed or road, in a clearing, off the ground or too near to another (R45)",
    "plants that do",
    "plants",
)
TIGHT = _about(
    "tight",
    "the land has no holes, and the grounds cut from it are closed and adjoin without gaps",
    "holes and gaps",
    "leaks",
)
GROUND = Question(
    "terrain:ground",
    "the ground that bodies stand on is the landscape's",
    "largest distance of its corners, trunks and boulders from those of the landscape",
    "m",
    "<=",
    "PATCH_M",
    ("terrain", "entity"),
    "terrain:{0}:ground:{1}",
)

QUESTIONS = (LANDSCAPE, FILL, DRAINAGE, WATER, MATTER, PLANTS, TIGHT, GROUND)
