"""Questions of the checks `scale`, `relations` and `interpenetration`."""

from __future__ import annotations

from ..rows.questions import Question
from .bounds import LARGEST, NOMINAL_FACTOR, SMALLEST

__all__ = [
    "HIDDEN",
    "MASS",
    "NOMINAL",
    "OVERLAP",
    "OVERLAP_SCENE",
    "QUESTIONS",
    "RATIO",
    "RELATION",
    "SCALE_SCENE",
    "SELF_CROSSING",
    "SIZE",
]

SCALE_SCENE = Question(
    "scale:scene",
    f"every constructed diagonal in [{SMALLEST:g}, {LARGEST:g}] m",
    "diagonal of the largest entity, or of the first outside the range",
    "m",
    "<=",
    "SMALLEST and LARGEST",
)
SIZE = Question(
    "scale",
    "constructed bounding box = dimensions.size within dimensions.tolerance, per axis; every part as its shape says",
    "largest deviation of an edge, as a share of the wanted one",
    "1",
    "<=",
    "dimensions.tolerance; of a part at least FACETS",
    ("entity",),
)
MASS = Question(
    "scale:mass",
    "declared mass lies within what the substances allow the visible volume to weigh",
    "declared mass",
    "kg",
    ">=",
    "volume times the density of the substances",
    ("entity",),
)
HIDDEN = Question(
    "scale:hidden",
    "parts of {0} that lie inside others weigh little beside those that can be seen",
    "mass of the hidden parts by that of the others",
    "1",
    "<=",
    "HIDDEN_MASS; any where the role says that it is weighted",
    ("entity",),
)
NOMINAL = Question(
    "scale:nominal",
    f"constructed diagonal within a factor of {NOMINAL_FACTOR:g} of nominal_diagonal",
    "constructed by nominal diagonal",
    "1",
    "<=",
    "NOMINAL_FACTOR",
    ("entity",),
)
RATIO = Question(
    "scale:relation",
    "specified diagonals of related nodes are in proportion",
    "diagonal of the first by that of the second",
    "1",
    "<=",
    "`ratio` of the relation; default by its kind, within limits.scale_ratio",
    ("relation",),
)
RELATION = Question(
    "relations",
    "the relation holds in the measured geometry",
    "how far the centre lies outside the container, or the surfaces apart",
    "m",
    "<=",
    "0, or `gap` of the relation",
    ("relation",),
)
OVERLAP = Question(
    "interpenetration",
    "visible surfaces of {0} and {1} do not overlap at frame 0",
    "signed clearance",
    "m",
    ">=",
    "query noise; `max_depth` of a `fastened` relation",
    ("entity", "entity"),
)
SELF_CROSSING = Question(
    "interpenetration:self",
    "the surface of {0} has a definite inside: where it crosses itself, the winding number on the outer side of its triangles is "
    "nowhere negative",
    "lowest winding number",
    "1",
    ">=",
    "BETWEEN",
    ("entity",),
)
OVERLAP_SCENE = Question(
    "interpenetration:scene",
    "every pair of entities is inspected and none overlaps at frame 0",
    "overlapping pairs",
    "1",
    "<=",
    "0",
)

QUESTIONS = (SCALE_SCENE, SIZE, MASS, HIDDEN, NOMINAL, RATIO, RELATION, OVERLAP_SCENE, OVERLAP, SELF_CROSSING)
