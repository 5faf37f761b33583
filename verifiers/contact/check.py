"""Contact: no unintended overlap of visible surfaces on any written frame, and none skipped between frames (R108, R109).

Same criterion and same eps as the static check. Every pair of which one moves is inspected; static pairs are the
static check's. Bodies that pass a static surface between two frames are found by their paths.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from ...worlds.categories.elastic.audit import elastic_problems
from ...worlds.categories.fracture.audit import crumble_limit, fracture_problems
from ...worlds.categories.fracture.facts import crumble_of
from ...worlds.errors import EvidenceError
from ...worlds.requirements import Correction, RowId
from ..rows.guards import guarded, guarded_rows, pointer
from ..rows.verdicts import make_row
from ..scene.own_bodies import own_gap, own_pairs
from ..scene.surfaces import surfaces_of
from .tunnelling import find_passages

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Row
    from ...worlds.spec import WorldSpec
    from ..scene.own_bodies import OwnPair
    from ..scene.surfaces import Gap, Surfaces
    from .tunnelling import Passage

__all__ = ["check"]

SKIN_FACTOR = 1.5
"""Own choice: the suggested skin covers the measured depth this many times, since finer steps shift the deepest frame."""
SKIN_SHARE = 0.9
"""Share of the contact tolerance that two skins may take (`worlds/audits/audit.py`)."""
SKIN_MAX = 0.02
"""[m] Largest skin that the specification takes."""
STEP_MIN = 2e-5
"""[s] Smallest step that the specification takes."""
CRUMBLE_FACTOR = 1.2
"""Own choice: faces crumble by so many times the overlap that was measured: what yields more lets the next blow go deeper."""
TUNNEL_SHARE = 0.25
"""Own choice: deeper than this share of the thinner body, in two frames running, is no contact any more. Depth is that of
the deepest surface point and cannot exceed half the thinner body, so this is half of what is possible."""

Pair = tuple[str, str]


OVERLAP = "visible surfaces do not overlap on any written frame"


@guarded("contact", OVERLAP)
def check(candidate: Candidate) -> list[Row]:
    """One row per pair that ever comes within twice the contact tolerance, one per passage, and one for the scene."""
    if candidate.stage == "static":
        raise EvidenceError("nothing is simulated yet; call probe_sim")
    surfaces = surfaces_of(candidate)
    peaks = _peaks(candidate)
    rows: list[Row] = []
    near = [(a, b, series, None) for (a, b), series in surfaces.moving.items()]
    own = [(e, e, np.min([p.series for p in pairs], axis=0), pairs) for e, pairs in own_pairs(surfaces, _all(surfaces)).items()]
    for a, b, series, pairs in [*near, *own]:
        rows += guarded_rows(
            candidate,
            lambda a=a, b=b, series=series, pairs=pairs: [_pair(surfaces, a, b, series, peaks, pairs)],  # type: ignore[misc]
            row_id=RowId("contact", a, b),
            predicate=_predicate(surfaces, a, b),
            entities=(a, b),
        )
    scene, *through = guarded_rows(candidate, lambda: _between(surfaces, rows), row_id=RowId("contact:scene"), predicate=OVERLAP)
    return [scene, *rows, *through]


def _between(surfaces: Surfaces, rows: list[Row]) -> list[Row]:
    """The row of the scene and one for each passage between frames."""
    passages = find_passages(surfaces, known={(r.subject[0], r.subject[1]) for r in rows if r.status == "fail"})
    through = [_through(surfaces, passage) for passage in passages.found]
    return [_scene(surfaces, rows, through, passages.inspected), *through]


def _all(surfaces: Surfaces) -> NDArray[np.intp]:
    return np.arange(surfaces.frames)


def _gap(surfaces: Surfaces, a: str, b: str, frame: int, own: list[OwnPair] | None) -> Gap:
    """Exact clearance at one frame, of two entities or of two bodies of one."""
    if own is None:
        return surfaces.gap(a, b, frame)
    return own_gap(surfaces, min(own, key=lambda pair: float(pair.series[frame])), frame)


def _predicate(surfaces: Surfaces, a: str, b: str) -> str:
    allowed = surfaces.allowed_depth(a, b)
    eps = f"{allowed:g} m (declared fastened)" if allowed else f"eps, eps = query noise {surfaces.noise(a, b):.2g} m"
    if a == b:
        return f"clearance between bodies of {a} that are not joined >= -{eps}, at every frame"
    return f"clearance({a}, {b}) >= -{eps}, at every frame"


def _peaks(candidate: Candidate) -> dict[Pair, tuple[float, int]]:
    """Smallest distance of collision shapes inside a frame [m] and its frame, per pair in the contact log."""
    found: dict[Pair, tuple[float, int]] = {}
    for cache in candidate.rigid_caches.values():
        names = cache.index.colliders
        try:
            frames = cache.ragged("contact/pair", "contact/min_gap")
        except EvidenceError:
            continue  # evidence beside the verdict: the row then says that there is none
        for frame, channels in enumerate(frames[: candidate.frame_count]):
            for (i, j), gap in zip(channels["contact/pair"], channels["contact/min_gap"], strict=True):
                for pair in ((names[i], names[j]), (names[j], names[i])):
                    if math.isfinite(gap) and gap < found.get(pair, (math.inf, 0))[0]:
                        found[pair] = (float(gap), frame)
    return found


def _pair(
    surfaces: Surfaces, a: str, b: str, series: F64, peaks: dict[Pair, tuple[float, int]], own: list[OwnPair] | None
) -> Row:
    allowed, noise = surfaces.allowed_depth(a, b), surfaces.noise(a, b)
    bound = -(allowed + noise)
    worst = int(np.argmin(series))
    bad = np.flatnonzero(series < bound)
    evidence: dict[str, Any] = {"worst_frame": worst, "frames_overlapping": len(bad), "eps_m": noise, "allowed_depth_m": allowed}
    if (a, b) in peaks:
        evidence["peak_inside_frames_m"], evidence["peak_frame"] = peaks[a, b]
    order = (a, b)
    corrections: list[Correction] = []
    contract = surfaces.candidate.spec.entities[a]
    if a == b and contract.breakable is not None:
        evidence["crumble_m"], evidence["crumble_limit_m"] = allowed, crumble_limit(contract)
    if len(bad):
        gap = _gap(surfaces, a, b, int(bad[0]), own)
        order = (a, b) if not surfaces.is_static(a) else (b, a)
        tunnel = _tunnels(surfaces, a, b, series)
        evidence |= {
            "point_a": gap.point_a.tolist(),
            "point_b": gap.point_b.tolist(),
            "part_a": gap.part_a,
            "part_b": gap.part_b,
            "tunnelling": tunnel,
            "depth_at_first_m": -gap.distance,
        }
        corrections = _corrections(surfaces, order, ((a, gap.part_a), (b, gap.part_b)), bad, float(-series[worst]), tunnel=tunnel)
        text = (
            f"{a}/{gap.part_a} and {b}/{gap.part_b} overlap at {len(bad)} of {surfaces.frames} frames, first at frame {bad[0]} "
            f"by {-gap.distance * 1e3:.4g} mm, worst at frame {worst} by {-series[worst] * 1e3:.4g} mm"
        )
    else:
        text = f"{a!r} and {b!r} come within {series[worst] * 1e3:.4g} mm at frame {worst} and never overlap beyond the bound"
    return make_row(
        surfaces.candidate,
        row_id=RowId("contact", a, b),
        predicate=_predicate(surfaces, a, b),
        status="fail" if len(bad) else "pass",
        explanation=text,
        measured=float(series[worst]),
        bound=bound,
        comparison=">=",
        unit="m",
        entities=order,
        first_failing_frame=int(bad[0]) if len(bad) else None,
        corrections=corrections,
        evidence=evidence,
        extra=[allowed],
    )


def _tunnels(surfaces: Surfaces, a: str, b: str, series: F64) -> bool:
    """Whether the pair is deeper than `TUNNEL_SHARE` of the thinner body in two consecutive frames."""
    deep = series < -TUNNEL_SHARE * min(surfaces.thickness(a), surfaces.thickness(b))
    return bool((deep[1:] & deep[:-1]).any())


def _solver_of(surfaces: Surfaces, *entities: str) -> str | None:
    for name, solver in surfaces.candidate.spec.simulation.rigid.items():
        if set(entities) <= set(solver.members):
            return name
    return None


def _corrections(
    surfaces: Surfaces, order: Pair, parts: tuple[Pair, Pair], bad: NDArray[np.intp], depth: float, *, tunnel: bool
) -> list[Correction]:
    """Ranked: what makes contact impossible first, then a wrong start, then resolution."""
    mover, other = order
    spec = surfaces.candidate.spec
    found = _not_colliding(surfaces, parts)
    if bad[0] == 0:
        found.append(
            Correction(
                cause="the two overlap before anything moves",
                edit_class="scene",
                group="placement",
                action=f"Move {mover!r} by {depth * 1e3:.4g} mm out of {other!r}; see the row interpenetration:{mover}:{other}.",
                pointers=(pointer("entities", mover, "pose"),),
            )
        )
    if spec.entities[mover].motion == "kinematic":
        plan = spec.simulation.drivers
        drivers = [pointer("simulation", "drivers", n) for n, d in plan.items() if getattr(d, "entity", "") == mover]
        found.append(
            Correction(
                cause=f"the authored path of {mover!r} leads through {other!r}",
                edit_class="solver",
                group="drivers",
                action=f"Change the path of {mover!r} near frame {bad[0]} to stay {depth * 1e3:.4g} mm farther from {other!r}.",
                pointers=tuple(drivers),
            )
        )
    solver = _solver_of(surfaces, mover, other)
    if solver is None:
        found.append(
            Correction(
                cause="no solver instance has both as members, so they cannot feel each other",
                edit_class="scene",
                group="shape",
                action=f"List {mover!r} and {other!r} as members of one solver instance.",
                pointers=("/simulation/solvers",),
            )
        )
        return found
    return [*found, *_crumbled(surfaces, order, depth), *_resolution(surfaces, solver, depth, tunnel=tunnel)]


def _not_colliding(surfaces: Surfaces, parts: tuple[Pair, Pair]) -> list[Correction]:
    """Reasons why the engine does not keep two entities apart at all, given the part of each that overlaps."""
    spec = surfaces.candidate.spec
    found = []
    for entity, part in parts:
        content = spec.entities[entity].parts.get(part)
        if content is not None and not content.collides:
            path = pointer("entities", entity, "parts", part, "collides")
            found.append(
                Correction(
                    cause=f"part {part!r} of {entity!r} does not collide",
                    edit_class="scene",
                    group="shape",
                    action=f"Let {entity}/{part} collide, or move it out of the way.",
                    pointers=(path,),
                    patch=({"op": "add", "path": path, "value": True},),
                )
            )
    for name, joint in spec.simulation.joints.items():
        if {joint.parent, joint.child} == {entity for entity, _ in parts} and getattr(joint, "collide", True) is False:
            path = pointer("simulation", "joints", name, "collide")
            found.append(
                Correction(
                    cause=f"joint {name!r} switches contacts between its two bodies off",
                    edit_class="scene",
                    group="joints",
                    action=f"Set `collide` of joint {name!r}, or declare the overlap at the joint as `fastened` with its depth.",
                    pointers=(path,),
                    patch=({"op": "add", "path": path, "value": True},),
                )
            )
    return found


def _crumbled(surfaces: Surfaces, order: Pair, depth: float) -> list[Correction]:
    """Of pieces of one body that were pressed together: faces that crumble as far, where the audit lets them."""
    entity = surfaces.candidate.spec.entities[order[0]]
    if order[0] != order[1] or entity.breakable is None:
        return []
    most, now = crumble_limit(entity), crumble_of(entity.breakable, surfaces.candidate.entity(order[0]))
    if depth > most:
        return []
    path = pointer("entities", order[0], "breakable", "bond", "crumble")
    wanted = math.floor(min(most, CRUMBLE_FACTOR * depth) * 1e6) / 1e6
    return [
        Correction(
            cause=f"pieces of {order[0]!r} are pressed together further than the {now * 1e3:.4g} mm that their faces crumble",
            edit_class="solver",
            group="bonds",
            action=f"Let faces crumble over {wanted * 1e3:.4g} mm, the overlap and some to spare; at most {most * 1e3:.4g} mm.",
            pointers=(path,),
            patch=({"op": "add", "path": path, "value": wanted},),
        )
    ]


def _refused(spec: WorldSpec, solver: str, skin: float) -> bool:
    """Whether the schema or the audit would not take this skin [m]."""
    # Two skins must stay below the contact tolerance.
    if skin > min(SKIN_MAX, SKIN_SHARE * spec.simulation.limits.contact_gap / 2):
        return True
    rigid = spec.simulation.rigid[solver]
    wider = rigid.model_copy(update={"settings": rigid.settings.model_copy(update={"skin": skin})})
    plan = spec.simulation.model_copy(update={"solvers": {**spec.simulation.solvers, solver: wider}})
    changed = spec.model_copy(update={"simulation": plan})
    place = pointer("simulation", "solvers", solver, "settings", "skin")
    return any(p.pointer == place for p in (*fracture_problems(changed), *elastic_problems(changed)))


def _resolution(surfaces: Surfaces, solver: str, depth: float, *, tunnel: bool) -> list[Correction]:
    settings = surfaces.candidate.spec.simulation.rigid[solver].settings
    path = pointer("simulation", "solvers", solver, "settings")
    skin = math.ceil((settings.skin + SKIN_FACTOR * depth) * 1e5) / 1e5
    wider = Correction(
        cause="the collision skin is thinner than the overlap that one step allows",
        edit_class="solver",
        group="contact",
        action=f"Raise the skin of solver {solver!r} from {settings.skin * 1e3:.4g} mm to {skin * 1e3:.4g} mm "
        f"(+ {SKIN_FACTOR:g} x the overlap of {depth * 1e3:.4g} mm).",
        pointers=(path + "/skin",),
        patch=({"op": "add", "path": path + "/skin", "value": skin},),
    )
    offered = [] if _refused(surfaces.candidate.spec, solver, skin) else [wider]
    step = max(STEP_MIN, settings.step / (4.0 if tunnel else 2.0))
    if step == settings.step and (settings.speculative or not tunnel):
        return offered
    finer = Correction(
        cause="the bodies pass through each other within few steps" if tunnel else "the step is too long for this contact",
        edit_class="solver",
        group="step",
        action=f"Cut the step of solver {solver!r} from {settings.step:g} s to {step:g} s"
        + (" and switch `speculative` contacts on." if tunnel and not settings.speculative else "."),
        pointers=(path + "/step", path + "/speculative"),
        patch=(
            {"op": "add", "path": path + "/step", "value": step},
            *(({"op": "add", "path": path + "/speculative", "value": True},) if tunnel else ()),
        ),
    )
    return [finer, *offered] if tunnel else [*offered, finer]


def _through(surfaces: Surfaces, passage: Passage) -> Row:
    order = (passage.entity, passage.through)
    solver = _solver_of(surfaces, *order)
    point = ", ".join(f"{c:.4g}" for c in passage.point)
    parts = ((passage.entity, passage.parts[0]), (passage.through, passage.parts[1]))
    felt = "although the engine felt a contact" if passage.felt else "and the engine felt no contact of the two"
    resolution = _resolution(surfaces, solver, passage.depth, tunnel=True) if solver else []
    return make_row(
        surfaces.candidate,
        row_id=RowId("contact:through", passage.entity, passage.through),
        predicate=f"{passage.entity} does not pass through {passage.through} between two frames: overlap on every path that "
        f"the states allow <= {TUNNEL_SHARE:g} of the thinner wall",
        status="fail",
        explanation=f"{passage.entity!r} moves {passage.travel:.4g} m between frames {passage.frame - 1} and {passage.frame}, "
        f"overlaps {passage.through!r} by {passage.depth * 1e3:.4g} mm on the way at ({point}) m, {felt}",
        measured=passage.depth,
        bound=passage.bound,
        comparison="<=",
        unit="m",
        entities=order,
        first_failing_frame=passage.frame,
        corrections=[*_not_colliding(surfaces, parts), *resolution],
        evidence={
            "point": passage.point.tolist(),
            "travel_m": passage.travel,
            "felt": passage.felt,
            "parts": list(passage.parts),
        },
        extra=[surfaces.allowed_depth(*order)],
    )


def _scene(surfaces: Surfaces, rows: list[Row], through: list[Row], inspected: int) -> Row:
    candidate = surfaces.candidate
    movers = [n for n in candidate.solids if not surfaces.is_static(n)]
    bad = [r for r in [*rows, *through] if r.status == "fail"]
    broken = dict(sorted(surfaces.broken.items(), key=lambda item: item[1]))
    wanted = candidate.spec.simulation.frames
    short = candidate.stage == "full" and surfaces.frames < wanted
    unverified = short or bool(surfaces.missing) or any(r.status == "unverified" for r in rows)
    worst = min((float(s.min()) for p, s in surfaces.moving.items() if surfaces.allowed_depth(*p) == 0.0), default=None)
    frames = sorted([r.first_failing_frame for r in bad if r.first_failing_frame is not None] + list(broken.values()))
    if broken:
        name, frame = next(iter(broken.items()))
        text = f"the pose of {name!r} is not finite or no rotation from frame {frame} on"
    elif surfaces.missing:
        text = f"{len(surfaces.missing)} entities cannot be inspected: {next(iter(surfaces.missing.values()))}"
    elif short:
        text = f"only {surfaces.frames} of {wanted} frames are there"
    else:
        text = (
            f"{len(movers)} moving entities among {len(candidate.solids)}, {surfaces.frames} frames: "
            f"{len(rows)} pairs within {surfaces.reach:g} m, {len(bad)} rows fail, {inspected} fast moves of pairs tested for passages"
        )
    failing = [*broken, *(r.first_failing_entity for r in bad if r.first_failing_entity)]
    return make_row(
        candidate,
        row_id=RowId("contact:scene"),
        predicate="every pair that can touch is inspected at every frame and none overlaps",
        status="fail" if bad or broken else "unverified" if unverified else "pass",
        explanation=text,
        measured=float(len(bad) + len(broken)),
        bound=0.0,
        comparison="<=",
        unit="1",
        entities=failing or movers,
        first_failing_frame=frames[0] if frames else None,
        evidence={
            "pairs_near": len(rows),
            "frames": surfaces.frames,
            "worst_clearance_m": worst,
            "fast_moves": inspected,
            "overlapping": [r.id for r in bad][:20],
            "missing": list(surfaces.missing)[:20],
            "broken": broken,
        },
    )
