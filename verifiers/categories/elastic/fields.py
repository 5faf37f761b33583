"""Impulses and work of force fields on elastic bodies, against those of the declared fields (R18, R63, R102).

The fields are asked again at the vertices of every two frames, masses lumped to them and
a medium meeting the faces that face it. What they gave in between is told in two ways, and the recorded impulse has to agree with one:

- the mean of both ends, with half of their difference left open, as where a field begins in space or blows in gusts;
- Simpson's rule with the middle of the frame, where each vertex is taken along the cubic path that has its places and velocities at both
  frames (C. Hermite). A body that lands swings within a frame, and its drag at both ends tells nothing of that; its way does.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....physics.drag import face_drag
from ....worlds.arrays import F64
from ....worlds.errors import EvidenceError
from ....worlds.fields import Fields, fields_of
from ...ledgers.fields import fields_in
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
    """True if a field acts on an elastic member of the instance."""
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
        off, largest = _off(candidate, require_deforming(candidate, name), fields_in(candidate, name), given[:, row])
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
        begin, middle, end = _states(soft, k, h)
        then, now = (h * _force(soft, found, loose, at, time) for at, time in ((begin, (k - 1) * h), (end, k * h - 1e-9)))
        largest = max(largest, float(np.linalg.norm(then)), float(np.linalg.norm(now)))
        if not any((k - 1) * h + 1e-9 < t < k * h - 1e-9 for t in switch):
            doubt = 0.5 * float(np.linalg.norm(now - then))
            off[k] = max(float(np.linalg.norm(given[k] - 0.5 * (then + now))) - doubt, 0.0)
            if off[k] > 0.0:
                halfway = h * _force(soft, found, loose, middle, (k - 0.5) * h)
                off[k] = min(off[k], float(np.linalg.norm(given[k] - (then + 4.0 * halfway + now) / 6.0)))
    return off, largest


class _State(NamedTuple):
    """A body at one moment, by its vertices."""

    places: F64
    """[m], shape (v, 3)."""
    speeds: F64
    """[m/s], shape (v, 3)."""


def _states(soft: Deforming, frame: int, h: float) -> tuple[_State, _State, _State]:
    """A body at the frame before, halfway on the cubic path between the two, and at a frame; frames are `h` [s] apart."""
    begin, end = (_State(soft.positions(k), soft.velocities(k)) for k in (frame - 1, frame))
    places = 0.5 * (begin.places + end.places) + 0.125 * h * (begin.speeds - end.speeds)
    speeds = 1.5 * (end.places - begin.places) / h - 0.25 * (begin.speeds + end.speeds)
    return begin, _State(places, speeds), end


def _force(soft: Deforming, found: Fields, loose: NDArray[np.bool_], at: _State, time: float) -> F64:
    """Force of all fields on what of a body is `loose` from its pins, in a state at a time [s] [N], shape (3,)."""
    total = (soft.masses * loose) @ found.acceleration(at.places, time)
    if found.has_medium:
        for part, mesh in soft.meshes.items():
            own = soft.ranges[part]
            corners = at.places[own][mesh.faces]
            medium = found.medium(corners.mean(axis=1), time)
            push = face_drag(medium, corners, at.speeds[own][mesh.faces].mean(axis=1)).force
            total = total + loose[own][mesh.faces].mean(axis=1) @ push
    return np.asarray(total)


def _loose(soft: Deforming, physics: ElasticPhysics) -> NDArray[np.bool_]:
    """Vertices that no pin holds, shape (v,)."""
    held = np.zeros(len(soft.rest), dtype=bool)
    for pin in physics.pins.values():
        held |= (np.abs(soft.rest - np.array(pin.center)) <= 0.5 * np.array(pin.size) * (1 + 1e-9)).all(axis=1)
    return ~held
