"""Questions about liquids: one group per watch, in the order of their rows; `check.py` lists the watches."""

from __future__ import annotations

from ....worlds.categories.liquid.facts import LEAST_MOUTH
from ...rows.questions import Comparison, Question, by_name
from ..questions import COUNTERS, COUNTS, FINITE, ITERATIONS, SPEED
from .bounds import (
    AREA,
    ATTRACTION,
    BEYOND,
    BOILING,
    BUOYANCY,
    CALM,
    DEPTH_SHARE,
    DISAGREE,
    DRIFT,
    FLIGHT,
    HEIGHT,
    JET,
    JITTER_SECONDS,
    LEAKED,
    LEAST_ACROSS,
    LEAST_OPENING,
    LEDGER,
    LIMIT,
    MEDIUM,
    MOMENTUM,
    PERIOD,
    POP,
    REACTION,
    RECORD,
    SPIKES,
    STUCK,
    TRAPPED,
    VOLUME,
)

__all__ = [
    "ACROSS",
    "BLOWN",
    "BOOKS",
    "COUPLING",
    "DENSITY",
    "ENERGY",
    "FLIGHT_FREE",
    "IDENTITY",
    "LEAKS",
    "MOMENTUM_BALANCE",
    "MOTION",
    "NUMBERS",
    "QUESTIONS",
    "RESOLVED",
    "SHOWN",
    "STICKING",
    "TRAPPED_PARTICLES",
    "WALLS",
    "WAVES",
    "WETTED",
]


def _asked(
    name: str, predicate: str, measures: str = "", unit: str = "", comparison: Comparison = "", bound: str = ""
) -> Question:
    """A question asked of each liquid instance."""
    return Question(f"category:liquid:{name}", predicate, measures, unit, comparison, bound, ("solver",))


