"""Impacts that give energy.

A contact can only take energy from the bodies that it joins. Two things are held against that, in every frame with contacts:

- the record `contact_gain`: the most that the contacts of one set of touching bodies gave in any single step of the frame, which
  a later loss cannot hide;
- the judge's own ledger: bodies that touch each other, and feel nothing else but gravity and what stands still, have no more energy
  at the end of a frame than at its start. This needs none of the solver's numbers.

Both are shares of the energy that took part: what the bodies of a group of touching bodies had at most, in this frame and while
what entered a skin before is still pushed out of it. The record does not say which group gave; it is held against the one with
the most energy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64
from ....worlds.spec import DetachDriver, ForceDriver, ReleaseDriver
from ...ledgers.balance import Books, Flags
from ...ledgers.exchanged import both_ways
from ...ledgers.fields import feels_fields
from ...rows.corrections import correction
from ..elastic.ledger import elastic_energies
from .bounds import GAIN, PUSHES, REST_HEIGHT, REST_SPEED
from .rows import Law
from .speeds import surface_speeds

if TYPE_CHECKING:
    from ...rows.findings import Finding

__all__ = ["RECORD", "impact_energy"]

RECORD = "contact_gain"


class _Groups(NamedTuple):
    """Groups of touching bodies in one interval; entities that touch nothing are in none."""

    label: NDArray[np.int64]
    """Group of each entity, -1: none, shape (E,)."""
    energy: F64
    """That took part, per group [J]."""
    gain: F64
    """Energy at the end less that at the start, beyond a step's lag, per group [J]; -inf where it is not judged."""


def _busy(books: Books) -> Flags:
    """Where an entity may get energy from something else than gravity and contacts, shape (F - 1, E)."""
    spec = books.candidate.spec
    busy = np.broadcast_to(books.kinematic, (books.frames - 1, len(books.entities))).copy()
    busy |= books.free_time < books.duration - 1e-9
    if feels_fields(spec, books.cache.index.solver) or both_ways(spec, books.cache.index.solver) or books.cache.index.deformables:
        return np.ones_like(busy)
    names = {n for j in spec.simulation.joints.values() for n in (j.parent, j.child)}
    for entity in spec.entities.values():
        if entity.generator is not None:
            names |= {entity.generator.attach_start, entity.generator.attach_end}
    rows = [r for n, r in books.row.items() if n in names or spec.entities[n].generator is not None]
    busy[:, rows] = True
    for driver in spec.simulation.drivers.values():
        if isinstance(driver, ForceDriver) and driver.entity in books.row:
            busy[:, books.row[driver.entity]] |= books.overlap(driver.start, driver.end) > 0
        elif not isinstance(driver, ForceDriver | ReleaseDriver | DetachDriver):
            busy[:, [r for n, r in books.row.items() if n == getattr(driver, "entity", None)]] = True
    return busy


def _reached(books: Books) -> F64:
    """Most kinetic energy of each entity within each interval by the speeds at its ends and a fall in between [J], (F - 1, E)."""
    speed = np.linalg.norm(books.velocities, axis=2)
    fall = float(np.linalg.norm(books.gravity)) * books.duration
    linear = 0.5 * books.mass * speed**2
    rest = np.maximum(books.kinetic - linear, 0.0)
    fastest = np.maximum(speed[:-1], speed[1:]) + fall
    return np.asarray(0.5 * books.mass * fastest**2 + np.maximum(rest[:-1], rest[1:]))


def _pushed(books: Books) -> F64:
    """Energy that bodies on paths can give what they touch, per kilogram of it [J/kg], shape (F - 1, E); 0 for all others."""
    speed = surface_speeds(books)
    fastest = np.maximum(speed[:-1], speed[1:])
    return np.where(books.kinematic, 0.5 * (2.0 * fastest) ** 2, 0.0)


