"""Support: actual contact and a continuous chain to something static, over the frames that need it (R92, R93, R154).

Declared `supports` relations are judged over their interval. Every free body that no relation covers at frame 0 is
judged there anyhow: no edit of the scene graph removes that row. So are static things on landscapes (`support/landed.py`) and
bodies that leave the ground for good (`support/fallen_off.py`).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64, rotation_matrix
from ...worlds.requirements import Correction, RowId
from ...worlds.spec import ReleaseDriver, Supports
from ..ledgers import motion
from ..rows.guards import guarded, guarded_rows, only_seen, pointer
from ..rows.verdicts import Comparison, make_row
from ..scene.surfaces import surfaces_of
from .carried import carried_row
from .fallen_off import kept_rows
from .free_bodies import DERIVED, LEFT, along_up, derived_row, placement
from .graph import SupportGraph, drop
from .held import held_rows, is_still
from .joined import joined_rows
from .landed import Ground, landed_rows
from .moved import support_interval
from .one_piece import one_piece_rows
from .pinned import pinned_rows
from .resting import rest_rows
from .stays import stays_rows

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Row
    from ..scene.surfaces import Surfaces

__all__ = ["check", "support_interval"]


@guarded("support", "every free body is held up by contact, joint or driver")
def check(candidate: Candidate) -> list[Row]:
    """Rows per `supports` relation, per body that is to rest, per free body without a relation, and one for the scene."""
    surfaces = surfaces_of(candidate)
    graph, start = SupportGraph(surfaces), SupportGraph(surfaces, until=1)
    rows: list[Row] = []
    covered: set[str] = set()
    claimed: list[str] = []
    for name, relation in candidate.spec.graph.relations.items():
        if not isinstance(relation, Supports):
            continue
        first, last = support_interval(candidate.spec, relation)
        if first == 0:
            covered.add(relation.b)
        if first > candidate.last_frame:
            if candidate.stage == "full":
                rows.append(_not_reached(candidate, name, relation, first))
            continue
        frames = (first, min(last, candidate.last_frame))
        fluid = relation.a in candidate.liquids or relation.b in candidate.liquids
        judged = guarded_rows(
            candidate,
            lambda n=name, r=relation, f=frames, j=carried_row if fluid else _relation: [j(graph, n, r, f)],  # type: ignore[misc]
            row_id=RowId("support", name, relation.b),
            predicate=f"{relation.a} carries {relation.b}",
            entities=(relation.b, relation.a),
        )
        # A probe speaks of the frames that it has; a bake of all that the relation asks for.
        rows += [only_seen(candidate, r, (first, last)) for r in judged] if candidate.stage == "full" else judged
        if first == 0 and last > 0 and not fluid and candidate.spec.entities[relation.b].motion == "dynamic":
            claimed.append(relation.b)
    for name in dict.fromkeys(claimed):
        rows += guarded_rows(
            candidate,
            lambda b=name: rest_rows(start, b, claimed),  # type: ignore[misc]
            row_id=RowId("support:balance", name),
            predicate="it can rest where it is at frame 0",
            entities=(name,),
        )
    for name, entity in candidate.spec.entities.items():
        if entity.motion == "dynamic" and name not in covered and name in candidate.solids:
            rows += guarded_rows(
                candidate,
                lambda n=name: [derived_row(start, n)],  # type: ignore[misc]
                row_id=RowId("support:derived", name),
                predicate=DERIVED,
                entities=(name,),
            )
    ground = Ground(surfaces)
    rows += [
        *held_rows(surfaces, ground),
        *joined_rows(surfaces),
        *pinned_rows(surfaces),
        *one_piece_rows(surfaces, frozenset(n for n in surfaces.entities if is_still(surfaces.candidate.spec, n))),
        *landed_rows(surfaces, ground),
        *stays_rows(surfaces),
        *kept_rows(surfaces),
    ]
    unique: dict[str, Row] = {}
    for found in rows:  # of two rows that names give one id, the one that does not pass
        if found.id not in unique or unique[found.id].status == "pass":
            unique[found.id] = found
    return [_scene(surfaces, list(unique.values())), *unique.values()]


def _not_reached(candidate: Candidate, name: str, relation: Supports, first: int) -> Row:
    return make_row(
        candidate,
        row_id=RowId("support", name, relation.b),
        predicate=f"{relation.a} carries {relation.b}",
        status="unverified",
        explanation=f"the interval begins at frame {first}, the last inspected frame is {candidate.last_frame}",
        entities=(relation.b, relation.a),
    )


class _Fault(NamedTuple):
    """Something wrong with a relation, from `frame` on."""

    frame: int
    text: str
    measured: float
    bound: float
    comparison: Comparison
    unit: str
    correction: Correction


def _relation(graph: SupportGraph, name: str, relation: Supports, frames: tuple[int, int]) -> Row:
    surfaces = graph.surfaces
    a, b = relation.a, relation.b
    surfaces.require(a, b)
    window = slice(frames[0], frames[1] + 1)
    distance = surfaces.series(a, b)[window]
    linked = graph.linked(a, b)[window]
    gap = surfaces.contact_gap(a, b)
    creep = _creep(surfaces, a, b, window)
    faults = list(_faults(graph, relation, frames, distance, linked, creep))
    predicate = (
        f"{a} carries {b} over frames {frames[0]}..{frames[1]}: gap <= {gap:g} m, no overlap, {a} beneath {b}, "
        f"creep <= {surfaces.candidate.spec.simulation.limits.support_drift:g} m, chain to something static"
    )
    evidence: dict[str, Any] = {
        "largest_gap_m": float(distance.max()) if np.isfinite(distance).all() else None,
        "least_clearance_m": float(distance.min()) if np.isfinite(distance).any() else None,
        "creep_m": float(creep.max()) if np.isfinite(creep).all() else None,
        "jointed": bool(linked.any()),
        "chain": graph.chain(b, frames[0]),
        "interval": list(frames),
    }
    common: dict[str, Any] = {
        "row_id": RowId("support", name, b),
        "predicate": predicate,
        "frames": frames,
        "extra": [relation.model_dump(mode="json"), frames, gap],
    }
    if not faults:
        worst = float(distance.max()) if np.isfinite(distance).all() else 0.0
        text = (
            f"{a!r} carries {b!r} over {len(distance)} frames: gap at most {worst * 1e3:.4g} mm, creep {creep.max() * 1e3:.4g} mm"
        )
        return make_row(
            surfaces.candidate,
            status="pass",
            explanation=text if not linked.all() else f"a joint holds {b!r} at {a!r} over {len(distance)} frames",
            measured=worst,
            bound=gap,
            comparison="<=",
            unit="m",
            entities=(b, a),
            evidence=evidence,
            **common,
        )
    faults.sort(key=lambda f: f.frame)
    first = faults[0]
    return make_row(
        surfaces.candidate,
        status="fail",
        explanation="; ".join(f.text for f in faults),
        measured=first.measured,
        bound=first.bound,
        comparison=first.comparison,
        unit=first.unit,
        entities=(b, a),
        first_failing_frame=first.frame,
        corrections=[f.correction for f in faults],
        evidence=evidence,
        **common,
    )


def _creep(surfaces: Surfaces, a: str, b: str, window: slice) -> F64:
    """How far the centre of mass of b, seen from a, is from where it was at the interval's start [m], shape (frames,)."""
    position, quaternion = surfaces.track(a, surfaces.candidate.entity(a).bodies[0].name)
    with np.errstate(invalid="ignore", over="ignore"):
        offset = motion.centers(surfaces.candidate, b) - position
        local = np.einsum("fji,fj->fi", rotation_matrix(quaternion), offset)[window]
        return np.asarray(np.linalg.norm(local - local[0], axis=1))


