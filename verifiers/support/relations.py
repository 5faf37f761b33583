"""`supports` relations between solids: actual contact and a continuous chain to something static, over their interval (R92, R93)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64, rotation_matrix
from ...worlds.spec import ReleaseDriver
from ..ledgers import motion
from ..rows.corrections import WEAKER, correction, halve_any_step, halve_step, pointer
from ..rows.findings import Finding
from .bounds import LEFT
from .free_bodies import along_up, placement, size_of
from .graph import drop

if TYPE_CHECKING:
    from ...worlds.requirements import Correction
    from ...worlds.spec import Supports
    from ..rows.questions import Comparison
    from ..scene.surfaces import Surfaces
    from .graph import SupportGraph

__all__ = ["carries"]


def carries(graph: SupportGraph, relation: Supports, frames: tuple[int, int]) -> Finding:
    """Judge whether a solid carries another over an interval: contact, no overlap, beneath it, no creep, and a chain to something static."""
    surfaces = graph.surfaces
    a, b = relation.a, relation.b
    surfaces.require(a, b)
    window = slice(frames[0], frames[1] + 1)
    distance = surfaces.series(a, b)[window]
    linked = graph.linked(a, b)[window]
    gap = surfaces.contact_gap(a, b)
    creep = _creep(surfaces, a, b, window)
    faults = sorted(_faults(graph, relation, frames, distance, linked, creep), key=lambda f: f.frame or 0)
    common: dict[str, Any] = {
        "evidence": {
            "largest_gap_m": float(distance.max()) if np.isfinite(distance).all() else None,
            "least_clearance_m": float(distance.min()) if np.isfinite(distance).any() else None,
            "creep_m": float(creep.max()) if np.isfinite(creep).all() else None,
            "jointed": bool(linked.any()),
            "chain": graph.chain(b, frames[0]),
            "interval": list(frames),
        },
        "frames": frames,
        "predicate": f"{a} carries {b} over frames {frames[0]}..{frames[1]}: gap <= {gap:g} m, no overlap, {a} beneath {b}, "
        f"creep <= {surfaces.candidate.spec.simulation.limits.support_drift:g} m, chain to something static",
        "extra": [relation.model_dump(mode="json"), frames, gap],
    }
    if faults:
        hints = tuple(h for f in faults for h in f.hints)
        return replace(faults[0], text="; ".join(f.text for f in faults), hints=hints, **common)
    worst = float(distance.max()) if np.isfinite(distance).all() else 0.0
    text = f"{a!r} carries {b!r} over {len(distance)} frames: gap at most {worst * 1e3:.4g} mm, creep {creep.max() * 1e3:.4g} mm"
    if linked.all():
        text = f"a joint holds {b!r} at {a!r} over {len(distance)} frames"
    return Finding("pass", text, worst, gap, **common)


def _creep(surfaces: Surfaces, a: str, b: str, window: slice) -> F64:
    """Displacement of the centre of mass of b, seen from a, since the interval's start [m], shape (frames,)."""
    position, quaternion = surfaces.track(a, surfaces.candidate.entity(a).bodies[0].name)
    with np.errstate(invalid="ignore", over="ignore"):
        offset = motion.centers(surfaces.candidate, b) - position
        local = np.einsum("fji,fj->fi", rotation_matrix(quaternion), offset)[window]
        return np.asarray(np.linalg.norm(local - local[0], axis=1))


def _fault(
    frame: int, text: str, hint: Correction, measured: float, comparison: Comparison, bound: float, *, unit: str = "m"
) -> Finding:
    """Something wrong with a relation from `frame` on."""
    return Finding("fail", text, measured, bound, unit, frame=frame, hints=(hint,), comparison=comparison)


