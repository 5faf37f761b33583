"""Impulses and work that elastic bodies and the matter of other instances give each other (R66-R68, R102)."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ....worlds.arrays import F64
from ....worlds.errors import EvidenceError
from ...ledgers.balance import books_of
from ...ledgers.exchanged import partners
from ...ledgers.fields import blown
from ...rows.corrections import bake_again, correction
from ...rows.findings import Finding, cache_of
from ..rigid.books import energy_scale
from .bounds import BOOKS, LEAST
from .fields import field_work
from .ledger import elastic_energies, judge_growth
from .rows import elastic_members, judge_frames

if TYPE_CHECKING:
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate

__all__ = ["Outside", "exchange", "outside_work", "soft_impulses", "soft_work", "together"]


class Outside(NamedTuple):
    """[J] since frame 0, each shape (F,)."""

    work: F64
    doubt: F64
    """Uncertainty of it: of rigid bodies impulses over a frame are known, and velocities at its ends."""


def soft_impulses(candidate: Candidate, cache: Cache) -> F64:
    """Impulses that elastic members received over each frame [N s, N m s], shape (F, bodies, 6); zeros where nobody is coupled.

    Raises:
        EvidenceError: the channel is missing or has another shape.
    """
    wanted = (cache.index.frames, len(cache.index.deformables), 6)
    if not partners(candidate.spec, cache.index.solver):
        return np.zeros(wanted)
    found = np.asarray(cache.series("exchange/soft"), dtype=np.float64)
    if found.shape != wanted or not np.isfinite(found).all():
        raise EvidenceError(f"channel 'exchange/soft' has shape {found.shape}, not {wanted}, or is not finite; bake again")
    return found


def soft_work(candidate: Candidate, cache: Cache) -> F64:
    """Work of coupled solvers on elastic members since frame 0 [J], shape (F,); zeros where nobody is coupled."""
    if not cache.index.deformables or not partners(candidate.spec, cache.index.solver):
        return np.zeros(cache.index.frames)
    return np.cumsum(np.asarray(cache.series("record/soft_exchange_work"), dtype=np.float64))


def outside_work(candidate: Candidate, cache: Cache) -> Outside:
    """Work since frame 0 that others and force fields did on all that an instance moves.

    Elastic and rigid members give energy to each other, so that both are one balance: what coupled solvers give to either comes from outside.
    """
    if not cache.index.bodies:
        none = np.zeros(cache.index.frames)
        return Outside(soft_work(candidate, cache) + field_work(candidate, cache), none)
    rigid = books_of(candidate, cache).outside
    return Outside(soft_work(candidate, cache) + field_work(candidate, cache) + rigid.work, rigid.doubt)


def exchange(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    """Finding on the largest difference between what coupled solvers gave and members received in a frame, each side counted by itself."""
    others = partners(candidate.spec, solver)
    if not others:
        return Finding("not_applicable", "nobody is coupled both ways with it")
    received = soft_impulses(candidate, cache)[:, :, :3]
    owners = [name.split("/", 1)[0] for name in cache.index.deformables]
    given, count = np.zeros_like(received), min(len(received), candidate.frame_count)
    for other in others:
        theirs = cache_of(candidate, other)
        series = np.asarray(theirs.series("exchange/impulse"), dtype=np.float64)
        for row, name in enumerate(theirs.index.colliders):
            if (entity := name.split("/", 1)[0]) in owners:
                given[: len(series), owners.index(entity)] += series[: len(given), row, :3]
    off = np.linalg.norm(received - given, axis=2)[:count]
    size = max(float(np.linalg.norm(given, axis=2).max(initial=0.0)), LEAST)
    share = off / size
    worst = np.unravel_index(int(share.argmax()), share.shape)
    culprit = owners[int(worst[1])]
    text = f"what {culprit} received and what it was given differ by {share.max():.2g} of the largest impulse, {size:.3g} N s"
    wrong, evidence = (share > BOOKS).any(axis=1), {"largest_Ns": size, "partners": list(others)}
    return judge_frames(wrong, text, float(share.max()), BOOKS, bake_again(), entity=culprit, evidence=evidence)


def together(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    """Finding on the largest growth of the energy of the instance and its cloth beyond what is given from outside.

    What passes between them is counted nowhere, so that none of it comes from nowhere.
    """
    plan = candidate.spec.simulation
    others = partners(candidate.spec, solver)
    cloth = [n for n in others if n in plan.cloth]
    if not cloth or len(cloth) < len(others):
        text = "no cloth is coupled with it" if not cloth else "energy also passes to liquids or grains, whose own rows judge it"
        return Finding("not_applicable", text)
    moving, stored = elastic_energies(cache)
    masses = [float(candidate.deforming[n].masses.sum()) for n in elastic_members(candidate, solver)]
    records = [np.asarray(cache.series(f"record/{n}")) for n in ("kinetic_energy", "potential_energy", "driver_work")]
    # What cloth gives to rigid members stays among those that are judged together; what fields give to them does not.
    fields = None
    if cache.index.bodies:
        books = books_of(candidate, cache)
        fields = blown(books)
        masses.append(float(books.mass[~books.kinematic].sum()))
    drawn = 0.0 if fields is None else fields.work + fields.doubt
    kinetic, potential = moving + records[0], stored + records[1]
    outside = records[2] + field_work(candidate, cache) + drawn
    for name in cloth:
        theirs = candidate.caches[name]
        part = {n: np.asarray(theirs.series(f"record/{n}")) for n in (
            "kinetic_energy", "potential_energy", "stretch_energy", "bending_energy", "air_work", "hold_work",
        )}  # fmt: skip
        kinetic = kinetic + part["kinetic_energy"]
        potential = potential + part["potential_energy"] + part["stretch_energy"] + part["bending_energy"]
        outside = outside + part["air_work"] + part["hold_work"]
        masses.append(float(np.asarray(theirs.series("record/mass"))[0]))
    energy = kinetic + potential - outside
    if not np.isfinite(energy).all():
        raise EvidenceError("a recorded energy is not finite; see numerical:finite")
    # As for rigid instances: in the first frames of a scene at rest nothing is in play, and noise would be all of it.
    weight = sum(masses) * float(np.linalg.norm(plan.gravity))
    scale = energy_scale(kinetic, potential, weight)
    places = tuple(f"/simulation/solvers/{n}/settings/exchange" for n in cloth)
    sooner = correction("bodies are taken as they were for too long", "step", "halve exchange of the cloth", pointers=places)
    return judge_growth(candidate, energy, scale, f"energy of {', '.join((solver, *cloth))} together", sooner)