def _faults(
    graph: SupportGraph, relation: Supports, frames: tuple[int, int], distance: F64, linked: NDArray[np.bool_], creep: F64
) -> Iterator[_Fault]:
    """Everything that is wrong, each with the first frame of it."""
    surfaces, a, b, begin = graph.surfaces, relation.a, relation.b, frames[0]
    gap, drift = surfaces.contact_gap(a, b), surfaces.candidate.spec.simulation.limits.support_drift
    bound = -(surfaces.allowed_depth(a, b) + surfaces.noise(a, b))
    window = slice(frames[0], frames[1] + 1)

    def first(wrong: NDArray[np.bool_]) -> int | None:
        return int(np.argmax(wrong)) if wrong.any() else None

    k = first(~(np.isfinite(creep)))
    if k is not None:
        yield _Fault(
            begin + k,
            f"a pose of {a!r} or {b!r} is not finite at frame {begin + k}",
            float("nan"),
            0.0,
            "==",
            "m",
            _finer(surfaces),
        )
    k = first(~linked & ~(distance <= gap))
    if k is not None:
        yield _apart(surfaces, relation, begin + k, gap)
    k = first(distance < bound)
    if k is not None:
        depth = -float(distance[k])
        text = f"{b!r} overlaps {a!r} by {depth * 1e3:.4g} mm at frame {begin + k}"
        lift = along_up(surfaces, depth + LEFT) if begin + k == 0 else None
        yield _Fault(begin + k, text, -depth, bound, ">=", "m", placement(surfaces, b, lift, f"{b!r} sinks into {a!r}"))
    # What never moves needs no more of its holder than to touch it, from whichever side: a picture and its wall.
    unborne = ~linked & (distance <= gap) & ~surfaces.carries(a, b)[window] & ~_leans(graph, a, b, frames)
    k = first(unborne) if surfaces.candidate.spec.entities[b].motion == "dynamic" else None
    if k is not None:
        text = (
            f"{a!r} touches {b!r} at frame {begin + k} but is neither beneath it nor needed to hold it, so it does not carry it"
        )
        yield _Fault(
            begin + k, text, 0.0, 1.0, "==", "1", placement(surfaces, b, None, f"{b!r} is beside or below {a!r}, not on it")
        )
    k = first(~linked & (creep > drift))
    if k is not None:
        text = f"{b!r} creeps {creep.max() * 1e3:.4g} mm on {a!r}, beyond {drift * 1e3:.4g} mm from frame {begin + k} on"
        yield _Fault(begin + k, text, float(creep.max()), drift, "<=", "m", _slips(surfaces, a, b))
    k = first(~graph.grounded(a)[window])
    if k is not None:
        text = f"no chain of contacts, joints or drivers leads from {a!r} to something static at frame {begin + k}"
        fall = drop(surfaces, a, begin + k) if begin + k == 0 else None
        offset = along_up(surfaces, LEFT - fall[0]) if fall else None
        yield _Fault(begin + k, text, 0.0, 1.0, "==", "1", placement(surfaces, a, offset, f"{a!r} itself is not supported"))


