"""Gas (R100, R105, R106): one pass over the frames of an instance, seen by one watch per family of questions.

Rows: `category:gas:<question>:<solver>` and `numerical:<question>:<solver>`. Nothing here knows a solver: cells, records and the solids of the
candidate are all there is.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ....worlds.errors import EvidenceError, NotFiniteError
from ....worlds.instances import felt_by
from ...rows.watches import Watch, Watching
from ..container import rows_about
from .books import Books
from .escapes import Escapes
from .fate import Fate
from .fires import Fires
from .flow import Flow
from .following import Following
from .frames import box_of
from .kindling import Kindling
from .limits import Limits
from .numerical import Numbers
from .places import Places
from .pushing import Pushing
from .returned import Returning
from .steaming import Steaming
from .transport import Transport

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Row, Status

__all__ = ["WATCHES", "category_rows", "numerical_rows"]

WATCHES: tuple[type[Watch], ...] = (
    Numbers,
    Books,
    Escapes,
    Transport,
    Limits,
    Flow,
    Places,
    Fires,
    Kindling,
    Steaming,
    Pushing,
    Fate,
)
"""All families, in the order of their rows."""


def _unread(kind: type[Watch], name: str, error: EvidenceError) -> Status:
    """Frames that hold numbers that are not finite cannot be read: that alone is a failure, of `finite`."""
    return "fail" if kind is Numbers and name == "finite" and isinstance(error, NotFiniteError) else "unverified"


_WATCHING = Watching(WATCHES, Numbers, box_of, lambda box: box.steps(), _unread)
_WATCHING_PART = Watching((*WATCHES, Following), Numbers, box_of, lambda box: box.steps(), _unread)
"""Watches of a gas that a part of its box follows: others are not asked about one."""
_WATCHING_FELT = Watching((*WATCHES, Returning), Numbers, box_of, lambda box: box.steps(), _unread)
"""Watches of a gas that feels what it carries: others are not asked about that."""


def _watching(candidate: Candidate, solver: str) -> Watching:
    if candidate.spec.simulation.gas[solver].settings.follows:
        return _WATCHING_PART
    return _WATCHING_FELT if felt_by(candidate.spec, solver) else _WATCHING


def category_rows(candidate: Candidate, solver: str) -> list[Row]:
    """Rows of the category check of one instance."""
    return _watching(candidate, solver).category_rows(candidate, solver)


def numerical_rows(candidate: Candidate, solver: str) -> list[Row]:
    """Rows of the cache and of counters of one instance."""
    return [*rows_about(candidate, solver, {}), *_watching(candidate, solver).numerical_rows(candidate, solver)]
