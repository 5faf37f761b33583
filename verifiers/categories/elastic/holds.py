"""Recovery, pins and free flight of elastic bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64, pose_of
from ....worlds.errors import EvidenceError
from ...ledgers.strains import deflections, require_deforming, strains_of
from ...rows.corrections import correction, pointer
from ...rows.findings import Finding
from .exchange import soft_impulses
from .fields import field_impulses
from .rows import physics_of

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.categories.deforming import Deforming

__all__ = ["flight", "pins", "recovery"]

REST_SPEED = 0.01
"""[m/s] Own choice: slower than one can see on a body of centimetres."""
REST_FRAMES = 3
"""Own choice: last frames over which a body must be that slow to count as at rest."""
LOAD_SHARE = 3.0
"""Own choice: a static estimate from beam and column formulas stays within this factor of the truth for a compact body."""
SLIP_SHARE = 0.1
"""Own choice: of the spread of what a pin holds; cells beside a pinned node deform, and their vertices with them."""
FLIGHT = 0.02
"""Of what gravity gives in a frame; centres of vertices and of nodes differ by the second order of the strain."""
FLIGHT_SPEED = 2e-4
"""[m/s] Single precision of cached velocities, with room."""


def recovery(candidate: Candidate, entity: str) -> Finding:
    """Row `recovery`."""
    soft, physics = require_deforming(candidate, entity), physics_of(candidate, entity)
    away = deflections(candidate, entity)
    if physics.yield_strain > 0:
        text = f"the contract lets {entity} keep another shape from a strain of {physics.yield_strain:g} on"
        return Finding("not_applicable", text)
    last = candidate.last_frame
    speeds = np.array([np.linalg.norm(soft.velocities(k), axis=1).max() for k in range(max(0, last - REST_FRAMES + 1), last + 1)])
    if not np.isfinite(away).all() or not np.isfinite(speeds).all():
        return Finding("fail", "vertices are not finite", frame=int(np.argmax(~np.isfinite(away))))
    if (speeds > REST_SPEED).any():
        text = f"{entity} still moves at {speeds.max():.3g} m/s in the last {len(speeds)} frames: there is no rest to judge"
        return Finding("not_applicable", text, evidence={"deflection_m": float(away[last])})
    size = float(np.linalg.norm(np.ptp(soft.rest, axis=0)))
    load = _load(candidate, soft, entity)
    bound = physics.recovery * size + load
    ok = bool(away[last] <= bound)
    text = f"at rest {away[last] * 1e3:.3g} mm off its shape (largest {away.max() * 1e3:.3g} mm); {bound * 1e3:.3g} mm allowed, "
    text += f"of which its load explains {load * 1e3:.3g} mm"
    stuck = correction(
        "it hangs in a tangled or caught shape",
        "step",
        "halve the step",
        pointers=(f"/simulation/solvers/{soft.cache.index.solver}/settings/step",),
    )
    stiffer = correction(
        "it is too soft to carry itself",
        "stiffness",
        "raise young_modulus",
        pointers=(pointer("entities", entity, "physics", "young_modulus"),),
    )
    return Finding(
        "pass" if ok else "fail",
        text,
        measured=float(away[last]),
        bound=bound,
        unit="m",
        frame=None if ok else last,
        hints=(stuck, stiffer),
        evidence={"peak_m": float(away.max()), "peak_frame": int(away.argmax()), "load_m": load, "size_m": size},
    )


def _load(candidate: Candidate, soft: Deforming, entity: str) -> float:
    """Deflection that weight and logged contacts of the last frames explain [m]: a column's, and a beam's where it is held or long."""
    physics, plan = physics_of(candidate, entity), candidate.spec.simulation
    extent = np.ptp(soft.rest, axis=0)
    length, thin = float(extent.max()), float(extent.min())
    area = strains_of(soft, candidate.frame_count).rest / length
    force = float(soft.masses.sum() * np.linalg.norm(plan.gravity))
    log = soft.cache.ragged("contact/pair", "contact/impulse")[candidate.last_frame]
    row = soft.cache.index.colliders.index(entity)
    touching = (log["contact/pair"] == row).any(axis=1)
    force += float(np.abs(log["contact/impulse"][touching]).sum()) * plan.fps
    force += float(np.linalg.norm(_given(candidate, soft)[candidate.last_frame])) * plan.fps
    column = force * length / (physics.young_modulus * area)
    beam = force * length**3 / (8.0 * physics.young_modulus * area * thin**2 / 12.0)
    bends = bool(physics.pins) or length > 3.0 * thin
    return LOAD_SHARE * (column + (beam if bends else 0.0))


def _given(candidate: Candidate, soft: Deforming) -> F64:
    """Impulse of coupled cloth, grains and liquids, and of force fields, over each frame [N s], shape (F, 3)."""
    row = [name.split("/", 1)[0] for name in soft.cache.index.deformables].index(soft.entity)
    return np.asarray(soft_impulses(candidate, soft.cache)[:, row, :3] + field_impulses(candidate, soft.cache)[:, row])


def pins(candidate: Candidate, entity: str) -> Finding:
    """Row `pins`: what a pin holds, against where its carrier has it."""
    soft, physics = require_deforming(candidate, entity), physics_of(candidate, entity)
    if not physics.pins:
        return Finding("not_applicable", f"{entity} has no pins")
    start = pose_of(candidate.spec.entities[entity].pose)
    worst, bound, culprit, frame = -1.0, 0.0, "", None
    for key, pin in sorted(physics.pins.items()):
        held = (np.abs(soft.rest - np.array(pin.center)) <= 0.5 * np.array(pin.size) * (1 + 1e-9)).all(axis=1)
        if not held.any():
            raise EvidenceError(f"pin {key!r} holds no vertex of {entity!r}; make its box larger")
        spread = max(float(np.linalg.norm(np.ptp(soft.rest[held], axis=0))), _edge(soft))
        allowed = SLIP_SHARE * spread
        slip = np.array(
            [_slip(candidate, soft, start.apply(soft.rest[held]), held, pin.to, k) for k in range(candidate.frame_count)]
        )
        wrong = ~(slip <= allowed)
        most = float(np.nanmax(slip)) if np.isfinite(slip).any() else np.inf
        first = int(np.argmax(wrong)) if wrong.any() else None
        if (first is not None, most / allowed) > (frame is not None, worst / max(bound, 1e-300)):
            worst, bound, culprit, frame = most, allowed, key, first
    text = f"pin {culprit!r} lets the middle of what it holds go by {worst * 1e3:.3g} mm, {bound * 1e3:.3g} mm allowed"
    larger = correction(
        "the pin holds too few nodes",
        "joints",
        f"make the box of pin {culprit!r} larger",
        pointers=(pointer("entities", entity, "physics", "pins", culprit),),
    )
    return Finding(
        "pass" if frame is None else "fail",
        text,
        measured=worst if np.isfinite(worst) else None,
        bound=bound,
        unit="m",
        frame=frame,
        hints=(larger,),
        evidence={"pin": culprit},
    )


def _edge(soft: Deforming) -> float:
    """Edge of a cell [m]."""
    mesh = next(iter(soft.meshes.values()))
    return float((np.ptp(mesh.vertices, axis=0) / np.maximum(mesh.cells, 1)).min())


def _slip(candidate: Candidate, soft: Deforming, placed: F64, held: NDArray[np.bool_], to: str | None, frame: int) -> float:
    """How far the middle of what is held is from where its carrier has it [m]."""
    wanted = placed.mean(axis=0)
    if to is not None:
        wanted = candidate.pose(to, frame).apply(candidate.pose(to, 0).inverse().apply(wanted[None]))[0]
        here = soft.positions(frame)[held].mean(axis=0) - (soft.positions(0)[held].mean(axis=0) - placed.mean(axis=0))
        return float(np.linalg.norm(here - wanted))
    return float(np.linalg.norm(soft.positions(frame)[held].mean(axis=0) - wanted))


def flight(candidate: Candidate, entity: str) -> Finding:
    """Row `flight`: Newton's second law of the whole body over intervals in which gravity alone acts."""
    soft, physics, plan = require_deforming(candidate, entity), physics_of(candidate, entity), candidate.spec.simulation
    count = candidate.frame_count
    speeds = np.array([soft.velocity(k) for k in range(count)])
    row = soft.cache.index.colliders.index(entity)
    pairs = [f["contact/pair"] for f in soft.cache.ragged("contact/pair", "contact/impulse")]
    alone = np.array([not (p == row).any() for p in pairs[1:count]], dtype=bool)
    alone &= ~_given(candidate, soft)[1:count].any(axis=1)
    released = [d.time for d in plan.drivers.values() if d.kind == "release" and d.entity == entity]
    alone &= np.arange(count - 1) / plan.fps >= max(released, default=0.0) - 1e-9
    if physics.pins or any(d.kind == "field" for d in plan.drivers.values()):
        alone[:] = False
    if not alone.any():
        return Finding("not_applicable", f"something touches, holds or blows {entity} in every interval")
    fall = np.array(plan.gravity) / plan.fps
    off = np.linalg.norm(np.diff(speeds, axis=0) - fall, axis=1)
    bound = FLIGHT * float(np.linalg.norm(fall)) + FLIGHT_SPEED
    wrong = alone & ~(off <= bound)
    frame = int(np.argmax(wrong)) + 1 if wrong.any() else None
    worst = float(np.max(np.where(alone, np.nan_to_num(off, nan=np.inf), 0.0)))
    text = (
        f"velocity of the centre of mass is off free fall by {worst:.3g} m/s per frame at most, over {int(alone.sum())} intervals"
    )
    again = correction("the cache is of another run, or was edited", "interval", "bake again", pointers=("/simulation/frames",))
    return Finding(
        "pass" if frame is None else "fail",
        text,
        measured=worst if np.isfinite(worst) else None,
        bound=bound,
        unit="m/s",
        frame=frame,
        hints=(again,),
        evidence={"intervals": int(alone.sum())},
    )
