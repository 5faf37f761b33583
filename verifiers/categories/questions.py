"""Questions about an instance of whatever category: whether there is one, its cache, its first frame, its numbers."""

from __future__ import annotations

from ..rows.questions import Question

__all__ = [
    "AMOUNT",
    "COUNTERS",
    "COUNTS",
    "DIGEST",
    "FINITE",
    "FRAMES",
    "ITERATIONS",
    "PLACED",
    "QUESTIONS",
    "SETTLED",
    "SIMULATED",
    "SPEED",
    "STARTED",
    "TRAVEL",
]

SIMULATED = Question("category", "{0} behaves as its category", subject=("entity",))
"""Asked where nothing simulates an entity whose category asks for it."""
FRAMES = Question(
    "numerical:frames",
    "every frame is there and the index agrees with the plan",
    "missing frames",
    "frames",
    "<=",
    "0",
    ("solver",),
)
DIGEST = Question(
    "numerical:digest",
    "every frame is readable and undamaged",
    "damaged frames",
    "frames",
    "<=",
    "0",
    ("solver",),
)
PLACED = Question(
    "numerical:placed",
    "at frame 0 every entity is where it was declared, but for opened skins; where a preroll moved it, that is told",
    "displacement of the worst entity",
    "m",
    "<=",
    "one summed skin per contact on the way to the next fixed thing; SETTLED after a preroll; LIQUID_MIDDLE",
    ("solver",),
)
AMOUNT = Question(
    "numerical:amount",
    "at frame 0 grains fill what was declared",
    "grains too many or too few",
    "particles",
    "<=",
    "FILLED and FEW",
    ("solver",),
)
STARTED = Question(
    "numerical:started",
    "at frame 0 every entity has its declared velocity",
    "deviation from the declared velocity",
    "m/s",
    "<=",
    "SPEED and SPEED_SHARE; PARTICLE_SPEED",
    ("solver",),
)
SETTLED = Question(
    "numerical:settled",
    "what settles before frame 0 came to rest, starts where it did, stays until something acts, and did not slide away",
    "way over half a second at rest, from the settled place, or aside from the declared one, whichever fails first",
    "m",
    "<=",
    "`rest_way` of its category: two collision skins, the distance at which layers touch, LOOSE_SHARE of a grain or spacing; ROUNDING; ASIDE",
    ("solver",),
)
FINITE = Question(
    "numerical:finite",
    "every number in every channel is finite",
    "numbers that are not",
    "numbers",
    "<=",
    "0",
    ("solver",),
)
SPEED = Question(
    "numerical:speed",
    "nothing is faster than limits.max_speed",
    "largest speed",
    "m/s",
    "<=",
    "limits.max_speed",
    ("solver",),
)
TRAVEL = Question(
    "numerical:travel",
    "travel per frame <= (limits.max_speed + 1 m/s) / fps",
    "largest travel in one frame",
    "m",
    "<=",
    "(limits.max_speed + 1 m/s) / fps",
    ("solver",),
)
COUNTS = Question(
    "numerical:counts",
    "rows of every channel are as many as the index names, and the index names what is planned",
    "bodies, rows or lists that are not as planned",
    "various",
    "<=",
    "0, or the number planned",
    ("solver",),
)
ITERATIONS = Question(
    "numerical:iterations",
    "few steps end at the iteration cap",
    "share of the steps",
    "1",
    "<=",
    "CAPPED",
    ("solver",),
)
COUNTERS = Question(
    "numerical:counters",
    "steps of at most the planned length cover every frame, and every counter is possible",
    "frames with an impossible counter",
    "frames",
    "<=",
    "0",
    ("solver",),
)

QUESTIONS = (SIMULATED, FRAMES, DIGEST, PLACED, AMOUNT, STARTED, SETTLED, FINITE, COUNTS, SPEED, TRAVEL, ITERATIONS, COUNTERS)
