"""Trial of a predicate on the forged motion of its kind: whether what it asks for can come true at all (R154).

Motions are forged for bodies of one half-size and density; bounds are brought to these. Lengths go with the half-size of the body that a
kind measures, speeds with its root, as under gravity, impulses with mass and speed; angles, shares and times stay.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from ...worlds.predicates.registry import PREDICATES
from ..predicates.evaluators import evaluate
from .bodies import BODIES
from .bounds import HALF
from .places import IN_PLACE, PLACES

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.spec import SpecModel
    from ..predicates.outcome import Outcome

__all__ = ["forged_outcome", "is_forged"]

ON_OTHER = frozenset({"pushes", "pulls", "lifts", "lowers", "throws"})
"""Kinds whose measure goes with the size of the other."""
ROLES = {"entity": "it", "a": "it", "other": "other", "on": "other", "b": "other", "joint": "hinge"}
"""Names on the stage of those whom an atom names."""


def is_forged(kind: str) -> bool:
    """True where there is a forged motion of a kind of predicate."""
    return kind in BODIES or kind in PLACES


@lru_cache(maxsize=64)
def _body(kind: str) -> Candidate:
    return BODIES[kind]().open()


def forged_outcome(candidate: Candidate, atom: SpecModel) -> Outcome:
    """Outcome of an atom on the forged motion of its kind.

    Raises:
        EvidenceError: it names an entity that is not built.
        KeyError: no motion of its kind is forged.
    """
    kind = str(getattr(atom, "kind", ""))
    roles = {n: role for n, role in ROLES.items() if getattr(atom, n, None) is not None}
    brought = atom if kind in IN_PLACE else atom.model_copy(update=_bounds(candidate, atom))
    stage = PLACES[kind](candidate.spec, brought).open() if kind in PLACES else _body(kind)
    return evaluate(stage, brought.model_copy(update=roles), (0, stage.last_frame))


def _bounds(candidate: Candidate, atom: SpecModel) -> dict[str, float]:
    """Bounds of an atom for bodies as large as the forged ones."""
    kind = str(getattr(atom, "kind", ""))
    names = [n for n in ("entity", "a", "b", "other") if getattr(atom, n, None) in candidate.spec.entities]
    measured = "other" if kind in ON_OTHER else next(iter(names), "entity")
    contract = candidate.spec.entities.get(str(getattr(atom, measured, "")))
    ratio = 1.0 if contract is None else 0.5 * min(contract.dimensions.size) / HALF
    unit = PREDICATES[kind].unit
    if unit == "N s":
        masses = [sum(b.mass for b in candidate.entity(str(getattr(atom, n))).bodies) for n in names if _free(candidate, atom, n)]
        own = _body(kind)
        scale = min(masses, default=own.body("it").mass) / own.body("it").mass * float(np.sqrt(ratio))
    else:
        scale = {"m": ratio, "m/s": float(np.sqrt(ratio))}.get(unit, 1.0)
    given = {n: getattr(atom, n, None) for n in PREDICATES[kind].tightens}
    return {n: float(v) / scale for n, v in given.items() if v is not None}


def _free(candidate: Candidate, atom: SpecModel, field: str) -> bool:
    return candidate.spec.entities[str(getattr(atom, field))].motion == "dynamic"
