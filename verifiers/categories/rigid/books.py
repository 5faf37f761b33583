"""The solver's own records against the ledgers: energies, momentum, and the work that it says drivers did."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ....worlds.arrays import F64
from ....worlds.spec import ForceDriver, MotorDriver
from ...ledgers.balance import Books
from .bounds import AUTHORED_NOISE, RECORDS, REST_HEIGHT, WORK
from .joints import stored
from .rows import Law

if TYPE_CHECKING:
    from ...rows.findings import Finding

__all__ = ["authored_noise", "energies", "energy_scale", "largest_growth", "records", "work"]


def energy_scale(kinetic: F64, potential: F64, weight: float, noise: float = 0.0) -> float:
    """Energy in play [J]: largest kinetic energy plus the range of the potential energy.

    At least the noise [J], and the weight [N] times `REST_HEIGHT`, so that the noise of a scene at rest is not magnified.
    """
    k, p = kinetic[np.isfinite(kinetic)], potential[np.isfinite(potential)]
    return max(float(k.max(initial=0.0)) + (float(np.ptp(p)) if len(p) else 0.0), weight * REST_HEIGHT, noise, 1e-12)


def largest_growth(energy: F64) -> tuple[float, int, int]:
    """Largest rise of a series over any interval, and the frames between which it rises."""
    rise = energy - np.minimum.accumulate(energy)
    end = int(np.argmax(rise))
    return float(rise[end]), int(np.argmin(energy[: end + 1])), end


def energies(books: Books) -> tuple[F64, F64]:
    """Kinetic and potential energy of all that is not on a path [J], each shape (F,), springs included."""
    free = ~books.kinematic
    kinetic: F64 = books.kinetic[:, free].sum(axis=1)
    potential: F64 = books.potential[:, free].sum(axis=1) + books.elastic + stored(books)
    return kinetic, potential


def authored_noise(books: Books) -> float:
    """Error that recorded work may have [J] because that on bodies on paths is taken out of it."""
    return AUTHORED_NOISE * float(books.kinetic[:, books.kinematic].sum(axis=1).max(initial=0.0))


def _scale(books: Books, kinetic: F64, potential: F64) -> float:
    weight = float(books.mass[~books.kinematic].sum() * np.linalg.norm(books.gravity))
    return energy_scale(kinetic, potential, weight, authored_noise(books))


def records(books: Books) -> Finding:
    """Deviation of recorded energies and momentum from those of the ledger."""
    free = ~books.kinematic
    kinetic, potential = energies(books)
    scale = _scale(books, kinetic, potential)
    momentum = books.momentum[:, free].sum(axis=1)
    flow = max(
        float(np.linalg.norm(books.momentum[:, free], axis=2).sum(axis=1).max(initial=0.0)), 1e-6 * float(books.mass.sum())
    )
    own = {"kinetic_energy": (kinetic, scale), "potential_energy": (potential, scale)}
    own |= {f"momentum_{axis}": (momentum[:, i], flow) for i, axis in enumerate("xyz")}
    table = np.stack([np.abs(books.record(n) - v) / s for n, (v, s) in own.items()], axis=1)
    table = np.where(np.isfinite(table), table, np.inf)
    law = Law(RECORDS, "1", "deviation of the records from the ledger", "there is no frame")
    evidence = {"scale_J": scale, "scale_Ns": flow}
    found = law.judge(
        tuple(own), table, np.ones(table.shape, dtype=bool), shift=0, evidence=evidence, proof=lambda name, _: {"quantity": name}
    )
    # The worst column is a quantity, not an entity: name whose share is the largest then.
    culprit = books.entities[int(np.argmax(books.kinetic[found.frame or 0]))]
    return replace(found, entities=books.entities, entity=culprit)


def work(books: Books) -> Finding:
    """Recorded work that no driver can have done: the bound needs no knowledge of what drivers did, only of what they could do at the fastest recorded speed."""
    kinetic, potential = energies(books)
    done = np.diff(books.record("driver_work"))
    most = _could(books)
    scale = _scale(books, kinetic, potential)
    value = (np.abs(done) - most) / scale
    value = np.where(np.isfinite(done), value, np.inf)
    law = Law(
        WORK,
        "1",
        "work that no driver can have done, as share of the energy in play,",
        "motors or bodies on paths with joints act in every frame; their work has no bound that poses give",
    )
    evidence = {"drivers": list(books.candidate.spec.simulation.drivers), "scale_J": scale}
    found = law.judge(books.entities[:1], value[:, None], np.isfinite(most)[:, None], evidence=evidence)
    return replace(found, entities=books.entities)


def _could(books: Books) -> F64:
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
        linked = any(name in (j.parent, j.child) for j in spec.joints.values())
        tied = any(
            name in (e.generator.attach_start, e.generator.attach_end)
            for e in books.candidate.spec.entities.values()
            if e.generator is not None
        )
        carried = np.inf if linked or tied else books.contact_budget[:, row] * surface
        moving = (
            (moved > 0)
            | (np.linalg.norm(books.velocity[:-1, body], axis=1) > 0)
            | (np.linalg.norm(books.velocity[1:, body], axis=1) > 0)
        )
        most = most + np.where(moving, carried, 0.0)
    return most
