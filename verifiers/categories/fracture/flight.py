"""Pieces that nothing is near: what broke off and flies moves by gravity alone.

A cluster is judged in an interval in which none of its pieces loses a bond, nothing but gravity and contacts acts on the instance's
bodies, and no other body can have come near: neither boxes nor balls around what each of them sweeps meet. A path between
two frames bulges from the straight one by no more than the faster end's speed allows.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ....worlds.arrays import pose_of
from ....worlds.bonds import WORLD, components
from ....worlds.categories.fracture.pieces import crumble_of
from ...ledgers.balance import books_of
from .bounds import TUMBLE

if TYPE_CHECKING:
    from typing import Any

    from ....worlds.arrays import F64
    from ...ledgers.balance import Books
    from .frames import Frames

__all__ = ["Flight", "free_flight"]


class Flight(NamedTuple):
    """Number of free flights, and the largest deviations among them."""

    cases: int
    """Clusters and intervals."""
    speed: float
    """Change of velocity that gravity does not explain [m/s]."""
    place: float
    """Displacement that the velocities at both ends do not explain [m]."""
    frame: int
    piece: int
    """A piece of the cluster that was worst."""


def free_flight(frames: Frames, speed: float, place: float) -> Flight:
    """Judge all clusters of an entity that fly free.

    Args:
        frames: of the entity.
        speed: what is allowed [m/s]; the worst is that which exceeds its bound by the largest factor.
        place: the same [m].

    Raises:
        EvidenceError: a channel is missing.
    """
    books = books_of(frames.candidate, frames.cache)
    found = Flight(0, 0.0, 0.0, 0, 0)
    row = books.row[frames.entity]
    acted = books.drag[row] > 0 or np.abs(books.driver_wrench[0][:, row]).any() or np.abs(books.driver_wrench[1][:, row]).any()
    if acted:
        return found
    free = (books.free_time[:, row] >= books.duration - 1e-9) & ~books.outside.wet[:, row]
    boxes = _Boxes(books, frames)
    for k in np.flatnonzero(free).tolist():
        whole, then = ~frames.broken(k), ~frames.broken(k + 1)
        labels, fixed = components(len(frames.rows), frames.bonds, then)
        if fixed.all():
            continue
        hurt = np.zeros(len(fixed), dtype=bool)
        ends = frames.bonds.pieces[whole & ~then]
        hurt[labels[ends[ends != WORLD]]] = True
        alone = boxes.alone(k, labels) & ~fixed & ~hurt
        for label in np.flatnonzero(alone).tolist():
            own = frames.rows[labels == label]
            off, astray = _astray(books, own, k)
            found = found._replace(cases=found.cases + 1)
            if max(off / speed, astray / place) > max(found.speed / speed, found.place / place):
                found = Flight(found.cases, off, astray, k + 1, int(np.flatnonzero(labels == label)[0]))
    return found


def _astray(books: Books, own: Any, k: int) -> tuple[float, float]:
    """Change of a cluster's velocity and place that gravity and its velocities do not explain [m/s, m]."""
    share = books.body_mass[own] / books.body_mass[own].sum()
    v0, v1 = (share @ books.velocity[f, own] for f in (k, k + 1))
    x0, x1 = (share @ books.body_centers[f, own] for f in (k, k + 1))
    off = float(np.linalg.norm(v1 - v0 - books.gravity * books.duration))
    sag = float(np.linalg.norm(books.gravity)) * books.duration * books.step
    astray = float(np.linalg.norm(x1 - x0 - 0.5 * (v0 + v1) * books.duration)) - sag
    return off, max(0.0, astray)


