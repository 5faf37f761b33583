"""Questions about grains and flying particles: one group per watch, in the order of their rows; `check.py` lists the watches."""

from __future__ import annotations

from ...rows.questions import Question, by_name
from ..questions import FINITE, SPEED, TRAVEL
from .bounds import FLIGHT, MOMENTUM, OVERLAP, REACTION, RECORDS
from .packing import PACKED

__all__ = ["BOOKS", "CONTACTS", "FLIGHT_FREE", "IDENTITY", "NUMBERS", "QUESTIONS", "WALLS"]


def _asked(name: str, predicate: str, measures: str, unit: str, bound: str) -> Question:
    return Question(f"category:particles:{name}", predicate, measures, unit, "<=", bound, ("solver",))


NUMBERS = by_name(FINITE, SPEED, TRAVEL)
"""Questions of the numerical check, asked of other categories, too."""
IDENTITY = by_name(
    _asked(
        "identity",
        "every particle keeps its id, size and member; ids are not used twice",
        "1 where a particle does not",
        "1",
        "0",
    ),
    _asked(
        "counts",
        "particles come only from emitters, as many as those are declared to let out, and go only by age, at surfaces or out of the domain",
        "largest number of particles that are missing or too many",
        "1",
        "0",
    ),
    _asked("domain", "no particle is outside the domain", "way of the farthest particle beyond a side", "m", "STRAY"),
)
BOOKS = by_name(
    _asked("mass", "mass changes only by what comes, dies and leaves", "largest difference over the largest mass", "1", "MASS"),
    _asked(
        "records",
        f"recorded energies, momentum, mass and volume are those of the particles within {RECORDS:g}, contacts hold at least what their depths say",
        "largest deviation over what is in play",
        "1",
        "RECORDS",
    ),
    _asked(
        "momentum",
        f"momentum changes by what gravity, fields and walls give, within {MOMENTUM:g} of what was given",
        "largest impulse without a source over what acts in a frame",
        "1",
        "MOMENTUM",
    ),
    _asked(
        "energy",
        "mechanical energy less the work of fields and moving walls never grows by more than limits.energy_growth of what is in play",
        "largest growth over any interval, as share of the energy in play",
        "1",
        "limits.energy_growth",
    ),
)
CONTACTS = by_name(
    _asked(
        "overlap",
        f"grains overlap by at most {OVERLAP:.0%} of the smaller radius, within which Hertz's law holds",
        "largest overlap over the smaller radius",
        "1",
        "OVERLAP",
    ),
    _asked(
        "packing",
        f"nowhere do grains fill more than {PACKED:.2f} of their space: random close packing and its scatter",
        "largest share of their space that grains fill",
        "1",
        "random close packing and SCATTER",
    ),
)
WALLS = by_name(
    _asked(
        "inside",
        "no particle's middle is inside a solid, one that deforms included, or goes through a sheet",
        "depth of the deepest middle",
        "m",
        "0 of grains, SUNK of flying particles",
    ),
    _asked(
        "exchange",
        f"impulse given to each body + what the particles lost through it = 0 within {REACTION:g} of its largest",
        "largest difference over the largest impulse",
        "1",
        "REACTION",
    ),
    _asked(
        "received",
        "what coupled bodies received is what the particles gave",
        "largest difference over the largest impulse",
        "1",
        "REACTION",
    ),
    _asked(
        "declared",
        "freely moving bodies that grains push are coupled both ways, or declared one-way",
        "largest push on a body that no coupling carries",
        "N s",
        "FELT of its weight over a frame",
    ),
)
FLIGHT_FREE = by_name(
    _asked(
        "flight",
        f"between hits, ways are those of gravity, drag and fields within {FLIGHT:.0%} of the way and a radius",
        "largest deviation beyond a radius, over the way",
        "1",
        "FLIGHT",
    ),
)

QUESTIONS = tuple(q for group in (IDENTITY, BOOKS, CONTACTS, WALLS, FLIGHT_FREE) for q in group.values())
