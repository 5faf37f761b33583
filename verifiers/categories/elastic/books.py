"""Books of an instance with elastic members: energy, records, volume, and what others gave them (R74, R102, R104)."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ....worlds.arrays import F64
from ....worlds.errors import EvidenceError
from ...ledgers.strains import require_deforming, strains_of
from ...rows.corrections import correction
from ...rows.findings import Finding, judged
from .exchange import exchange, outside_work, together
from .fields import fields
from .ledger import elastic_energies, vertex_books
from .rows import elastic_row

if TYPE_CHECKING:
    from collections.abc import Callable

    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Row

__all__ = ["check"]

RECORDS = 0.1
"""Of what is in play: masses at vertices and at nodes sum a field of velocities differently, by the second order of a cell."""
MASS = 0.1
"""Own choice: share of the built volume that a cut lattice may miss; the mass itself is kept."""
RESIDUAL = 1e-3
"""Measured: sags of beams are right within a per cent up to residuals of 5e-2, and off by 10 % at 1."""
REST_HEIGHT = 1e-3
"""[m] Energy scale of a scene where nothing moves: all its weight times this height."""


def check(candidate: Candidate, solver: str) -> list[Row]:
    """Rows of one instance."""
    checks: dict[str, Callable[[Candidate, str, Cache], Finding]] = {
        "energy": _energy,
        "solve": _solve,
        "records": _records,
        "mass": _mass,
        "exchange": lambda candidate, solver, cache: exchange(candidate, solver, cache, _members(candidate, solver)),
        "fields": lambda candidate, solver, cache: fields(candidate, solver, cache, _members(candidate, solver)),
        "together": lambda candidate, solver, cache: together(candidate, solver, cache, _members(candidate, solver)),
    }
    return [
        elastic_row(candidate, name, solver, replace(found, entities=found.entities or _members(candidate, solver)))
        for name, function in checks.items()
        for found in [judged(_ask, function, candidate, solver)]
    ]


def _ask(function: Callable[[Candidate, str, Cache], Finding], candidate: Candidate, solver: str) -> Finding:
    cache = candidate.rigid_caches.get(solver)
    if cache is None or not cache.index.deformables:
        raise EvidenceError(f"instance {solver!r} has no cache of elastic members yet; probe or bake it")
    return function(candidate, solver, cache)


def _members(candidate: Candidate, solver: str) -> tuple[str, ...]:
    members = candidate.spec.simulation.solvers[solver].members
    return tuple(m for m in members if candidate.spec.entities[m].physics.category == "elastic") or (solver,)


def _energy(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    names = _members(candidate, solver)
    moving, stored = elastic_energies(cache)
    rigid_moving, rigid_stored, work = (
        np.asarray(cache.series(f"record/{n}")) for n in ("kinetic_energy", "potential_energy", "driver_work")
    )
    kinetic, potential = moving + rigid_moving, stored + rigid_stored
    outside = outside_work(candidate, cache)
    energy = kinetic + potential - work - outside.work - outside.doubt
    mass = sum(float(candidate.deforming[n].masses.sum()) for n in names)
    weight = mass * float(np.linalg.norm(candidate.spec.simulation.gravity))
    bound, step = candidate.spec.simulation.limits.energy_growth, f"/simulation/solvers/{solver}/settings/step"
    if not np.isfinite(energy).all():
        frame = int(np.argmax(~np.isfinite(energy)))
        hint = correction("the solver diverged", "step", "halve the step", pointers=(step,))
        return Finding("fail", f"energy is not finite at frame {frame}", frame=frame, entities=names, hints=(hint,))
    scale = max(float(kinetic.max()) + float(np.ptp(potential)), weight * REST_HEIGHT, 1e-12)
    growth = energy - np.minimum.accumulate(energy)
    over = growth > bound * scale
    frame_of = int(np.argmax(over)) if over.any() else None
    text = f"energy rises by at most {growth.max():.3g} J, {growth.max() / scale:.2%} of the {scale:.3g} J in play; "
    text += f"{energy[0] - energy[-1]:.3g} J are lost by damping, impacts and friction"
    hint = correction("contacts put energy in: the step is too long", "step", "halve the step", pointers=(step,))
    skins = correction(
        "bodies start inside each other's skins",
        "placement",
        "move them apart by two skins",
        pointers=(f"/entities/{names[0]}/pose",),
    )
    return Finding(
        "pass" if frame_of is None else "fail",
        text,
        measured=float(growth.max() / scale),
        bound=bound,
        unit="1",
        frame=frame_of,
        entities=names,
        hints=(hint, skins),
        evidence={
            "scale_J": scale,
            "start_J": float(energy[0]),
            "end_J": float(energy[-1]),
            "given_by_others_J": float(outside.work[-1]),
        },
    )


def _solve(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    names = _members(candidate, solver)
    residual: F64 = np.asarray(cache.series("record/solve_residual"))
    wrong = ~(residual <= RESIDUAL)
    frame = int(np.argmax(wrong)) if wrong.any() else None
    worst = float(residual.max()) if np.isfinite(residual).all() else None
    late = int((residual > 0).sum())
    text = f"in {late} of {len(residual)} frames the solve ended before it converged, at a relative residual of {worst} at most"
    step = f"/simulation/solvers/{solver}/settings/step"
    shorter = correction("too stiff or too strongly damped for the step", "step", "halve the step", pointers=(step,))
    coarser = correction(
        "too many thin cells",
        "resolution",
        "raise physics.resolution",
        pointers=tuple(f"/entities/{n}/physics/resolution" for n in names),
    )
    weaker = correction(
        "damping makes it stiffer than its modulus",
        "mass",
        "lower physics.damping",
        pointers=tuple(f"/entities/{n}/physics/damping" for n in names),
    )
    return Finding(
        "pass" if frame is None else "fail",
        text,
        measured=worst,
        bound=RESIDUAL,
        unit="1",
        frame=frame,
        entities=names,
        hints=(shorter, weaker, coarser),
    )


def _records(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    names = _members(candidate, solver)
    books = vertex_books(candidate, names)
    kinetic, _ = elastic_energies(cache)
    height: F64 = np.asarray(cache.series("record/elastic_potential_energy"))
    momentum = np.stack([cache.series(f"record/elastic_momentum_{a}") for a in "xyz"], axis=1)
    weight = books.mass * float(np.linalg.norm(candidate.spec.simulation.gravity))
    energy = max(float(kinetic.max(initial=0.0)) + float(np.ptp(height)), weight * REST_HEIGHT, 1e-12)
    flow = max(float(np.sqrt(2.0 * books.mass * kinetic.max(initial=0.0))), 1e-3 * books.mass)
    pinned = any(getattr(candidate.spec.entities[n].physics, "pins", None) for n in names)
    deviations = {"elastic_kinetic_energy": np.abs(kinetic - books.kinetic) / energy}
    if not pinned:  # what is pinned carries weight that is in no record of free nodes
        deviations["elastic_potential_energy"] = np.abs((height - height[0]) - (books.height - books.height[0])) / energy
        deviations["elastic_momentum"] = np.linalg.norm(momentum - books.momentum, axis=1) / flow
    table = np.stack([np.where(np.isfinite(v), v, np.inf) for v in deviations.values()])
    worst = np.unravel_index(int(table.argmax()), table.shape)
    largest = float(table.max())
    wrong = (table > RECORDS).any(axis=0)
    frame = int(np.argmax(wrong)) if wrong.any() else None
    quantity = list(deviations)[int(worst[0])]
    text = f"{quantity} is off the vertices by {largest:.2%} of what is in play, at frame {int(worst[1])}"
    again = correction("the cache is of another run, or was edited", "interval", "bake again", pointers=("/simulation/frames",))
    return Finding(
        "pass" if frame is None else "fail",
        text,
        measured=largest if np.isfinite(largest) else None,
        bound=RECORDS,
        unit="1",
        frame=frame,
        entities=names,
        hints=(again,),
        evidence={"quantity": quantity, "scale_J": energy},
    )


def _mass(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    names = _members(candidate, solver)
    worst, culprit = 0.0, names[0]
    for name in names:
        rest = strains_of(require_deforming(candidate, name), candidate.frame_count).rest
        built = sum(b.volume for b in candidate.entity(name).bodies)
        if abs(rest / built - 1.0) >= worst:
            worst, culprit = abs(rest / built - 1.0), name
    ok = worst <= MASS
    text = f"the simulation mesh of {culprit} misses {worst:.2%} of its volume; masses are scaled to what was built"
    finer = correction(
        "the cells do not resolve the solid",
        "resolution",
        "lower physics.resolution",
        pointers=(f"/entities/{culprit}/physics/resolution",),
    )
    return Finding(
        "pass" if ok else "fail",
        text,
        measured=worst,
        bound=MASS,
        unit="1",
        frame=None if ok else 0,
        entity=culprit,
        entities=names,
        hints=(finer,),
    )