def _faults(
    graph: SupportGraph, relation: Supports, frames: tuple[int, int], distance: F64, linked: NDArray[np.bool_], creep: F64
) -> Iterator[Finding]:
    """Everything that is wrong, each with the first frame of it."""
    surfaces, a, b, begin = graph.surfaces, relation.a, relation.b, frames[0]
    gap, drift = surfaces.contact_gap(a, b), surfaces.candidate.spec.simulation.limits.support_drift
    bound = -(surfaces.allowed_depth(a, b) + surfaces.noise(a, b))
    window = slice(frames[0], frames[1] + 1)

    def first(wrong: NDArray[np.bool_]) -> int | None:
        return int(np.argmax(wrong)) if wrong.any() else None

    k = first(~(np.isfinite(creep)))
    if k is not None:
        yield _fault(
            begin + k, f"a pose of {a!r} or {b!r} is not finite at frame {begin + k}", _finer(surfaces), np.nan, "==", 0.0
        )
    k = first(~linked & ~(distance <= gap))
    if k is not None:
        yield _apart(surfaces, relation, begin + k, gap)
    k = first(distance < bound)
    if k is not None:
        depth = -float(distance[k])
        text = f"{b!r} overlaps {a!r} by {depth * 1e3:.4g} mm at frame {begin + k}"
        lift = along_up(surfaces, depth + LEFT) if begin + k == 0 else None
        yield _fault(begin + k, text, placement(surfaces, b, lift, f"{b!r} sinks into {a!r}"), -depth, ">=", bound)
    # What never moves needs no more of its holder than to touch it, from whichever side: a picture and its wall.
    unborne = ~linked & (distance <= gap) & ~surfaces.carries(a, b)[window]
    moves = surfaces.candidate.spec.entities[b].motion == "dynamic"
    k = first(unborne & ~_leans(graph, a, b, frames)) if moves and unborne.any() else None
    if k is not None:
        text = (
            f"{a!r} touches {b!r} at frame {begin + k} but is neither beneath it nor needed to hold it, so it does not carry it"
        )
        yield _fault(
            begin + k, text, placement(surfaces, b, None, f"{b!r} is beside or below {a!r}, not on it"), 0.0, "==", 1.0, unit="1"
        )
    k = first(~linked & (creep > drift))
    if k is not None:
        text = f"{b!r} creeps {creep.max() * 1e3:.4g} mm on {a!r}, beyond {drift * 1e3:.4g} mm from frame {begin + k} on"
        yield _fault(begin + k, text, _slips(surfaces, a, b), float(creep.max()), "<=", drift)
    k = first(~graph.grounded(a)[window])
    if k is not None:
        text = f"no chain of contacts, joints or drivers leads from {a!r} to something static at frame {begin + k}"
        fall = drop(surfaces, a, begin + k) if begin + k == 0 else None
        # What is far above the ground is there on purpose: what holds it is missing.
        offset = along_up(surfaces, LEFT - fall[0]) if fall and fall[0] <= size_of(surfaces, a) else None
        yield _fault(begin + k, text, placement(surfaces, a, offset, f"{a!r} itself is not supported"), 0.0, "==", 1.0, unit="1")


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
    cause = "the simulation became unstable"
    for solver in surfaces.candidate.spec.simulation.rigid:
        return halve_step(surfaces.candidate, solver, cause)
    return halve_any_step(cause)


def _slips(surfaces: Surfaces, a: str, b: str) -> Correction:
    spec = surfaces.candidate.spec
    names = [spec.entities[n].material for n in (a, b)]
    friction = max(spec.materials[n].friction_at_rest if n in spec.materials else 0.0 for n in names)
    released = [d.time for d in spec.simulation.drivers.values() if isinstance(d, ReleaseDriver) and d.entity == b]
    if released:
        frame = int(max(released) * spec.simulation.fps)
        return correction(
            f"{b!r} is released at frame {frame}, within the interval",
            "relations",
            f"End `frames` of the relation at {frame}{WEAKER}, or leave `frames` out.",
            pointers=("/graph/relations",),
        )
    speed = math.dist((0, 0, 0), getattr(spec.entities[b].physics, "linear_velocity", (0, 0, 0)))
    if speed > 0.0:
        return correction(
            f"{b!r} begins with {speed:.3g} m/s: what is thrown or rolls does not stand",
            "relations",
            f"End `frames` of the relation at 0, or remove it, if {b!r} is meant to set out then{WEAKER}; else take its `linear_velocity` out.",
            pointers=("/graph/relations", pointer("entities", b, "physics", "linear_velocity")),
        )
    return correction(
        "the body slides or tips off, or the interval reaches into its motion",
        "material",
        f"Raise the friction between {a!r} and {b!r} (now {friction:g}), or end the relation's `frames` before it moves.",
        pointers=tuple(pointer("materials", n, "friction") for n in dict.fromkeys(names)),
    )


def _apart(surfaces: Surfaces, relation: Supports, frame: int, gap: float) -> Finding:
    a, b = relation.a, relation.b
    found = surfaces.gap(a, b, frame)
    text = f"{b!r} is {found.distance * 1e3:.4g} mm away from {a!r} at frame {frame}, contact means at most {gap * 1e3:.4g} mm"
    if frame > 0:
        leaves = correction(
            f"{b!r} leaves {a!r} before its interval ends",
            "relations",
            f"End `frames` of the relation at {frame - 1} if {b!r} is meant to move then; otherwise find what moves it.",
            pointers=("/graph/relations",),
        )
        return _fault(frame, text, leaves, found.distance, "<=", gap)
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
    return _fault(0, text, placement(surfaces, b, offset, cause), found.distance, "<=", gap)
