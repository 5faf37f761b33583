"""Contact: no unintended overlap of visible surfaces on any written frame, none skipped between frames, and no push of what is not drawn (R108, R109).

Same criterion and same eps as the static check. Every pair of which one moves is inspected; static pairs are the
static check's. Bodies that pass a static surface between two frames are found by their paths.
"""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from ...worlds.categories.fracture.audit import crumble_limit
from ...worlds.errors import EvidenceError
from ..rows.answers import guarded, row_of, rows_of
from ..rows.findings import Finding
from ..scene.own_bodies import own_gap, own_pairs
from ..scene.surfaces import surfaces_of
from .bounds import TUNNEL_SHARE
from .corrections import filled_corrections, finer_contact, not_colliding, overlap_corrections, solver_of, standing_out
from .drawn import find_unseen
from .questions import CONTACT_SCENE, DRAWN, OVERLAP, THROUGH
from .tunnelling import find_passages

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Correction, Row
    from ..scene.own_bodies import OwnPair
    from ..scene.surfaces import Gap, Surfaces
    from .drawn import Unseen
    from .tunnelling import Passage

__all__ = ["check"]

Pair = tuple[str, str]


@guarded(CONTACT_SCENE)
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
        judge = partial(_pair, surfaces, (a, b), series, peaks, pairs)
        rows.append(row_of(candidate, OVERLAP, (a, b), judge, entities=(a, b)))
    scene, *through = rows_of(candidate, CONTACT_SCENE, (), partial(_between, surfaces, rows))
    return [scene, *rows, *through]


def _between(surfaces: Surfaces, rows: list[Row]) -> list[Row]:
    """The row of the scene, one for each passage between frames, and one for each pair that pushes where nothing is drawn."""
    passages = find_passages(surfaces, known={(r.subject[0], r.subject[1]) for r in rows if r.status == "fail"})
    candidate = surfaces.candidate
    through = [row_of(candidate, THROUGH, (p.entity, p.through), _through(surfaces, p)) for p in passages.found]
    unseen, _pushes = find_unseen(surfaces)
    through += [row_of(candidate, DRAWN, (u.a, u.b), _apart(surfaces, u)) for u in unseen]
    return [row_of(candidate, CONTACT_SCENE, (), _scene(surfaces, rows, through, passages.inspected)), *through]


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
    surfaces: Surfaces, pair: Pair, series: F64, peaks: dict[Pair, tuple[float, int]], own: list[OwnPair] | None
) -> Finding:
    a, b = pair
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
        corrections = overlap_corrections(
            surfaces, order, ((a, gap.part_a), (b, gap.part_b)), bad, float(-series[worst]), tunnel=tunnel
        )
        text = (
            f"{a}/{gap.part_a} and {b}/{gap.part_b} overlap at {len(bad)} of {surfaces.frames} frames, first at frame {bad[0]} "
            f"by {-gap.distance * 1e3:.4g} mm, worst at frame {worst} by {-series[worst] * 1e3:.4g} mm"
        )
    else:
        text = f"{a!r} and {b!r} come within {series[worst] * 1e3:.4g} mm at frame {worst} and never overlap beyond the bound"
    return Finding(
        "fail" if len(bad) else "pass",
        text,
        float(series[worst]),
        bound,
        frame=int(bad[0]) if len(bad) else None,
        hints=tuple(corrections),
        evidence=evidence,
        entities=order,
        predicate=_predicate(surfaces, a, b),
        extra=[allowed],
    )


def _tunnels(surfaces: Surfaces, a: str, b: str, series: F64) -> bool:
    """True if the pair is deeper than `TUNNEL_SHARE` of the thinner body in two consecutive frames."""
    deep = series < -TUNNEL_SHARE * min(surfaces.thickness(a), surfaces.thickness(b))
    return bool((deep[1:] & deep[:-1]).any())


def _through(surfaces: Surfaces, passage: Passage) -> Finding:
    order = (passage.entity, passage.through)
    solver = solver_of(surfaces, *order)
    point = ", ".join(f"{c:.4g}" for c in passage.point)
    parts = ((passage.entity, passage.parts[0]), (passage.through, passage.parts[1]))
    felt = "although the engine felt a contact" if passage.felt else "and the engine felt no contact of the two"
    resolution = finer_contact(surfaces, solver, passage.depth, tunnel=True) if solver else []
    return Finding(
        "fail",
        f"{passage.entity!r} moves {passage.travel:.4g} m between frames {passage.frame - 1} and {passage.frame}, "
        f"overlaps {passage.through!r} by {passage.depth * 1e3:.4g} mm on the way at ({point}) m, {felt}",
        passage.depth,
        passage.bound,
        frame=passage.frame,
        hints=(*not_colliding(surfaces, parts), *resolution),
        evidence={
            "point": passage.point.tolist(),
            "travel_m": passage.travel,
            "felt": passage.felt,
            "parts": list(passage.parts),
        },
        entities=order,
        predicate=f"{passage.entity} does not pass through {passage.through} between two frames: overlap on every path that "
        f"the states allow <= {TUNNEL_SHARE:g} of the thinner wall",
        extra=[surfaces.allowed_depth(*order)],
    )


def _apart(surfaces: Surfaces, unseen: Unseen) -> Finding:
    a, b = unseen.a, unseen.b
    return Finding(
        "fail",
        f"{a!r} and {b!r} push each other in {unseen.frames} frames, first up to frame {unseen.frame}, where what is drawn of them "
        f"stays {unseen.gap * 1e3:.4g} mm apart or more: what collides is not what is built",
        unseen.gap,
        unseen.bound,
        frame=unseen.frame,
        hints=tuple(filled_corrections(surfaces, (a, b))),
        evidence={"frames_apart": unseen.frames, "standing_out_m": {n: standing_out(surfaces, n) for n in (a, b)}},
        entities=(a, b),
    )


def _scene(surfaces: Surfaces, rows: list[Row], through: list[Row], inspected: int) -> Finding:
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
    return Finding(
        "fail" if bad or broken else "unverified" if unverified else "pass",
        text,
        float(len(bad) + len(broken)),
        0.0,
        frame=frames[0] if frames else None,
        evidence={
            "pairs_near": len(rows),
            "frames": surfaces.frames,
            "worst_clearance_m": worst,
            "fast_moves": inspected,
            "overlapping": [r.id for r in bad][:20],
            "missing": list(surfaces.missing)[:20],
            "broken": broken,
        },
        entities=tuple(failing or movers),
    )
