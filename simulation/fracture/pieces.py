"""The pieces of one breakable entity: which of them move as one, and what loads them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...worlds.arrays import F64
from .clusters import Cluster, clusters_of, matter
from .network import BondNetwork
from .stiffness import Stiffness

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...worlds.built import BuiltEntity
    from ...worlds.spec import Breakable, WorldSpec

__all__ = ["COUPLED", "NO_CAUSE", "Pieces", "pieces_of"]

CHANGE = (0.005, 0.2, 0.5)
"""Change of a load, in parts of the largest one last solved for, that asks for a new solution: the first where a bond is about to
break, plus the second times what loads must grow by until one does, at most the third."""
LATEST = 8.0
"""Contact times after which the first of these asks for one in any case: what a short load of that size can break is near it."""
FAINT = 1e-9
"""Loads below this share of a cluster's weight are none."""
NO_CAUSE = -1
COUPLED = -2
"""As a cause: what liquids, cloth or grains of a two-way coupling give."""


class _Room(NamedTuple):
    """By how much the loads of a cluster may change until they are solved for again [N, N m]."""

    pieces: int
    room: float
    least: float
    """The same after `LATEST`."""
    until: float
    """[s]"""


@dataclass
class Pieces:
    """n pieces with b bonds."""

    built: BuiltEntity
    breakable: Breakable
    network: BondNetwork
    centers: F64
    mass: F64
    inertia: F64
    whole: Any
    """Which bonds hold, shape (b,)."""
    load: F64
    """Contact forces and torques about the pieces' centres, smoothed over the contact time, entity's frame, shape (n, 6)."""
    lasting: F64
    """The same, smoothed over a longer time."""
    cause: Any
    """Collider that loaded each piece last, shape (n,)."""
    ids: Any
    """Body of the model that holds each piece, shape (n,)."""
    middle: F64
    """Centre of mass of each piece's cluster, entity's frame [m], shape (n, 3)."""
    solved: F64
    """Lasting and sudden loads last solved for, shape (n, 12)."""
    factors: dict[tuple[str, float], Stiffness] = field(default_factory=dict)
    """Per cluster and share of the contact time its stiffness; 0: under lasting loads."""
    clusters: list[Cluster] = field(default_factory=list)
    bonded: list[Cluster] = field(default_factory=list)
    """Those of them that have bonds."""
    rooms: dict[str, _Room] = field(default_factory=dict)
    """State of clusters that bear their loads."""
    label: Any = None
    """Place of each piece's cluster in `bonded`, their number where it has none, shape (n,)."""

    def bind(self, bodies: Mapping[str, int]) -> None:
        """Be the pieces of the clusters that the present bonds make, which are these bodies of a model."""
        self.clusters = clusters_of(self.built, self.whole)
        self.bonded = [c for c in self.clusters if c.fixed or len(c.pieces) > 1]
        self.label = np.full(len(self.mass), len(self.bonded), dtype=np.int64)
        for cluster in self.clusters:
            own = list(cluster.pieces)
            self.ids[own], self.middle[own] = bodies[cluster.name], cluster.center
        for k, cluster in enumerate(self.bonded):
            self.label[list(cluster.pieces)] = k
        # What belongs to clusters that are no more is forgotten.
        alive = {c.name: len(c.pieces) for c in self.bonded}
        self.rooms = {k: r for k, r in self.rooms.items() if alive.get(k) == r.pieces}
        self.factors = self._inherited()

    def _inherited(self) -> dict[tuple[str, float], Stiffness]:
        """Known stiffness of clusters, handed to the largest part of each that is left."""
        found: dict[tuple[str, float], Stiffness] = {}
        first = np.array([c.pieces[0] for c in self.clusters], dtype=np.int64)
        size, fixed = np.array([len(c.pieces) for c in self.clusters]), np.array([c.fixed for c in self.clusters], dtype=bool)
        for (_, share), stiffness in self.factors.items():
            parts = np.flatnonzero(np.isin(first, stiffness.pieces) & (fixed == stiffness.held))
            if len(parts):
                found[self.clusters[int(parts[size[parts].argmax()])].name, share] = stiffness
        return found

    def forget(self) -> None:
        """Solutions are not part of a checkpoint: the run that goes on forgets them as well."""
        self.factors, self.rooms = {}, {}

    def loads(self) -> F64:
        """Lasting and sudden ones, shape (n, 12)."""
        return np.concatenate([self.lasting, self.load - self.lasting], axis=1)

    def changed(self, time: float) -> list[Cluster]:
        """Clusters whose loads at `time` [s] are others than those solved for."""
        change = np.zeros(len(self.bonded) + 1)
        np.maximum.at(change, self.label, np.abs(self.loads() - self.solved).max(axis=1))
        found = []
        for cluster, most in zip(self.bonded, change.tolist(), strict=False):
            known = self.rooms.get(cluster.name)
            if known is None or most > (known.room if time < known.until else known.least):
                found.append(cluster)
        return found

    def keep(self, cluster: Cluster, loads: F64, worst: float, gravity: float, time: float) -> None:
        """Note that a cluster bears these loads, shape (pieces, 12), at `time` [s], its worst bond loaded to this share of its
        strength."""
        rows = np.array(cluster.pieces)
        self.solved[rows] = loads
        weight = cluster.mass * max(gravity, 1.0)
        # Its own weight loads what the world holds.
        least = weight / len(rows) if cluster.fixed else FAINT * weight
        allowed = min(CHANGE[0] + CHANGE[1] * (1.0 / max(worst, 1e-9) - 1.0), CHANGE[2])
        scale = max(float(np.abs(loads).max(initial=0.0)), least)
        until = time + LATEST * self.breakable.bond.contact_time
        self.rooms[cluster.name] = _Room(len(rows), allowed * scale, CHANGE[0] * scale, until)

    def drop(self, cluster: Cluster) -> None:
        """Note that what was found of a cluster holds no longer."""
        self.rooms.pop(cluster.name, None)

    def stiffness(self, cluster: Cluster, share: float) -> Stiffness:
        """A cluster's stiffness under loads that act for a share of the contact time; 0: for ever."""
        key, pieces = (cluster.name, share), np.array(cluster.pieces)
        known = self.factors.get(key)
        if known is None or not known.follow(pieces, self.whole):
            within = share * self.breakable.bond.contact_time
            known = Stiffness(self.network, pieces, self.whole, held=cluster.fixed, within=within)
            self.factors[key] = known
        return known


def pieces_of(spec: WorldSpec, built: BuiltEntity, name: str) -> Pieces:
    """The pieces of a breakable entity, all bonds whole."""
    breakable = spec.entities[name].breakable
    assert breakable is not None
    assert built.bonds is not None
    mass, centers, inertia = matter(built)
    count = len(built.bodies)
    return Pieces(
        built=built,
        breakable=breakable,
        network=BondNetwork(built.bonds, centers, breakable.bond, mass, inertia),
        centers=centers,
        mass=mass,
        inertia=inertia,
        whole=np.ones(len(built.bonds), dtype=bool),
        load=np.zeros((count, 6)),
        lasting=np.zeros((count, 6)),
        cause=np.full(count, NO_CAUSE, dtype=np.int64),
        ids=np.zeros(count, dtype=np.int64),
        middle=np.zeros((count, 3)),
        solved=np.zeros((count, 12)),
    )
