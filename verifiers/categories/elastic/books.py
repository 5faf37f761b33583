"""Ledgers of an instance with elastic members: energy, records and volume (R74, R102, R104)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ....worlds.arrays import F64
from ...ledgers.strains import require_deforming, strains_of
from ...rows.corrections import bake_again, correction, halve_step
from ...rows.findings import Finding
from .bounds import MASS, RECORDS, RESIDUAL, REST_HEIGHT
from .exchange import outside_work
from .ledger import elastic_energies, judge_growth, vertex_books
from .rows import change_physics, elastic_members, judge_frames

if TYPE_CHECKING:
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate

__all__ = ["energy", "mass", "records", "solve"]


def energy(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    """Finding on the largest growth of the energy of the instance beyond what is given from outside."""
    names = elastic_members(candidate, solver)
    moving, stored = elastic_energies(cache)
    rigid_moving, rigid_stored, work = (
        np.asarray(cache.series(f"record/{n}")) for n in ("kinetic_energy", "potential_energy", "driver_work")
    )
    kinetic, potential = moving + rigid_moving, stored + rigid_stored
    outside = outside_work(candidate, cache)
    total = kinetic + potential - work - outside.work - outside.doubt
    weight = sum(float(candidate.deforming[n].masses.sum()) for n in names) * _gravity(candidate)
    if not np.isfinite(total).all():
        frame = int(np.argmax(~np.isfinite(total)))
        hints = (halve_step(candidate, solver, "the solver diverged"),)
        return Finding("fail", f"energy is not finite at frame {frame}", frame=frame, hints=hints)
    scale = max(float(kinetic.max()) + float(np.ptp(potential)), weight * REST_HEIGHT, 1e-12)
    lost = f"; {total[0] - total[-1]:.3g} J are lost by damping, impacts and friction"
    shorter = halve_step(candidate, solver, "contacts put energy in: the step is too long")
    place, action = (f"/entities/{names[0]}/pose",), "move them apart by two skins"
    skins = correction("bodies start inside each other's skins", "placement", action, pointers=place)
    given = {"given_by_others_J": float(outside.work[-1])}
    return judge_growth(candidate, total, scale, "energy", shorter, skins, more=lost, evidence=given)


def solve(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    """Finding on the largest relative residual of a solve that ended before it converged."""
    names = elastic_members(candidate, solver)
    residual: F64 = np.asarray(cache.series("record/solve_residual"))
    worst = float(residual.max()) if np.isfinite(residual).all() else None
    late = int((residual > 0).sum())
    text = f"in {late} of {len(residual)} frames the solve ended before it converged, at a relative residual of {worst} at most"
    shorter = halve_step(candidate, solver, "too stiff or too strongly damped for the step")
    cause = "damping makes it stiffer than its modulus"
    weaker = change_physics(names, "damping", cause, "mass", "lower physics.damping")
    coarser = change_physics(names, "resolution", "too many thin cells", "resolution", "raise physics.resolution")
    return judge_frames(~(residual <= RESIDUAL), text, worst, RESIDUAL, shorter, weaker, coarser)


def records(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    """Finding on the largest deviation of recorded energies and momentum from those of the vertices."""
    names = elastic_members(candidate, solver)
    books = vertex_books(candidate, names)
    kinetic, _ = elastic_energies(cache)
    height: F64 = np.asarray(cache.series("record/elastic_potential_energy"))
    momentum = np.stack([cache.series(f"record/elastic_momentum_{a}") for a in "xyz"], axis=1)
    weight = books.mass * _gravity(candidate)
    scale = max(float(kinetic.max(initial=0.0)) + float(np.ptp(height)), weight * REST_HEIGHT, 1e-12)
    flow = max(float(np.sqrt(2.0 * books.mass * kinetic.max(initial=0.0))), 1e-3 * books.mass)
    pinned = any(getattr(candidate.spec.entities[n].physics, "pins", None) for n in names)
    deviations = {"elastic_kinetic_energy": np.abs(kinetic - books.kinetic) / scale}
    if not pinned:  # what is pinned carries weight that is in no record of free nodes
        deviations["elastic_potential_energy"] = np.abs((height - height[0]) - (books.height - books.height[0])) / scale
        deviations["elastic_momentum"] = np.linalg.norm(momentum - books.momentum, axis=1) / flow
    table = np.stack([np.where(np.isfinite(v), v, np.inf) for v in deviations.values()])
    worst = np.unravel_index(int(table.argmax()), table.shape)
    largest = float(table.max())
    quantity = list(deviations)[int(worst[0])]
    text = f"{quantity} is off the vertices by {largest:.2%} of what is in play, at frame {int(worst[1])}"
    known = largest if np.isfinite(largest) else None
    evidence = {"quantity": quantity, "scale_J": scale}
    wrong = np.asarray((table > RECORDS).any(axis=0))
    return judge_frames(wrong, text, known, RECORDS, bake_again(), evidence=evidence)


def mass(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    """Finding on the share of the built volume that simulation meshes miss; it fails at frame 0."""
    missing = {}
    for name in elastic_members(candidate, solver):
        rest = strains_of(require_deforming(candidate, name), candidate.frame_count).rest
        missing[name] = abs(rest / sum(b.volume for b in candidate.entity(name).bodies) - 1.0)
    culprit = max(reversed(missing), key=missing.__getitem__)
    worst = missing[culprit]
    text = f"the simulation mesh of {culprit} misses {worst:.2%} of its volume; masses are scaled to what was built"
    cause, action = "the cells do not resolve the solid", "lower physics.resolution"
    finer = change_physics([culprit], "resolution", cause, "resolution", action)
    return judge_frames(np.array([not worst <= MASS]), text, worst, MASS, finer, entity=culprit)


def _gravity(candidate: Candidate) -> float:
    """Size of gravity [m/s^2]."""
    return float(np.linalg.norm(candidate.spec.simulation.gravity))
