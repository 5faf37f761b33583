"""Support: actual contact and a continuous chain to something static, over the frames that need it (R92, R93, R154).

Declared `supports` relations are judged over their interval. Every free body that no relation covers at frame 0 is
judged there anyhow: no edit of the scene graph removes that row. So are static things on landscapes (`support/landed.py`) and
bodies that leave the ground for good (`support/fallen_off.py`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from ...worlds.settled import settling
from ...worlds.spec import Supports
from ..rows.answers import guarded, row_of, rows_of
from ..rows.findings import Finding
from ..scene.surfaces import surfaces_of
from .anchored import anchored_rows
from .balanced import balanced_rows
from .bonded import bonded_rows
from .carried import carried
from .fallen_off import kept_rows
from .free_bodies import derived
from .graph import SupportGraph
from .held import Held, held_rows
from .joined import joined_rows
from .landed import Ground, landed_rows
from .loose_matter import loose_rows
from .lumps import lump_rows
from .moved import support_interval
from .one_piece import one_piece_rows
from .pinned import pinned_rows
from .questions import BALANCE, CARRIED, DERIVED, SUPPORT_SCENE
from .relations import carries
from .resting import rest_rows
from .stays import stays_rows
from .stillness import is_still

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Row
    from ..scene.surfaces import Surfaces

__all__ = ["check", "support_interval"]


@guarded(SUPPORT_SCENE)
def check(candidate: Candidate) -> list[Row]:
    """Rows per `supports` relation, per body that is to rest, per free body without a relation, and one for the scene."""
    surfaces = surfaces_of(candidate)
    ground, start = Ground(surfaces), SupportGraph(surfaces, until=1)
    held = Held(surfaces, ground)
    rows = [
        *_relations(surfaces, start),
        *_at_rest(start),
        *_derived(start),
        *loose_rows(candidate),
        *held_rows(held),
        *balanced_rows(held),
        *joined_rows(surfaces),
        *anchored_rows(surfaces),
        *pinned_rows(surfaces),
        *bonded_rows(surfaces),
        *one_piece_rows(surfaces, frozenset(n for n in surfaces.entities if is_still(surfaces.candidate.spec, n))),
        *lump_rows(surfaces, ground),
        *landed_rows(surfaces, ground),
        *stays_rows(surfaces),
        *kept_rows(surfaces),
    ]
    rows = [_waiting(candidate, r) for r in rows]
    unique: dict[str, Row] = {}
    for found in rows:  # of two rows that names give one id, the one that does not pass
        if found.id not in unique or unique[found.id].status == "pass":
            unique[found.id] = found
    return [row_of(candidate, SUPPORT_SCENE, (), _scene(candidate, list(unique.values()))), *unique.values()]


def _waiting(candidate: Candidate, found: Row) -> Row:
    """The row, not applicable before any simulation where it is about what settles: the probe judges that where it came to rest."""
    about = found.first_failing_entity or next(iter(found.entities), None)
    if candidate.stage != "static" or found.status == "pass" or about not in settling(candidate.spec):
        return found
    text = f"{about!r} settles before frame 0; probe_sim judges it where it came to rest"
    evidence = {"explanation": text, "as_declared": found.evidence.get("explanation", "")}
    nothing = {"measured": None, "bound": None, "comparison": "", "unit": "", "corrections": ()}
    nothing |= {"first_failing_entity": None, "first_failing_frame": None}
    return found.model_copy(update={**nothing, "status": "not_applicable", "evidence": evidence})


def _declared(candidate: Candidate) -> list[tuple[str, Supports, tuple[int, int]]]:
    """`supports` relations with their intervals."""
    relations = candidate.spec.graph.relations.items()
    return [(n, r, support_interval(candidate.spec, r)) for n, r in relations if isinstance(r, Supports)]


def _fluid(candidate: Candidate, relation: Supports) -> bool:
    return relation.a in candidate.liquids or relation.b in candidate.liquids


def _relations(surfaces: Surfaces, start: SupportGraph) -> list[Row]:
    candidate, rows = surfaces.candidate, []
    graph = start if surfaces.frames == 1 else SupportGraph(surfaces)
    for name, relation, interval in _declared(candidate):
        judge = partial(carried if _fluid(candidate, relation) else carries, graph, relation)
        answer = partial(_over_interval, candidate, judge, interval)
        if interval[0] <= candidate.last_frame or candidate.stage == "full":
            rows.append(row_of(candidate, CARRIED, (name, relation.b), answer, entities=(relation.b, relation.a)))
    return rows


def _over_interval(candidate: Candidate, judge: Callable[[tuple[int, int]], Finding], interval: tuple[int, int]) -> Finding:
    first, last = interval
    if first > candidate.last_frame:
        text = f"the interval begins at frame {first}, the last inspected frame is {candidate.last_frame}"
        return Finding("unverified", text)
    # A probe speaks of the frames that it has; a bake of all that the relation asks for.
    found = judge((first, min(last, candidate.last_frame)))
    return replace(found, needed=interval) if candidate.stage == "full" else found


def _at_rest(start: SupportGraph) -> list[Row]:
    candidate, rows = start.surfaces.candidate, []
    claimed = [
        relation.b
        for _, relation, (first, last) in _declared(candidate)
        if first == 0 and last > 0
        and not _fluid(candidate, relation) and candidate.spec.entities[relation.b].motion == "dynamic"
    ]  # fmt: skip
    for name in dict.fromkeys(claimed):
        rows += rows_of(candidate, BALANCE, (name,), partial(rest_rows, start, name, claimed), entities=(name,))
    return rows


def _derived(start: SupportGraph) -> list[Row]:
    candidate = start.surfaces.candidate
    covered = {relation.b for _, relation, (first, _) in _declared(candidate) if first == 0}
    return [
        row_of(candidate, DERIVED, (name,), partial(derived, start, name), entities=(name,))
        for name, entity in candidate.spec.entities.items()
        if entity.motion == "dynamic" and name not in covered and name in candidate.solids
    ]


def _scene(candidate: Candidate, rows: list[Row]) -> Finding:
    free = [n for n in candidate.solids if candidate.spec.entities[n].motion == "dynamic"]
    bad = [r for r in rows if r.status == "fail"]
    open_rows = [r for r in rows if r.status == "unverified"]
    if not free and not rows:
        return Finding("not_applicable", "the specification has no free body and no supports relation")
    failing = [r.first_failing_entity for r in bad if r.first_failing_entity]
    frames = [r.first_failing_frame for r in bad if r.first_failing_frame is not None]
    return Finding(
        "fail" if bad else "unverified" if open_rows else "pass",
        f"{len(free)} free bodies, {len(rows)} rows: {len(bad)} fail, {len(open_rows)} without evidence",
        float(len(bad)),
        0.0,
        frame=min(frames) if frames else None,
        evidence={"rows": len(rows), "failing": [r.id for r in bad][:20], "unverified": [r.id for r in open_rows][:20]},
        entities=tuple(failing or free),
    )
