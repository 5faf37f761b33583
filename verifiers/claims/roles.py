"""Roles swapped: what a beat tells of two bodies, told of them the other way round, up to the end of the event itself.

Once the ball has hit the block, a block that hits it back is another event, and takes nothing from the first. So an event that comes true is
swapped only for one that begins before it is over; two that hit each other at the same contact have no roles. A lasting one begins where
its judge tells; where none does, and inside `not`, `until`, `always` and `eventually`, it is asked of all frames.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ...worlds.predicates import After, And, Before, Count, Eventually, Or, Within, atoms_of
from ...worlds.predicates.registry import PREDICATES
from ..predicates.combine import substitute
from ..predicates.evaluators import evaluate
from .mapping import mapped

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.spec import SpecModel

__all__ = ["swapped_roles"]

MOMENTARY = frozenset({"hits"})
"""Kinds that begin in the interval at whose end they are true."""


def swapped_roles(candidate: Candidate, predicate: SpecModel, frames: tuple[int, int], each: tuple[str, ...] = ()) -> SpecModel:
    """The predicate with every directed event swapped; itself where there is none.

    Args:
        candidate: what is judged.
        predicate: of a beat.
        frames: over which it is judged.
        each: entities that `each` stands for.
    """
    inner = partial(swapped_roles, candidate, frames=frames, each=each)
    if isinstance(predicate, And | Or):
        return predicate.model_copy(update={"of": [inner(p) for p in predicate.of]})
    if isinstance(predicate, Before | After | Within):
        return predicate.model_copy(update={"predicate": inner(predicate.predicate)})
    if isinstance(predicate, Count):
        return predicate.model_copy(update={"predicate": inner(predicate.predicate, each=tuple(predicate.entities))})
    if atoms_of(predicate) != [predicate]:
        return mapped(predicate, _swapped)
    swapped = _swapped(predicate)
    over = None if swapped == predicate else _over(candidate, predicate, frames, each)
    return swapped if over is None else Eventually(predicate=swapped, frames=(frames[0], over))


def _swapped(atom: SpecModel) -> SpecModel:
    info = PREDICATES.get(str(getattr(atom, "kind", "")))
    if info is None or not info.directed or getattr(atom, "other", None) is None:
        return atom
    return atom.model_copy(update={"entity": atom.other, "other": atom.entity})  # type: ignore[attr-defined]


def _over(candidate: Candidate, atom: SpecModel, frames: tuple[int, int], each: tuple[str, ...]) -> int | None:
    """Last frame of a directed event that comes true, of the first to do so; None where none does or a swapped one begins by its end."""
    told = [substitute(atom, name) for name in each] if "each" in (atom.entity, atom.other) else [atom]  # type: ignore[attr-defined]
    ends = []
    for one in told:
        end, begins = _end(candidate, one, frames), _begin(candidate, _swapped(one), frames)
        if begins is not None and (end is None or begins < end):
            return None
        ends += [] if end is None else [end]
    return min(ends, default=None)


def _end(candidate: Candidate, atom: SpecModel, frames: tuple[int, int]) -> int | None:
    """Last frame of the first time that an event is true; None where it is not."""
    outcome = evaluate(candidate, atom, frames)
    if outcome.status != "pass" or outcome.truth is None or outcome.first_true_frame is None:
        return None
    after = outcome.truth[outcome.first_true_frame - frames[0] :]
    return outcome.first_true_frame + (len(after) if after.all() else int(np.argmin(after))) - 1


def _begin(candidate: Candidate, atom: SpecModel, frames: tuple[int, int]) -> int | None:
    """Frame before which an event has not begun, the first of the interval where nothing tells; None where it is shown not to come true."""
    outcome = evaluate(candidate, atom, frames)
    first = outcome.first_true_frame
    if outcome.status != "pass" or first is None:
        return None if outcome.status == "fail" else frames[0]
    if getattr(atom, "kind", "") in MOMENTARY:
        return first - 1
    at = evaluate(candidate, atom, (frames[0], first)).details.get("onset")
    return frames[0] if at is None else int(at)