def _leans(graph: SupportGraph, a: str, b: str, frames: tuple[int, int]) -> NDArray[np.bool_]:
    """At which frames `b` can rest only because it touches `a`, though `a` is not beneath it, shape (frames,)."""
    surfaces = graph.surfaces
    open_frames = (surfaces.series(a, b) <= surfaces.contact_gap(a, b)) & ~surfaces.carries(a, b) & ~graph.linked(a, b)
    result = np.zeros(surfaces.frames, dtype=bool)
    for k in np.flatnonzero(open_frames[: frames[1] + 1]):
        if k >= frames[0]:
            result[k] = graph.rests(b, int(k)) and not graph.rests(b, int(k), without=a)
    return result[frames[0] : frames[1] + 1]


def _finer(surfaces: Surfaces) -> Correction:
    solvers = surfaces.candidate.spec.simulation.rigid
    name, solver = next(iter(solvers.items())) if solvers else ("", None)
    path = pointer("simulation", "solvers", name, "settings", "step")
    return Correction(
        cause="the simulation became unstable",
        edit_class="solver",
        group="step",
        action=f"Halve the step of solver {name!r}."
        if solver is None
        else f"Cut the step of {name!r} to {solver.settings.step / 2:g} s.",
        pointers=(path,),
        patch=() if solver is None else ({"op": "replace", "path": path, "value": solver.settings.step / 2},),
    )