class _Boxes:
    """Boxes around what every body of the instance sweeps in an interval."""

    def __init__(self, books: Books, frames: Frames) -> None:
        candidate, index = books.candidate, books.cache.index
        breakable = candidate.spec.entities[frames.entity].breakable
        assert breakable is not None
        settings = candidate.spec.simulation.rigid[index.solver].settings
        off = max((max(p.deviation) for n in index.colliders for p in candidate.entity(n).parts), default=0.0)
        self.margin = 2 * settings.skin + 2 * off + crumble_of(breakable, frames.built)
        self.books, self.rows = books, frames.rows
        count = len(index.bodies)
        self.low, self.high = np.zeros((2, books.frames, count, 3))
        for b, name in enumerate(index.bodies):
            entity, body = name.split("/", 1)
            parts = candidate.entity(entity).parts_of(body)
            local = np.concatenate([p.render.vertices for p in parts]) if parts else np.zeros((1, 3))
            # Support of the points along the world's axes: rows of the rotation.
            along = np.einsum("fij,vj->fiv", books.turns[:, b], local)
            self.low[:, b], self.high[:, b] = (books.position[:, b] + e for e in (along.min(axis=2), along.max(axis=2)))
        still = [n for n in index.colliders if candidate.spec.entities[n].motion == "static"]
        points = [
            pose_of(candidate.spec.entities[n].pose).apply(p.render.vertices) for n in still for p in candidate.entity(n).parts
        ]
        # Each of two bodies brings half of what may lie between them while they touch.
        half = 0.5 * self.margin
        self.still = np.array([(p.min(axis=0) - half, p.max(axis=0) + half) for p in points]).reshape(-1, 2, 3)

    def swept(self, k: int) -> _Swept:
        """Boxes around what the bodies sweep in the interval from frame `k` on."""
        books = self.books
        fastest = np.maximum(*(np.linalg.norm(books.velocity[f], axis=1) for f in (k, k + 1)))
        way = np.linalg.norm(books.body_centers[k + 1] - books.body_centers[k], axis=1)
        bulge = 0.5 * np.sqrt(np.maximum((fastest * books.duration) ** 2 - way**2, 0.0))
        bulge += 0.125 * float(np.linalg.norm(books.gravity)) * books.duration**2 + 0.5 * self.margin
        turned = np.maximum(*(np.linalg.norm(books.spin[f], axis=1) for f in (k, k + 1))) * books.duration
        # A point at distance r that turns by an angle a leaves the chord by r (1 - cos(a / 2)).
        around = books.body_reach * (1.0 - np.cos(np.minimum(0.5 * TUMBLE * turned, np.pi)))
        grow = (bulge + around)[:, None]
        low = np.minimum(self.low[k], self.low[k + 1]) - grow
        return _Swept(low, np.maximum(self.high[k], self.high[k + 1]) + grow, bulge + books.body_reach)

    def alone(self, k: int, labels: Any) -> Any:
        """Which clusters nothing else can have met, per label."""
        swept, own, books = self.swept(k), self.rows, self.books
        group = np.full(len(swept.low), -1)
        group[own] = labels
        met = np.zeros(int(labels.max(initial=-1)) + 1, dtype=bool)
        for piece, label in zip(own.tolist(), labels.tolist(), strict=True):
            if met[label]:
                continue
            low, high = swept.low[piece], swept.high[piece]
            stands = ((self.still[:, 0] < high) & (self.still[:, 1] > low)).all(axis=1)
            near = np.flatnonzero(((swept.low < high) & (swept.high > low)).all(axis=1) & (group != label))
            ways = [books.body_centers[f, near] - books.body_centers[f, piece] for f in (k, k + 1)]
            near = near[_passing(*ways) < swept.reach[near] + swept.reach[piece]]
            met[label] = bool(len(near)) or bool(stands.any())
        return ~met


class _Swept(NamedTuple):
    """Boxes and balls around what bodies sweep, n of them."""

    low: F64
    """Lower corners (n, 3) [m]."""
    high: F64
    """Upper corners (n, 3) [m]."""
    reach: F64
    """Radius of a ball that goes straight from one frame's centre to the next one's (n,) [m]."""


def _passing(start: F64, end: F64) -> F64:
    """Least distance from the origin of points that go straight from `start` to `end`, each (n, 3) [m]."""
    way = end - start
    share = -np.einsum("ij,ij->i", start, way) / np.maximum(np.einsum("ij,ij->i", way, way), 1e-300)
    return np.asarray(np.linalg.norm(start + np.clip(share, 0.0, 1.0)[:, None] * way, axis=1))
