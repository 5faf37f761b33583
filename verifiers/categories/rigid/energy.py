"""No energy without a source: kinetic + potential energy - work of drivers, liquids and fields grows over no interval.

The bound is a share of the energy that is in play: the largest kinetic energy plus the range of the potential energy. Contacts,
friction and damping only take energy away.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ...ledgers import motion
from ...ledgers.balance import books_of
from ...rows.corrections import correction, halve_step, separate
from ...rows.findings import Finding
from ..elastic.exchange import outside_work
from ..elastic.ledger import elastic_energies
from .books import authored_noise, energies, energy_scale, largest_growth
from .bounds import LEDGER_NOISE
from .links import owners

if TYPE_CHECKING:
    from ....worlds.arrays import F64
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Correction

__all__ = ["energy"]


def _balance(candidate: Candidate, cache: Cache) -> tuple[F64, float]:
    """Energy less all work [J], shape (F,), and the energy in play [J]: by the records, or by the ledger where it grows by more."""
    kinetic, potential, work = (cache.series(f"record/{n}") for n in ("kinetic_energy", "potential_energy", "driver_work"))
    # Elastic members and rigid ones give energy to each other: both count.
    moving, stored = elastic_energies(cache)
    outside, books = outside_work(candidate, cache), books_of(candidate, cache)
    given = work + outside.work + outside.doubt
    kinematic = {n for n, e in candidate.spec.entities.items() if e.motion == "kinematic"}
    free = [b for b in cache.index.bodies if b.split("/", 1)[0] not in kinematic]
    gravity = float(np.linalg.norm(candidate.spec.simulation.gravity))
    weight = sum(candidate.body(*b.split("/", 1)).mass for b in free) * gravity

    def balance(kinetic: F64, potential: F64) -> tuple[F64, float]:
        kinetic, potential = kinetic + moving, potential + stored
        return kinetic + potential - given, energy_scale(kinetic, potential, weight, authored_noise(books))

    recorded, scale = balance(kinetic, potential)
    if not np.isfinite(recorded).all():
        return recorded, scale
    own, own_scale = balance(*energies(books))
    more = largest_growth(own)[0] / own_scale > largest_growth(recorded)[0] / scale + LEDGER_NOISE
    return (own, own_scale) if more else (recorded, scale)


def energy(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    """Growth of the energy over any interval."""
    series, scale = _balance(candidate, cache)
    bound = candidate.spec.simulation.limits.energy_growth
    broken = ~np.isfinite(series)
    if broken.any():
        frame = int(np.argmax(broken))
        hints: tuple[Correction, ...] = (halve_step(candidate, solver, "the solver diverged"),)
        return Finding("fail", f"energy is not finite at frame {frame}", frame=frame, hints=hints)
    growth, low, high = largest_growth(series)
    evidence = {
        "growth_J": growth,
        "scale_J": scale,
        "interval": [low, high],
        "start_J": float(series[0]),
        "end_J": float(series[-1]),
    }
    text = f"energy rises by at most {growth:.3g} J (frames {low}..{high}), {growth / scale:.2%} of the {scale:.3g} J in play"
    names = owners(cache)
    over = series - np.minimum.accumulate(series) > bound * scale
    found = Finding("pass", text, growth / scale, bound, "1", evidence=evidence, entities=tuple(dict.fromkeys(names)))
    if not over.any():
        return found
    frame = int(np.argmax(over))
    entity = _gainer(candidate, cache, names, frame)
    hints = (
        halve_step(candidate, solver, "stiff contacts or joints put energy in: the step is too long"),
        separate(entity, frame),
        correction(
            "contacts are too stiff for the step",
            "contact",
            "raise contact_steps",
            pointers=(f"/simulation/solvers/{solver}/settings/contact_steps",),
        ),
    )
    text += f"; over {bound:.2%} first at frame {frame}, where {entity} gains most"
    return replace(found, status="fail", text=text, entity=entity, frame=frame, hints=hints)


def _gainer(candidate: Candidate, cache: Cache, names: list[str], frame: int) -> str:
    """Entity whose kinetic energy, computed from velocities and masses, grew most in the frame."""
    own = motion.kinetic_energy(candidate, cache)
    gain = own[frame] - own[max(0, frame - 1)]
    return names[int(np.nanargmax(gain))] if len(gain) and np.isfinite(gain).any() else "?"
