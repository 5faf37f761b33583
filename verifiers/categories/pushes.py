"""Pushes between the matter of an instance and the bodies around it, by the instances' own records of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING

import numpy as np

from ...worlds.arrays import F64
from ...worlds.errors import EvidenceError
from ...worlds.fields import fields_of
from ..ledgers.exchanged import CHANNEL
from ..ledgers.origins import Origin
from .judge import Push, Touch

if TYPE_CHECKING:
    from ...worlds.cache import Cache
    from ...worlds.candidate import Candidate

__all__ = ["MIN_IMPULSE", "givers_of", "pressed_by", "pushes_of", "sizes_of", "touches_of"]

MIN_IMPULSE = 1e-6
"""[N s] Smallest impulse that carries a chain of pushes: 1 mm/s of a 1 g body."""


def sizes_of(candidate: Candidate, cache: Cache, bodies: tuple[str, ...]) -> F64:
    """Size of the impulse that an instance gave, or got, per body over each frame [N s], shape (frames, bodies).

    Raises:
        EvidenceError: the channel is missing or has another shape.
    """
    given: F64 = np.asarray(cache.series(CHANNEL), dtype=np.float64)[: candidate.frame_count]
    if given.shape[1:] != (len(bodies), 6):
        raise EvidenceError(f"channel {CHANNEL!r} of {cache.index.solver!r} has shape {given.shape}; bake again")
    return np.asarray(np.linalg.norm(given[:, :, :3], axis=2))


def pressed_by(candidate: Candidate, cache: Cache, matter: str, other: str) -> F64:
    """Size of the impulse between the matter of an instance and a solid over each frame [N s], shape (frames,).

    Raises:
        EvidenceError: the record does not tell the matter from other members, or the solid is none of those that it meets.
    """
    solver, solids = cache.index.solver, cache.index.colliders
    if len(candidate.spec.simulation.solvers[solver].members) > 1:
        raise EvidenceError(
            f"the record of {solver!r} does not tell {matter!r} from its other members; give it an instance of its own"
        )
    rows = [k for k, n in enumerate(solids) if n.split("/", 1)[0] == other]
    if not rows:
        raise EvidenceError(f"{other!r} is none of the solids that {matter!r} meets")
    total: F64 = sizes_of(candidate, cache, solids)[:, rows].sum(axis=1)
    return total


def givers_of(candidate: Candidate, cache: Cache, channel: str, fields: F64 | None) -> dict[Origin, F64]:
    """Impulses of bodies and of fields on the members of an instance together, by origin [N s], each shape (frames - 1, 3).

    Args:
        candidate: what is judged.
        cache: of the instance.
        channel: what bodies gave over each frame: `exchange/reaction`, or `CHANNEL`, which holds the opposite.
        fields: what fields and air gave over each frame [N s], shape (frames, 3); None where no record tells.

    Raises:
        EvidenceError: the channel is missing.
    """
    given: F64 = np.asarray(cache.series(channel), dtype=np.float64)[1 : candidate.frame_count, :, :3]
    found: dict[Origin, F64] = {}
    for row, body in enumerate(cache.index.colliders[: given.shape[1]]):
        origin = Origin("contact", body.split("/", 1)[0])
        found[origin] = found.get(origin, np.zeros_like(given[:, row])) + (
            -given[:, row] if channel == CHANNEL else given[:, row]
        )
    if fields is not None:
        names = {n for member in cache.index.bodies for n in fields_of(candidate.spec, member.split("/", 1)[0]).names}
        found[Origin("fields", ", ".join(sorted(names)))] = fields[1:]
    return found


def pushes_of(
    candidate: Candidate, caches: Iterable[Cache], shares: Callable[[Cache, int, list[int]], Iterable[dict[str, float]]]
) -> list[list[Push]]:
    """Pushes between matter and the bodies around it per frame, each over all of it.

    Args:
        candidate: what is judged.
        caches: of the instances of the matter.
        shares: share of each member in what a body was given, by cache, frame and indices of the bodies.
    """
    fps = candidate.spec.simulation.fps
    found: list[list[Push]] = [[] for _ in range(candidate.frame_count)]
    for cache in caches:
        bodies = cache.index.colliders
        sizes = sizes_of(candidate, cache, bodies) if bodies else np.zeros((0, 0))
        for frame in np.flatnonzero((sizes > 0.0).any(axis=1)).tolist():
            rows = np.flatnonzero(sizes[frame] > 0.0).tolist()
            for row, share in zip(rows, shares(cache, frame, rows), strict=True):
                body, size = bodies[row].split("/", 1)[0], float(sizes[frame, row])
                begin, end = (frame - 1) / fps, frame / fps
                found[frame] += [Push(member, body, begin, end, size * part) for member, part in share.items() if part > 0.0]
    return found


def touches_of(
    candidate: Candidate, cache: Cache, matter: frozenset[str], bodies: tuple[str, ...], others: Iterable[Cache] = ()
) -> Iterator[Touch]:
    """Matter and every entity that it presses.

    Args:
        candidate: what is judged.
        cache: whose record tells.
        matter: who presses.
        bodies: rows of the record.
        others: caches of other matter: where it pressed a body, the record does not tell who else did.
    """
    impulse = sizes_of(candidate, cache, bodies)
    for other in others:
        theirs = sizes_of(candidate, other, other.index.colliders)
        for row, body in enumerate(other.index.colliders):
            if body in bodies:
                impulse[theirs[:, row] > 0.0, bodies.index(body)] = 0.0
    owners = [b.split("/", 1)[0] for b in bodies]
    for name in dict.fromkeys(owners):
        yield Touch(matter, name, impulse[:, [o == name for o in owners]].max(axis=1) > MIN_IMPULSE)