def _groups(books: Books) -> list[_Groups]:
    """Groups of every interval."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    settings = books.candidate.spec.simulation.rigid[books.cache.index.solver].settings
    window = 1 + int(np.ceil(PUSHES * settings.contact_steps * settings.step / books.duration))
    count, found = len(books.entities), books.contacts
    a, b = books.collider_row[found.a], books.collider_row[found.b]
    reached, pushed, busy = _reached(books), _pushed(books), _busy(books)
    soft = elastic_energies(books.cache)[0]
    energy = np.where(books.kinematic, 0.0, books.kinetic + books.potential)
    lag = books.mass * np.linalg.norm(books.gravity) * np.linalg.norm(books.velocities, axis=2)
    step = books.record("step")
    floor = books.mass * max(float(np.linalg.norm(books.gravity)) * REST_HEIGHT, 0.5 * REST_SPEED**2)
    result = []
    for k in range(books.frames - 1):
        mine = found.frame == k + 1
        one, two = a[mine], b[mine]
        label = np.full(count, -1, dtype=np.int64)
        joined = (one >= 0) & (two >= 0)
        graph = coo_array((np.ones(int(joined.sum())), (one[joined], two[joined])), shape=(count, count))
        group = connected_components(graph, directed=False)[1]
        touched = np.unique(np.concatenate([one[one >= 0], two[two >= 0]])).astype(np.int64)
        label[touched] = np.unique(group[touched], return_inverse=True)[1] if len(touched) else label[touched]
        size = int(label.max(initial=-1)) + 1
        inside = label >= 0
        own, free = label[inside], np.where(books.kinematic, 0.0, 1.0)[inside]

        def summed(values: F64, own: NDArray[np.int64] = own, inside: Flags = inside, size: int = size) -> F64:
            return np.asarray(np.bincount(own, weights=values[inside], minlength=size), dtype=np.float64)

        kinetic = summed(reached[max(0, k + 1 - window) : k + 1].max(axis=0) * ~books.kinematic)
        given = np.zeros(size)
        np.maximum.at(given, own, pushed[k][inside])
        weight = np.bincount(own, weights=books.mass[inside] * free, minlength=size)
        taking = kinetic + given * weight + soft[k : k + 2].max() + summed(floor * ~books.kinematic)
        noise = summed((lag[k] + lag[k + 1]) * step[k + 1])
        gain = summed(energy[k + 1] - energy[k]) - noise
        closed = np.bincount(own, weights=busy[k][inside].astype(np.float64), minlength=size) == 0
        result.append(_Groups(label, np.maximum(taking, 1e-12), np.where(closed, gain, -np.inf)))
    return result


def impact_energy(books: Books) -> Finding:
    """Energy that contacts gave."""
    record: F64 = np.asarray(books.cache.series(f"record/{RECORD}"), dtype=np.float64)
    value = np.full((books.frames - 1, len(books.entities)), -np.inf)
    judged, groups = np.zeros(value.shape, dtype=bool), _groups(books)
    for k, found in enumerate(groups):
        if not len(found.energy):
            continue
        share = found.gain / found.energy
        strongest = int(np.argmax(found.energy))
        given = record[k + 1] / found.energy[strongest] if np.isfinite(record[k + 1]) else np.inf
        share[strongest] = max(share[strongest], given)
        inside = found.label >= 0
        value[k, inside], judged[k, inside] = share[found.label[inside]], True
    law = Law(
        GAIN,
        "1",
        "energy that contacts gave, as share of that of the bodies that touch,",
        "no contact is logged in any frame",
        lambda entity: correction(
            f"the impact in which {entity} takes part gives energy: bodies touch in a way that one step does not resolve",
            "placement",
            "leave a gap of a few tenths of a millimetre more than the two skins between bodies that are to pass an impact on",
            pointers=(f"/entities/{entity}/pose",),
        ),
    )
    return law.judge(books.entities, value, judged, proof=lambda _, frame: _evidence(books, groups, record, frame))


def _evidence(books: Books, groups: list[_Groups], record: F64, frame: int) -> dict[str, object]:
    """Evidence about a frame: who touched whom, strongest first, and the energies."""
    found = books.contacts
    mine = np.flatnonzero(found.frame == frame)
    order = mine[np.argsort(-found.impulse[mine], kind="stable")][:5]
    names = books.cache.index.colliders
    return {
        "touching": [[names[found.a[i]], names[found.b[i]]] for i in order],
        "recorded_gain_J": float(record[frame]) if np.isfinite(record[frame]) else str(record[frame]),
        "energy_of_groups_J": [float(e) for e in groups[frame - 1].energy[:5]],
    }
