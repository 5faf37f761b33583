"""The solver's own records against the ledgers: energies, momentum, and the work that it says drivers did."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ....worlds.arrays import F64
from ....worlds.spec import ForceDriver, MotorDriver, SpringJoint
from ...ledgers.balance import Books, books_of
from ...rows.corrections import correction
from ...rows.findings import Finding
from .joints import stored
from .rows import judged_law, largest

if TYPE_CHECKING:
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate

__all__ = ["PREDICATES", "RECORDS", "WORK", "authored_noise", "energies", "records", "work"]

RECORDS = 1e-3
"""Relative to the energy or momentum in play; the same formula on the same state, measured 1e-9. Bending of ropes is summed by
the engine in its own coordinates."""
WORK = 0.01
"""Of the energy in play: recorded work beyond what the drivers can have done in one frame."""
ROUNDING = 1e-6
"""Least energy that counts as in play, in parts of that of the bodies on paths."""
REST_HEIGHT = 1e-3
"""[m] As in `rigid.energy_scale`."""

PREDICATES = {
    "records": f"recorded energies and momentum are those of poses, velocities and masses within {RECORDS:g} of what is in play",
    "work": f"recorded work is none where no driver acts, and at most what its forces could do, within {WORK:.0%} of the energy in play",
}


def energies(books: Books) -> tuple[F64, F64]:
    """Kinetic and potential energy of all that is not on a path [J], each shape (F,), springs included."""
    free = ~books.kinematic
    kinetic: F64 = books.kinetic[:, free].sum(axis=1)
    potential: F64 = books.potential[:, free].sum(axis=1) + books.elastic + stored(books)
    return kinetic, potential


def authored_noise(books: Books) -> float:
    """What recorded work may be off [J] because that on bodies on paths is taken out of it."""
    return ROUNDING * float(books.kinetic[:, books.kinematic].sum(axis=1).max(initial=0.0))


def _scale(books: Books, kinetic: F64, potential: F64) -> float:
    weight = float(books.mass[~books.kinematic].sum() * np.linalg.norm(books.gravity))
    moved = float(kinetic.max(initial=0.0)) + float(np.ptp(potential))
    return max(moved, weight * REST_HEIGHT, authored_noise(books), 1e-12)


def records(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    """Row `records`."""
    books = books_of(candidate, cache)
    free = ~books.kinematic
    kinetic, potential = energies(books)
    scale = _scale(books, kinetic, potential)
    momentum = books.momentum[:, free].sum(axis=1)
    flow = max(
        float(np.linalg.norm(books.momentum[:, free], axis=2).sum(axis=1).max(initial=0.0)), 1e-6 * float(books.mass.sum())
    )
    own = {"kinetic_energy": (kinetic, scale), "potential_energy": (potential, scale)}
    own |= {f"momentum_{axis}": (momentum[:, i], flow) for i, axis in enumerate("xyz")}
    names = tuple(own)
    table = np.stack([np.abs(books.record(n) - v) / s for n, (v, s) in own.items()], axis=1)
    table = np.where(np.isfinite(table), table, np.inf)
    found = largest(table, np.ones(table.shape, dtype=bool), names, RECORDS, shift=0)
    deviation = judged_law(
        candidate,
        solver,
        found,
        bound=RECORDS,
        unit="1",
        what="deviation of the records from the ledger",
        none="there is no frame",
        entities=books.entities,
        evidence={"scale_J": scale, "scale_Ns": flow},
    )
    if not found.over:
        return deviation
    # The worst column is a quantity, not an entity: name whose share is the largest then.
    culprit = books.entities[int(np.argmax(books.kinetic[found.frame]))]
    return replace(deviation, entity=culprit, evidence={**(deviation.evidence or {}), "quantity": found.entity})


def work(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    """Row `work`: the bound needs no knowledge of what drivers did, only of what they could do at the fastest recorded speed."""
    books = books_of(candidate, cache)
    kinetic, potential = energies(books)
    done = np.diff(books.record("driver_work"))
    most = _could(books, cache)
    scale = _scale(books, kinetic, potential)
    value = (np.abs(done) - most) / scale
    value = np.where(np.isfinite(done), value, np.inf)
    drivers = tuple(candidate.spec.simulation.drivers)
    found = largest(value[:, None], np.isfinite(most)[:, None], (books.entities[0],), WORK)
    hints = (correction("the record of work was edited", "interval", "bake again", pointers=("/simulation/frames",)),)
    return judged_law(
        candidate,
        solver,
        found,
        bound=WORK,
        unit="1",
        what="work that no driver can have done, as share of the energy in play,",
        none="motors or bodies on paths with joints act in every frame; their work has no bound that poses give",
        entities=books.entities,
        hints=hints,
        evidence={"drivers": list(drivers), "scale_J": scale},
    )


def _could(books: Books, cache: Cache) -> F64:
    """Most work that drivers can have done per interval [J], shape (F - 1,); infinite where poses give no bound."""
    spec = books.candidate.spec.simulation
    steps = np.maximum(books.record("step")[1:], 1e-12)
    surface = books.record("max_travel_per_step")[1:] / steps
    peak = books.record("max_speed")[1:]
    most = np.zeros(books.frames - 1)
    for driver in spec.drivers.values():
        if isinstance(driver, ForceDriver) and driver.entity in books.row:
            row = books.row[driver.entity]
            acting = books.overlap(driver.start, driver.end)
            turn = surface / float(books.body_reach[books.owner == row].min())
            most += acting * (peak * float(np.linalg.norm(driver.force)) + turn * float(np.linalg.norm(driver.torque)))
        elif isinstance(driver, MotorDriver) and getattr(spec.joints.get(driver.joint), "child", None) in books.row:
            most[books.overlap(driver.start, driver.end) > 0] = np.inf
    for row in np.flatnonzero(books.kinematic).tolist():
        name = books.entities[row]
        body = int(books.first[row])
        moved = np.linalg.norm(np.diff(books.position[:, body], axis=0), axis=1) + np.linalg.norm(
            np.diff(books.quaternion[:, body], axis=0), axis=1
        )
        linked = any(name in (j.parent, j.child) for j in spec.joints.values() if not isinstance(j, SpringJoint))
        sprung = any(name in (j.parent, j.child) for j in spec.joints.values() if isinstance(j, SpringJoint))
        tied = any(
            name in (e.generator.attach_start, e.generator.attach_end)
            for e in books.candidate.spec.entities.values()
            if e.generator is not None
        )
        carried = np.inf if linked or sprung or tied else books.contact_budget[:, row] * surface
        moving = (
            (moved > 0)
            | (np.linalg.norm(books.velocity[:-1, body], axis=1) > 0)
            | (np.linalg.norm(books.velocity[1:, body], axis=1) > 0)
        )
        most = most + np.where(moving, carried, 0.0)
    return most