def _slips(surfaces: Surfaces, a: str, b: str) -> Correction:
    spec = surfaces.candidate.spec
    names = [spec.entities[n].material for n in (a, b)]
    friction = max(spec.materials[n].friction if n in spec.materials else 0.0 for n in names)
    released = [d.time for d in spec.simulation.drivers.values() if isinstance(d, ReleaseDriver) and d.entity == b]
    if released:
        frame = int(max(released) * spec.simulation.fps)
        return Correction(
            cause=f"{b!r} is released at frame {frame}, within the interval",
            edit_class="scene",
            group="relations",
            action=f"End `frames` of the relation at {frame} (a weakening edit: give weakening_reason), or leave `frames` out.",
            pointers=("/graph/relations",),
        )
    return Correction(
        cause="the body slides or tips off, or the interval reaches into its motion",
        edit_class="solver",
        group="material",
        action=f"Raise the friction between {a!r} and {b!r} (now {friction:g}), or end the relation's `frames` before it moves.",
        pointers=tuple(pointer("materials", n, "friction") for n in dict.fromkeys(names)),
    )


def _apart(surfaces: Surfaces, relation: Supports, frame: int, gap: float) -> _Fault:
    a, b = relation.a, relation.b
    found = surfaces.gap(a, b, frame)
    text = f"{b!r} is {found.distance * 1e3:.4g} mm away from {a!r} at frame {frame}, contact means at most {gap * 1e3:.4g} mm"
    if frame > 0:
        correction = Correction(
            cause=f"{b!r} leaves {a!r} before its interval ends",
            edit_class="scene",
            group="relations",
            action=f"End `frames` of the relation at {frame - 1} if {b!r} is meant to move then; otherwise find what moves it.",
            pointers=("/graph/relations",),
        )
        return _Fault(frame, text, found.distance, gap, "<=", "m", correction)
    fall = drop(surfaces, b, 0)
    offset = None
    cause = f"{b!r} floats above {a!r}"
    if fall is not None and fall[1] == a:
        text += f", {fall[0] * 1e3:.4g} mm above it"
        offset = along_up(surfaces, LEFT - fall[0])
    elif fall is not None:
        cause = f"{fall[1]!r}, not {a!r}, lies beneath {b!r}"
    else:
        cause = f"nothing lies beneath {b!r}"
    return _Fault(0, text, found.distance, gap, "<=", "m", placement(surfaces, b, offset, cause))


def _scene(surfaces: Surfaces, rows: list[Row]) -> Row:
    candidate = surfaces.candidate
    free = [n for n in candidate.solids if candidate.spec.entities[n].motion == "dynamic"]
    bad = [r for r in rows if r.status == "fail"]
    open_rows = [r for r in rows if r.status == "unverified"]
    if not free and not rows:
        return make_row(
            candidate,
            row_id=RowId("support:scene"),
            predicate="every free body is held up",
            status="not_applicable",
            explanation="the specification has no free body and no supports relation",
        )
    failing = [r.first_failing_entity for r in bad if r.first_failing_entity]
    frames = [r.first_failing_frame for r in bad if r.first_failing_frame is not None]
    return make_row(
        candidate,
        row_id=RowId("support:scene"),
        predicate="every free body is held up by contact, joint or driver, and every supports relation holds",
        status="fail" if bad else "unverified" if open_rows else "pass",
        explanation=f"{len(free)} free bodies, {len(rows)} rows: {len(bad)} fail, {len(open_rows)} without evidence",
        measured=float(len(bad)),
        bound=0.0,
        comparison="<=",
        unit="1",
        entities=failing or free,
        first_failing_frame=min(frames) if frames else None,
        evidence={"rows": len(rows), "failing": [r.id for r in bad][:20], "unverified": [r.id for r in open_rows][:20]},
    )
