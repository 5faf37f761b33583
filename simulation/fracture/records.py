"""Records of the bonds in a frame: loads on the pieces, stresses, and those that broke."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.arrays import F64

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .pieces import Pieces

__all__ = ["Break", "Records"]


@dataclass
class Break:
    """One bond that broke."""

    time: float
    bond: int
    point: F64
    cause: int
    ratio: float
    energy: float
    case: int


@dataclass
class _Case:
    """Loads under which bonds broke at one moment."""

    rows: Any
    loads: F64
    """Lasting and sudden, shape (n, 12)."""
    spin: F64


class Records:
    """One frame of all breakable members, whose pieces and bonds are counted through.

    Args:
        entities: the members.
    """

    def __init__(self, entities: Sequence[Pieces]) -> None:
        self._entities = entities
        self.first_bond = np.concatenate([[0], np.cumsum([len(e.whole) for e in entities])]).astype(np.int64)
        self.first_piece = np.concatenate([[0], np.cumsum([len(e.mass) for e in entities])]).astype(np.int64)
        self.energy = 0.0
        """Elastic energy of the bonds that broke since frame 0, or their toughness where that is more [J]."""
        self.begin()

    def begin(self) -> None:
        """Start a frame."""
        self._breaks: list[Break] = []
        self._cases: list[_Case] = []
        self._peak: F64 = np.zeros(int(self.first_bond[-1]))
        self._given: F64 = np.zeros((int(self.first_piece[-1]), 6))

    def stressed(self, index: int, bonds: Any, ratio: F64) -> None:
        """Note how much of their strength bonds of an entity bear."""
        rows = self.first_bond[index] + bonds
        self._peak[rows] = np.maximum(self._peak[rows], ratio)

    def given(self, impulse: F64) -> None:
        """Add what the pieces' bonds felt in a step, world axes, shape (n, 6) [N s, N m s]."""
        self._given += impulse

    def case(self, index: int, pieces: Any, loads: F64, spin: F64) -> int:
        """Keep the loads, shape (m, 12), on pieces of an entity under which bonds break; their number in the frame."""
        loaded = np.flatnonzero(np.abs(loads).max(axis=1) > 0)
        self._cases.append(_Case(self.first_piece[index] + pieces[loaded], loads[loaded].copy(), spin.copy()))
        return len(self._cases) - 1

    def broke(self, found: Break) -> None:
        """Note a bond that broke."""
        self.energy += found.energy
        self._breaks.append(found)
        self._peak[found.bond] = max(self._peak[found.bond], found.ratio)

    def arrays(self) -> dict[str, Any]:
        """Channels `bond/*`, `break/*`, `case/*` and `load/*` of the frame."""
        breaks, cases = self._breaks, self._cases
        loaded = np.flatnonzero(self._given.any(axis=1))
        counts = np.array([len(c.rows) for c in cases], dtype=np.int64)
        return {
            "bond/broken": np.concatenate([~e.whole for e in self._entities]).astype(np.uint8),
            "bond/stress": self._peak.astype(np.float32),
            "break/time": np.array([b.time for b in breaks]),
            "break/bond": np.array([b.bond for b in breaks], dtype=np.int32),
            "break/point": np.array([b.point for b in breaks], dtype=np.float64).reshape(-1, 3),
            "break/cause": np.array([b.cause for b in breaks], dtype=np.int32),
            "break/ratio": np.array([b.ratio for b in breaks], dtype=np.float64),
            "break/energy": np.array([b.energy for b in breaks], dtype=np.float64),
            "break/case": np.array([b.case for b in breaks], dtype=np.int32),
            "case/count": counts.astype(np.int32),
            "case/spin": np.array([c.spin for c in cases], dtype=np.float64).reshape(-1, 3),
            "case/piece": (np.concatenate([c.rows for c in cases]) if cases else np.zeros(0)).astype(np.int32),
            "case/load": (np.concatenate([c.loads for c in cases]) if cases else np.zeros((0, 12))).astype(np.float64),
            "load/piece": loaded.astype(np.int32),
            "load/impulse": self._given[loaded],
        }
