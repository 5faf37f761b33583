"""Impulses and work of force fields on elastic bodies, against those of the declared fields (R18, R63, R102).

The fields are asked again at the vertices of every two frames, masses lumped to them and
a medium meeting the faces that face it. Between the frames the mean of both ends holds; how far they differ is left open.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ....physics.drag import face_drag
from ....worlds.arrays import F64
from ....worlds.errors import EvidenceError
from ....worlds.fields import Fields, fields_of
from ...ledgers.strains import require_deforming
from ...rows.corrections import bake_again
from ...rows.findings import Finding
from .bounds import FIELD
from .rows import judge_frames, physics_of

if TYPE_CHECKING:
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate
    from ....worlds.categories.deforming import Deforming
    from ....worlds.spec import ElasticPhysics

__all__ = ["field_impulses", "field_work", "fields"]


def feels_fields(candidate: Candidate, cache: Cache) -> bool:
    """Whether a field acts on an elastic member of the instance."""
    return any(fields_of(candidate.spec, n.split("/", 1)[0]) for n in cache.index.deformables)


def field_impulses(candidate: Candidate, cache: Cache) -> F64:
    """Impulses of fields on elastic members over each frame [N s], shape (F, bodies, 3); zeros where none acts.

    Raises:
        EvidenceError: the channel is missing or has another shape.
    """
    wanted = (cache.index.frames, len(cache.index.deformables), 3)
    if not feels_fields(candidate, cache):
        return np.zeros(wanted)
    found = np.asarray(cache.series("field/soft"), dtype=np.float64)
    if found.shape != wanted or not np.isfinite(found).all():
        raise EvidenceError(f"channel 'field/soft' has shape {found.shape}, not {wanted}, or is not finite; bake again")
    return found


def field_work(candidate: Candidate, cache: Cache) -> F64:
    """Work of fields on elastic members since frame 0 [J], shape (F,); zeros where none acts."""
    if not cache.index.deformables or not feels_fields(candidate, cache):
        return np.zeros(cache.index.frames)
    return np.cumsum(np.asarray(cache.series("record/soft_field_work"), dtype=np.float64))


def fields(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    """Finding on the recorded impulses of fields against the declared ones, of the body that is farthest off."""
    if not feels_fields(candidate, cache):
        return Finding("not_applicable", "no force field acts on an elastic body of it")
    given, owners = field_impulses(candidate, cache), [n.split("/", 1)[0] for n in cache.index.deformables]
    worst, culprit, wrong, size = -1.0, owners[0], np.zeros(0, dtype=bool), 0.0
    for row, name in enumerate(owners):
        off, largest = _off(candidate, require_deforming(candidate, name), fields_of(candidate.spec, name), given[:, row])
        share = float(off.max(initial=0.0)) / max(largest, 1e-12)
        if share > worst:
            worst, culprit, size = share, name, largest
            wrong = np.arange(len(off)) == (int(np.argmax(off)) if share > FIELD else -1)
    text = (
        f"what fields gave to {culprit} differs from the declared fields' by {worst:.2g} of the largest impulse, {size:.3g} N s"
    )
    return judge_frames(wrong, text, worst, FIELD, bake_again(), entity=culprit, evidence={"largest_Ns": size})


def _off(candidate: Candidate, soft: Deforming, found: Fields, given: F64) -> tuple[F64, float]:
    """Deviation of recorded impulses beyond what the frames leave open [N s], shape (F,), and the largest impulse."""
    plan, count = candidate.spec.simulation, candidate.frame_count
    h = 1.0 / plan.fps
    let_go = max((d.time for d in plan.drivers.values() if d.kind == "release" and d.entity == soft.entity), default=0.0)
    switch = [t for d in found.drivers for t in (d.start, d.start + d.rise, d.end) if t is not None] + [let_go]
    loose = _loose(soft, physics_of(candidate, soft.entity))
    off, largest = np.zeros(len(given)), 0.0
    if not found:
        return np.linalg.norm(given, axis=1), 0.0
    for k in range(1, count):
        if k * h <= let_go + 1e-9:
            off[k] = float(np.linalg.norm(given[k]))
            continue
        then, now = _force(soft, found, loose, k - 1, (k - 1) * h), _force(soft, found, loose, k, k * h - 1e-9)
        largest = max(largest, h * float(np.linalg.norm(then)), h * float(np.linalg.norm(now)))
        if not any((k - 1) * h + 1e-9 < t < k * h - 1e-9 for t in switch):
            doubt = 0.5 * h * float(np.linalg.norm(now - then))
            off[k] = max(float(np.linalg.norm(given[k] - 0.5 * h * (then + now))) - doubt, 0.0)
    return off, largest


def _force(soft: Deforming, found: Fields, loose: NDArray[np.bool_], frame: int, time: float) -> F64:
    """Of all fields on what of a body is `loose` from its pins, at a frame [N], shape (3,)."""
    total = (soft.masses * loose) @ found.acceleration(soft.positions(frame), time)
    if found.has_medium:
        for part, mesh in soft.meshes.items():
            vertices, speeds = soft.positions(frame, part), soft.velocities(frame, part)
            corners = vertices[mesh.faces]
            medium = found.medium(corners.mean(axis=1), time)
            push = face_drag(medium, corners, speeds[mesh.faces].mean(axis=1)).force
            total = total + loose[soft.ranges[part]][mesh.faces].mean(axis=1) @ push
    return np.asarray(total)


def _loose(soft: Deforming, physics: ElasticPhysics) -> NDArray[np.bool_]:
    """Vertices that no pin holds, shape (v,)."""
    held = np.zeros(len(soft.rest), dtype=bool)
    for pin in physics.pins.values():
        held |= (np.abs(soft.rest - np.array(pin.center)) <= 0.5 * np.array(pin.size) * (1 + 1e-9)).all(axis=1)
    return ~held
