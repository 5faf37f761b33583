"""States, loads and events of one breakable entity, frame by frame, as its cache holds them."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ....worlds.arrays import pose_of, rotation_matrix
from ....worlds.errors import EvidenceError

if TYPE_CHECKING:
    from ....worlds.arrays import F64
    from ....worlds.bonds import Bonds
    from ....worlds.built import BuiltEntity
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate

__all__ = ["Broken", "Frames"]

CHANNELS = tuple(f"break/{n}" for n in ("time", "bond", "point", "cause", "ratio", "energy", "case"))
REMEMBERED = 2
"""Frames for which a load is felt after its contact: the smoothing of sudden loads dies within one."""


class Broken(NamedTuple):
    """One event."""

    time: float
    bond: int
    """Index among the entity's bonds."""
    point: F64
    cause: int
    ratio: float
    energy: float
    case: int


class Frames:
    """Reads an entity's bonds, events and loads from the cache of its instance.

    Raises:
        EvidenceError: the entity is built without bonds, or the cache does not hold them.
    """

    def __init__(self, candidate: Candidate, solver: str, entity: str) -> None:
        self.candidate, self.solver, self.entity = candidate, solver, entity
        cache = candidate.rigid_caches.get(solver)
        if cache is None:
            raise EvidenceError(f"instance {solver!r} has no cache yet; probe or bake it")
        self.cache: Cache = cache
        self.built: BuiltEntity = candidate.entity(entity)
        if self.built.bonds is None:
            raise EvidenceError(f"breakable {entity!r} is built without bonds; place it again")
        self.bonds: Bonds = self.built.bonds
        if entity not in cache.index.breakables:
            raise EvidenceError(f"the cache of {solver!r} holds no bonds of {entity!r}; bake again")
        before = cache.index.breakables[: cache.index.breakables.index(entity)]
        others = [candidate.entity(n) for n in before]
        self.first_bond = sum(len(o.bonds) for o in others if o.bonds is not None)
        self.first_piece = sum(len(o.bodies) for o in others)
        self.count = candidate.frame_count
        rows = [cache.body_row(entity, b.name) for b in self.built.bodies]
        if any(r is None for r in rows):
            raise EvidenceError(f"the cache of {solver!r} lacks pieces of {entity!r}; bake again")
        self.rows = np.array(rows, dtype=np.int64)
        """Rows of the pieces among the instance's bodies."""
        pose = pose_of(candidate.spec.entities[entity].pose)
        self.rest_turn: F64 = rotation_matrix(pose.quaternion)
        self._rest = pose

    @cached_property
    def local_gravity(self) -> F64:
        """Gravity in the entity's frame as it was built [m/s^2], shape (3,)."""
        return np.asarray(self.rest_turn.T @ np.array(self.candidate.spec.simulation.gravity))

    def time(self, frame: int) -> float:
        """[s]"""
        return frame / self.candidate.spec.simulation.fps

    def rest_points(self, points: F64) -> F64:
        """Points of the entity's frame where they were built, in the world, shape (n, 3)."""
        return self._rest.apply(points)

    def _own(self, name: str, frame: int) -> Any:
        found = self._bonds_of[frame][name]
        if len(found) < self.first_bond + len(self.bonds):
            raise EvidenceError(f"channel {name!r} holds {len(found)} bonds at frame {frame}, fewer than were built; bake again")
        return found[self.first_bond : self.first_bond + len(self.bonds)]

    @cached_property
    def _bonds_of(self) -> list[dict[str, Any]]:
        return self.cache.ragged("bond/broken", "bond/stress")

    @cached_property
    def _logs(self) -> list[dict[str, Any]]:
        return self.cache.ragged(*CHANNELS, "case/count", "case/piece", "case/load", "case/spin", "load/piece", "load/impulse")

    @cached_property
    def _contacts(self) -> list[dict[str, Any]]:
        return self.cache.ragged("contact/pair", "contact/impulse")

    def broken(self, frame: int) -> Any:
        """Which bonds are broken, shape (b,)."""
        return self._own("bond/broken", frame).astype(bool)

    def stress(self, frame: int) -> F64:
        """Largest stress over strength of every bond within a frame, shape (b,)."""
        return np.asarray(self._own("bond/stress", frame), dtype=np.float64)

    def record(self, name: str) -> F64:
        """A record over all frames."""
        return np.asarray(self.cache.series(f"record/{name}"))

    def breaks(self, frame: int) -> list[Broken]:
        """Events of the entity in a frame, in the order in which they were written."""
        log = self._logs[frame]
        found = []
        for k, bond in enumerate(log["break/bond"].tolist()):
            if 0 <= bond - self.first_bond < len(self.bonds):
                values = [log[name][k] for name in CHANNELS]
                time, _, point, cause, ratio, energy, case = values
                found.append(
                    Broken(float(time), bond - self.first_bond, point, int(cause), float(ratio), float(energy), int(case))
                )
        return found

    def energy_of_others(self, frames: int) -> float:
        """Energy of the broken bonds of the instance's other breakable entities [J]."""
        total = 0.0
        for frame in range(1, min(frames, self.count)):
            log = self._logs[frame]
            mine = {self.first_bond + e.bond for e in self.breaks(frame)}
            own = np.isin(log["break/bond"], list(mine)) if mine else np.zeros(len(log["break/bond"]), dtype=bool)
            total += float(log["break/energy"][~own].sum())
        return total

    def poses(self, frame: int) -> tuple[F64, F64]:
        """Positions (n, 3) and rotations (n, 3, 3) of the pieces."""
        position = self.cache.series("position")[frame, self.rows]
        return position, rotation_matrix(self.cache.series("quaternion")[frame, self.rows])

    def face(self, bond: int, frame: int) -> F64:
        """Middle of a bond's face in the world, on its first piece, shape (3,)."""
        piece = int(self.bonds.pieces[bond, 0])
        position, turn = self.poses(frame)
        return np.asarray(position[piece] + turn[piece] @ (self.bonds.point[bond] - self.built.bodies[piece].pose.position))

    def reach(self, frame: int, bond: int) -> float:
        """Way that a piece may have gone within the frame before its bond broke [m]."""
        piece = self.rows[int(self.bonds.pieces[bond, 0])]
        speed = self.cache.series("velocity")[[frame - 1, frame], piece]
        return float(np.linalg.norm(speed, axis=1).max()) / self.candidate.spec.simulation.fps

    def case(self, frame: int, case: int) -> tuple[F64, F64]:
        """Loads of a case on all pieces, lasting and sudden, shape (n, 12), and the cluster's spin, shape (3,)."""
        log = self._logs[frame]
        counts = log["case/count"]
        if not 0 <= case < len(counts):
            raise EvidenceError(f"frame {frame} lacks load case {case}; bake again")
        start = int(counts[:case].sum())
        rows = log["case/piece"][start : start + int(counts[case])] - self.first_piece
        loads = np.zeros((len(self.built.bodies), 12))
        loads[rows] = log["case/load"][start : start + int(counts[case])]
        return loads, log["case/spin"][case]

    def collider(self, index: int) -> str:
        """Name of a collider."""
        names = self.cache.index.colliders
        return names[index] if 0 <= index < len(names) else "nothing"

    def pushed(self, event: Broken, frame: int) -> bool:
        """True if what an event names as its cause touched the entity then."""
        if event.cause < 0:
            return True
        own = self.cache.index.colliders.index(self.entity)
        if event.cause == own:
            return any(self._touching(f, own, own) for f in self._lately(frame)) or bool(
                np.abs(self.case(frame, event.case)[0]).any()
            )
        return any(self._touching(f, own, event.cause) for f in self._lately(frame))

    def _lately(self, frame: int) -> range:
        """Frames whose contacts may be felt in one: what sleeps goes on being pushed by what is logged no more."""
        asleep = self.cache.series("asleep")[:, self.rows].any(axis=1)
        first = frame
        while first > 1 and asleep[first - 1]:
            first -= 1
        return range(max(1, first - REMEMBERED), frame + 1)

    def _touching(self, frame: int, a: int, b: int) -> bool:
        pairs = self._contacts[frame]["contact/pair"]
        return bool(((pairs == (min(a, b), max(a, b))).all(axis=1)).any()) if len(pairs) else False

    def touching(self, frame: int) -> dict[int, float]:
        """Colliders that touched the entity lately, itself included where its pieces met, and the normal impulses given [N s]."""
        own, found = self.cache.index.colliders.index(self.entity), dict[int, float]()
        for k in self._lately(frame):
            contacts = self._contacts[k]
            for (a, b), impulse in zip(contacts["contact/pair"].tolist(), contacts["contact/impulse"].tolist(), strict=True):
                if own in (a, b):
                    other = b if a == own else a
                    found[other] = found.get(other, 0.0) + impulse
        return found

    def momentum(self, collider: int, frame: int) -> float:
        """Largest sum of the momenta of a collider's bodies lately [N s]; 0 where the instance does not move it."""
        name = self.cache.index.colliders[collider]
        built = self.candidate.entity(name)
        rows = [(self.cache.body_row(name, b.name), b.mass) for b in built.bodies]
        known = [(row, mass) for row, mass in rows if row is not None]
        if not known:
            return 0.0
        row, mass = np.array([r for r, _ in known]), np.array([m for _, m in known])
        speed = np.linalg.norm(self.cache.series("velocity")[max(0, frame - REMEMBERED) : frame + 1][:, row], axis=2)
        return float((speed @ mass).max())

    def exchanged(self, frame: int) -> float:
        """Impulses that coupled instances gave the pieces lately [N s]."""
        given = self.cache.series("exchange/impulse")[max(1, frame - REMEMBERED) : frame + 1][:, self.rows, :3]
        return float(np.linalg.norm(given, axis=2).sum())

    def mean_push(self, first: int, last: int) -> F64:
        """Mean contact force and torque on each piece over the frames [first, last], entity's frame as built, shape (n, 6)."""
        total = np.zeros((len(self.built.bodies), 6))
        for frame in range(first, last + 1):
            log = self._logs[frame]
            rows = log["load/piece"] - self.first_piece
            own = (rows >= 0) & (rows < len(total))
            np.add.at(total, rows[own], log["load/impulse"][own])
        seconds = (last - first + 1) / self.candidate.spec.simulation.fps
        turned = total.reshape(-1, 2, 3) @ self.rest_turn
        return np.asarray(turned.reshape(-1, 6) / seconds)
