"""Open and missing rows of a stored verdict, read again whenever a gate asks, against those that the specification demands."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from ..worlds.audits.audit import audit
from ..worlds.requirements import Row
from ..worlds.spec import WorldSpec
from .checks import rerun_ids
from .delivery.questions import CACHE, COMPLETE, DIGESTS, FREEZE, INDEPENDENT, NEEDED, REPLAY
from .scene.questions import OVERLAP_SCENE, RATIO, SCALE_SCENE, SIZE
from .shots.seen import seen_ids
from .story.questions import BEAT

__all__ = ["demanded", "demanded_of_motion", "open_in_matrix", "open_in_probe", "unmet"]

_ONCE = (FREEZE, CACHE, REPLAY, INDEPENDENT, SCALE_SCENE, OVERLAP_SCENE)
"""Questions that acceptance answers once for every world."""


def demanded(spec: WorldSpec) -> frozenset[str]:
    """Ids of rows that an acceptance of this specification must hold, as far as the specification alone tells them.

    Those of the audit, one per entity, relation, beat, declared cause, sample of robustness and beat to be seen, the frames of every instance, and
    what binds the verdict to them. Pairs that touch and supports are found by measurement: no specification lists them.
    """
    instances = spec.simulation.solvers
    found = {row.id for row in audit(spec).rows} | {q.row_id(()) for q in _ONCE} | demanded_of_motion(spec)
    found |= {q.row_id((name,)) for q in (COMPLETE, DIGESTS) for name in instances}
    found |= (
        seen_ids(spec)
        | {SIZE.row_id((name,)) for name in spec.entities}
        | {RATIO.row_id((name,)) for name in spec.graph.relations}
    )
    return frozenset(found)


def demanded_of_motion(spec: WorldSpec) -> frozenset[str]:
    """Ids of rows that a probe must hold, and acceptance too: one per beat, declared cause, and beat of a sample of robustness."""
    return rerun_ids(spec) | {BEAT.row_id((name,)) for name in spec.story.beats}


def unmet(spec: WorldSpec, rows: Sequence[Row]) -> list[str]:
    """Lines that name what keeps the rows of an acceptance from being one: open rows, rows and checks that are missing."""
    lines = _lines(r for r in rows if _is_open(r))
    lines += [f"{i}: missing, although the specification demands it" for i in sorted(demanded(spec) - {r.id for r in rows})]
    return lines + [f"{check}: no row of this check" for check in sorted(NEEDED - {r.check for r in rows})]


def open_in_matrix(rows: Iterable[Row], stages: Mapping[str, str]) -> list[str]:
    """Lines that name the rows of the matrix which speak against a verdict over the whole sequence.

    Rows made stale by an edit say nothing about the present specification, nor do those that wait for a motion they never saw.
    """
    found = [r for r in rows if _is_open(r) and not r.evidence.get("stale")]
    return _lines(r for r in found if r.status == "fail" or stages.get(r.id) == "full")


def open_in_probe(rows: Iterable[Row], last: int) -> list[Row]:
    """Mandatory rows that a motion up to frame `last` leaves open; what can only be judged later waits for the bake."""
    return [r for r in rows if _is_open(r) and not (r.status == "unverified" and r.frames is not None and r.frames[1] > last)]


def _lines(rows: Iterable[Row]) -> list[str]:
    """One line per row: its id, its status, what it measured."""
    return [f"{r.id}: {r.status}" + ("" if r.measured is None else f", measured {r.measured:.6g} {r.unit}") for r in rows]


def _is_open(row: Row) -> bool:
    return row.mandatory and row.status in ("fail", "unverified")
