"""Recovery, pins and free flight of elastic bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64, pose_of
from ....worlds.errors import EvidenceError
from ...ledgers.strains import deflections, require_deforming, strains_of
from ...rows.corrections import bake_again, correction, halve_step, pointer
from ...rows.findings import Finding
from .bounds import FLIGHT, FLIGHT_SPEED, LOAD_SHARE, REST_FRAMES, REST_SPEED, SLIP_SHARE
from .exchange import soft_impulses
from .fields import field_impulses
from .rows import change_physics, judge_frames, physics_of

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.categories.deforming import Deforming

__all__ = ["flight", "pins", "recovery"]


def recovery(candidate: Candidate, entity: str) -> Finding:
    """Finding on the shape of a body that rests at the end against its rest shape, but for what its load explains."""
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
    text = f"at rest {away[last] * 1e3:.3g} mm off its shape (largest {away.max() * 1e3:.3g} mm); {bound * 1e3:.3g} mm allowed, "
    text += f"of which its load explains {load * 1e3:.3g} mm"
    stuck = halve_step(candidate, soft.cache.index.solver, "it hangs in a tangled or caught shape")
    stiffer = change_physics([entity], "young_modulus", "it is too soft to carry itself", "stiffness", "raise young_modulus")
    wrong = (np.arange(len(away)) == last) & ~(away <= bound)
    evidence = {"peak_m": float(away.max()), "peak_frame": int(away.argmax()), "load_m": load, "size_m": size}
    return judge_frames(wrong, text, float(away[last]), bound, stuck, stiffer, evidence=evidence)


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
    """Finding on the slip of what pins hold from where their carriers have it, of the pin that is nearest to its bound."""
    soft, physics = require_deforming(candidate, entity), physics_of(candidate, entity)
    if not physics.pins:
        return Finding("not_applicable", f"{entity} has no pins")
    start = pose_of(candidate.spec.entities[entity].pose)
    worst, bound, culprit, wrong = -1.0, 0.0, "", np.zeros(0, dtype=bool)
    for key, pin in sorted(physics.pins.items()):
        held = (np.abs(soft.rest - np.array(pin.center)) <= 0.5 * np.array(pin.size) * (1 + 1e-9)).all(axis=1)
        if not held.any():
            raise EvidenceError(f"pin {key!r} holds no vertex of {entity!r}; make its box larger")
        spread = max(float(np.linalg.norm(np.ptp(soft.rest[held], axis=0))), _edge(soft))
        allowed = SLIP_SHARE * spread
        slip = np.array(
            [_slip(candidate, soft, start.apply(soft.rest[held]), held, pin.to, k) for k in range(candidate.frame_count)]
        )
        off = ~(slip <= allowed)
        most = float(np.nanmax(slip)) if np.isfinite(slip).any() else np.inf
        if (bool(off.any()), most / allowed) > (bool(wrong.any()), worst / max(bound, 1e-300)):
            worst, bound, culprit, wrong = most, allowed, key, off
    text = f"pin {culprit!r} lets the middle of what it holds go by {worst * 1e3:.3g} mm, {bound * 1e3:.3g} mm allowed"
    larger = correction(
        "the pin holds too few nodes",
        "joints",
        f"make the box of pin {culprit!r} larger",
        pointers=(pointer("entities", entity, "physics", "pins", culprit),),
    )
    known = worst if np.isfinite(worst) else None
    return judge_frames(wrong, text, known, bound, larger, evidence={"pin": culprit})


def _edge(soft: Deforming) -> float:
    """Edge of a cell [m]."""
    mesh = next(iter(soft.meshes.values()))
    return float((np.ptp(mesh.vertices, axis=0) / np.maximum(mesh.cells, 1)).min())


def _slip(candidate: Candidate, soft: Deforming, placed: F64, held: NDArray[np.bool_], to: str | None, frame: int) -> float:
    """Distance of the middle of what is held from where its carrier has it [m]."""
    wanted = placed.mean(axis=0)
    if to is not None:
        wanted = candidate.pose(to, frame).apply(candidate.pose(to, 0).inverse().apply(wanted[None]))[0]
        here = soft.positions(frame)[held].mean(axis=0) - (soft.positions(0)[held].mean(axis=0) - placed.mean(axis=0))
        return float(np.linalg.norm(here - wanted))
    return float(np.linalg.norm(soft.positions(frame)[held].mean(axis=0) - wanted))


def flight(candidate: Candidate, entity: str) -> Finding:
    """Finding on the centre of mass against a free fall over intervals in which gravity alone acts."""
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
    wrong = np.concatenate([[False], alone & ~(off <= bound)])  # an interval fails at the frame that ends it
    worst = float(np.max(np.where(alone, np.nan_to_num(off, nan=np.inf), 0.0)))
    text = (
        f"velocity of the centre of mass is off free fall by {worst:.3g} m/s per frame at most, over {int(alone.sum())} intervals"
    )
    known, evidence = worst if np.isfinite(worst) else None, {"intervals": int(alone.sum())}
    return judge_frames(wrong, text, known, bound, bake_again(), evidence=evidence)