ACROSS = by_name(
    _asked(
        "across",
        f"liquid bodies of whose level, buoyancy or pressure something depends are {LEAST_ACROSS:g} spacings across at frame 0",
        "least extent of the thinnest body",
        "spacings",
        ">=",
        "LEAST_ACROSS",
    )
)
BLOWN = by_name(
    _asked(
        "fields",
        f"what force fields gave is what they say, within {ATTRACTION:.0%} of the largest, {MEDIUM:.0%} of what a medium gave",
        "difference of recorded impulses from those of the declared fields, over what is allowed",
        "1",
        "<=",
        "1, of ATTRACTION and MEDIUM",
    )
)
COUPLING = by_name(
    _asked(
        "exchange",
        f"impulse given to each boundary + what the liquid lost through it = 0 within {REACTION:g} of its largest",
        "difference of the two accounts over the largest impulse of the boundary",
        "1",
        "<=",
        "REACTION",
    ),
    _asked(
        "received",
        "what coupled bodies received is what the liquid gave",
        "difference of the two accounts over the largest impulse of the boundary",
        "1",
        "<=",
        "REACTION",
    ),
    _asked(
        "declared",
        "freely moving bodies that the liquid pushes are coupled both ways, or declared one-way",
        "push on a body that no coupling carries, as share of its weight",
        "1",
        "<=",
        "FELT",
    ),
    _asked(
        "buoyancy",
        f"the push on floating and sunk bodies is that of the displaced liquid within {BUOYANCY:.0%}, draft within half a spacing",
        "difference of the push from that of the displaced liquid, or of the draft, over what displacing the whole body gives",
        "1",
        "<=",
        "BUOYANCY",
    ),
)
DENSITY = by_name(
    _asked(
        "density",
        "mean crowding of particles by the judge's count, and mean compression as recorded, are small",
        "mean crowding or mean recorded compression",
        "1",
        "<=",
        "CROWDED; RECORDED",
    ),
    _asked(
        "recorded_density",
        f"recorded densities in the bulk are those that neighbours give, within {DISAGREE:.0%} on average",
        "difference of the recorded and the counted mean density",
        "1",
        "<=",
        "DISAGREE",
    ),
    _asked(
        "divergence",
        f"velocities in the bulk diverge by at most {BOILING:g} of their size per spacing",
        "mean divergence times spacing over the root mean square speed",
        "1",
        "<=",
        "BOILING",
    ),
)
ENERGY = by_name(
    _asked(
        "energy",
        "mechanical energy less what inflow, waves, fields and bodies brought never grows by more than limits.energy_growth of that in play",
        "growth without a source as share of the energy in play",
        "1",
        "<=",
        "limits.energy_growth",
    ),
    _asked(
        "calm",
        f"undriven liquid with a resting surface has at most {CALM:g} of weight x height / 2 as kinetic energy",
        "kinetic energy over weight times half the height",
        "1",
        "<=",
        "CALM",
    ),
)
MOMENTUM_BALANCE = by_name(
    _asked(
        "momentum",
        f"momentum changes by gravity, boundaries, waves, fields, inflow and outflow, within {MOMENTUM:.0%} of a frame's weight and impulses",
        "momentum without a source over a frame's weight and impulses",
        "1",
        "<=",
        "MOMENTUM",
    )
)
FLIGHT_FREE = by_name(
    _asked(
        "flight",
        f"liquid that touches nothing falls freely, within {FLIGHT:.0%} of g dt per frame",
        "change of velocity of a free cluster beyond a free fall, over g dt",
        "1",
        "<=",
        "FLIGHT",
    )
)
LEAKS = by_name(
    _asked(
        "leak",
        f"no liquid gets to the other side of a surface where no resolved way leads; at most {LEAKED:g} of the particles",
        "share of the particles that passed a surface; width of the widest slot where one is not resolved",
        "various",
        "<=",
        "LEAKED",
    )
)
BOOKS = by_name(
    _asked(
        "mass",
        f"mass of particles + outflow - inflow is that of frame 0 within {LEDGER:g} of the largest",
        "difference over the largest mass",
        "1",
        "<=",
        "LEDGER",
    ),
    _asked(
        "start",
        f"volume of particles at frame 0 is that of the declared parts outside of solids within {DRIFT:.0%}",
        "relative error of the volume",
        "1",
        "<=",
        "DRIFT",
    ),
    _asked(
        "records",
        f"records of mass, volume, momentum and energy are those of the particles within {RECORD:g} of their scale",
        "error over the scale of the record",
        "1",
        "<=",
        "RECORD",
    ),
)
IDENTITY = by_name(
    _asked(
        "identity",
        "particles appear at inflows only, vanish at outflows and open sides only, and keep ids of their own",
        "particles that appear, vanish or share ids elsewhere",
        "1",
        "<=",
        "0",
    )
)
MOTION = by_name(
    _asked(
        "jumps",
        "displacement per frame is what velocities explain, within one spacing (two cells)",
        "displacement beyond what velocities explain",
        "spacings",
        "<=",
        "JUMP",
    ),
    _asked(
        "spikes",
        f"at most {SPIKES:g} of the particles are faster than {JET:g} times what energy allows, none {LIMIT:g} times faster still",
        "share of the particles that are too fast",
        "1",
        "<=",
        "SPIKES",
    ),
)
TRAPPED_PARTICLES = by_name(
    _asked(
        "trapped",
        f"at most {TRAPPED:g} of the particles jitter within a spacing for {JITTER_SECONDS:g} s (moving fluid caught between surfaces)",
        "share of the particles that jitter",
        "1",
        "<=",
        "TRAPPED",
    )
)
RESOLVED = by_name(
    _asked(
        "openings",
        f"openings of inflows are at least {LEAST_MOUTH['dfsph']:g} spacings ({LEAST_MOUTH['flip']:g} cells) wide, outflows {LEAST_OPENING:g}",
        "width of the narrowest opening",
        "spacings",
        ">=",
        "LEAST_MOUTH of inflows, LEAST_OPENING of outflows",
    ),
    _asked(
        "obstacles",
        "fixed solids are at least half a spacing (a cell) thick where they are wet",
        "thickness of the thinnest wet part",
        "spacings",
        ">=",
        "LEAST_WALL",
    ),
    _asked(
        "passages",
        f"ways between fixed solids that liquid gets to are at least {LEAST_OPENING:g} spacings wide, or have one beside them that is",
        "width of the narrowest way",
        "spacings",
        ">=",
        "LEAST_OPENING",
    ),
)
STICKING = by_name(
    _asked(
        "sticks",
        f"what nothing bears does not stay at a wall, a ceiling or in the air; at most {STUCK:g} of the particles",
        "share of the particles that stick",
        "1",
        "<=",
        "STUCK",
    )
)
SHOWN = by_name(
    _asked(
        "surface",
        f"volume of surface and spray is that of the particles within {VOLUME:.0%}, and within {DRIFT:.0%} of one another while calm",
        "relative error of the volume",
        "1",
        "<=",
        "VOLUME; DRIFT while calm",
    ),
    _asked(
        "closed",
        "the surface is closed, lies about particles everywhere, and is recorded as it is",
        "share of vertices that lie far from all particles, or error of recorded volume or area",
        "1",
        "<=",
        "STRANGE; DRIFT",
    ),
    _asked(
        "pop",
        f"volume of the surface changes by at most {POP[True]:.0%} per frame without a source while calm, {POP[False]:.0%} in motion, and no part of it comes from nowhere",
        "relative change of volume without a source, or share of vertices that move suddenly",
        "1",
        "<=",
        "POP; STRANGE",
    ),
)
WALLS = by_name(
    _asked(
        "inside",
        f"no particle is deeper than {DEPTH_SHARE:g} spacings inside a solid, one that deforms included",
        "depth of the deepest particle",
        "m",
        "<=",
        "DEPTH_SHARE",
    ),
    _asked(
        "domain",
        f"no particle is more than {BEYOND:g} spacings beyond a side of the domain",
        "way of the farthest particle beyond a side",
        "m",
        "<=",
        "BEYOND",
    ),
    _asked(
        "source",
        "openings of inflows are free of solids, and inside the domain, while they are open",
        "depth of an opening in a solid, or beyond the domain",
        "m",
        "<=",
        "ROUNDING, single precision",
    ),
)
WAVES = by_name(
    _asked(
        "waves_height",
        f"waves leave their zone with the declared height within {HEIGHT:.0%}",
        "relative error of height",
        "1",
        "<=",
        "HEIGHT",
    ),
    _asked("waves_period", f"and with the declared period within {PERIOD:.0%}", "relative error of period", "1", "<=", "PERIOD"),
)
WETTED = by_name(
    _asked(
        "wet",
        f"wet maps are right for all but {AREA:.1%} of the wet area, and as deep as the liquid over them",
        "share of the wet area that maps call otherwise, or the first other fault of them",
        "various",
        "<=",
        "AREA; OFF, UNCOVERED, OVER, SHALLOW",
    )
)
LOST_PARTICLES = Question("numerical:lost", "no particle is lost", "lost particles", "1", "<=", "LOST", ("solver",))
NUMBERS = by_name(FINITE, COUNTS, SPEED, ITERATIONS, COUNTERS, LOST_PARTICLES)
"""Questions of the numerical check: all but the last are asked of other categories, too."""

_FIRST = (BOOKS, IDENTITY, ENERGY, MOMENTUM_BALANCE, WALLS, LEAKS, MOTION, FLIGHT_FREE, TRAPPED_PARTICLES)
_REST = (STICKING, RESOLVED, ACROSS, DENSITY, COUPLING, SHOWN, WAVES, BLOWN, WETTED)
QUESTIONS = (*(question for group in (*_FIRST, *_REST) for question in group.values()), LOST_PARTICLES)
