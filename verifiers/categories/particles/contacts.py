"""Grains against grains: overlaps, the energy in them, and how densely they lie (R65, R103)."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from ....worlds.arrays import F64
from ...rows.corrections import bake_again, halve_step
from ...rows.findings import Finding
from .bounds import OVERLAP
from .packing import LEAST, PACKED, chosen, local_packing
from .questions import CONTACTS
from .rows import stiffer

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...rows.questions import Question
    from .frames import Swarm, SwarmFrame

__all__ = ["Contacts", "stored_energy"]


def _pairs(frame: SwarmFrame) -> tuple[NDArray[np.intp], F64, F64]:
    """Grains that overlap: rows (p, 2), depth (p,) [m], direction unused."""
    from scipy.spatial import cKDTree

    if frame.count < 2:
        return np.zeros((0, 2), dtype=np.intp), np.zeros(0), np.zeros(0)
    pairs = cKDTree(frame.position).query_pairs(2.0 * float(frame.radius.max()), output_type="ndarray")
    gap = np.linalg.norm(frame.position[pairs[:, 0]] - frame.position[pairs[:, 1]], axis=1)
    depth = frame.radius[pairs].sum(axis=1) - gap
    met = depth > 0
    return pairs[met], depth[met], gap[met]


def _touching(swarm: Swarm, frame: SwarmFrame) -> tuple[NDArray[np.intp], F64, F64]:
    """The pairs of a frame, found once for all that look at it; those of other frames are forgotten."""
    kept: dict[int, tuple[NDArray[np.intp], F64, F64]] = swarm.candidate.memo(("pairs of grains", swarm), dict)
    if frame.index not in kept:
        kept.clear()
        kept[frame.index] = _pairs(frame)
    return kept[frame.index]


def stored_energy(swarm: Swarm, frame: SwarmFrame) -> float:
    """Elastic energy of the contacts among grains by Hertz's law [J]: 8/15 E sqrt(R) depth^(5/2)."""
    pairs, depth, _ = _touching(swarm, frame)
    if not len(depth):
        return 0.0
    young = np.array(
        [(1 - swarm.physics(k).poisson_ratio ** 2) / swarm.physics(k).young_modulus for k in range(len(swarm.members))]
    )
    modulus = 1.0 / young[frame.member[pairs]].sum(axis=1)
    r = frame.radius[pairs]
    effective = r[:, 0] * r[:, 1] / r.sum(axis=1)
    return float((8.0 / 15.0 * modulus * np.sqrt(effective) * depth**2.5).sum())


class Contacts:
    """Overlaps and packing of grains."""

    questions: ClassVar[Mapping[str, Question]] = CONTACTS

    def __init__(self, swarm: Swarm) -> None:
        self.swarm = swarm
        self.depth, self.packed = 0.0, np.nan
        self.at = self.dense_at = 0
        self.first: tuple[int, int, float] | None = None
        self.crowded: tuple[int, float, list[float]] | None = None

    def see(self, now: SwarmFrame, before: SwarmFrame | None) -> None:
        """Look at one frame."""
        if not self.swarm.granular or not now.count:
            return
        pairs, depth, _ = _touching(self.swarm, now)
        if len(depth):
            share = depth / now.radius[pairs].min(axis=1)
            if float(share.max()) > self.depth:
                self.depth, self.at = float(share.max()), now.index
            if (share > OVERLAP).any() and self.first is None:
                self.first = (now.index, int((share > OVERLAP).sum()), float(share.max()))
        rows = chosen(now)
        found = local_packing(now, rows)
        if np.isnan(found).all():
            return
        best = int(np.nanargmax(found))
        if not found[best] <= self.packed:
            self.packed, self.dense_at = float(found[best]), now.index
        if found[best] > PACKED and self.crowded is None:
            self.crowded = (now.index, float(found[best]), [round(float(c), 4) for c in now.position[rows[best]]])

    def findings(self) -> dict[str, Finding]:
        """Findings on the two questions by name."""
        if not self.swarm.granular:
            none = Finding("not_applicable", "flying particles do not meet each other")
            return {"overlap": none, "packing": none}
        overlap = Finding(
            "pass",
            f"grains overlap by at most {self.depth:.2%} of the smaller radius (frame {self.at})",
            self.depth,
            OVERLAP,
            "1",
        )
        if self.first is not None:
            frame, count, share = self.first
            text = f"{count} pairs of grains overlap by up to {share:.1%} of the smaller radius at frame {frame}, at most {self.depth:.1%} (frame {self.at})"
            # Depth goes with the modulus to the power of -2/5 in collisions and -2/3 at rest.
            factor = max(1.5, (self.depth / OVERLAP) ** 2.5 * 1.2)
            hints = (
                stiffer(self.swarm, "the grains are too soft for what hits or loads them", factor),
                halve_step(self.swarm.candidate, self.swarm.solver, "the step is too long for the collisions"),
            )
            overlap = Finding("fail", text, self.depth, OVERLAP, "1", frame=frame, hints=hints)
        packing = Finding("not_applicable", f"nowhere do {LEAST:g} grains lie close together in two layers or more")
        if np.isfinite(self.packed):
            text = f"grains fill at most {self.packed:.3f} of their space (frame {self.dense_at})"
            packing = Finding("pass", text, self.packed, PACKED, "1")
        if self.crowded is not None:
            frame, share, where = self.crowded
            text = f"grains about {where} fill {share:.3f} of their space at frame {frame}, allowed {PACKED:.2f}"
            packing = Finding(
                "fail",
                text,
                self.packed,
                PACKED,
                "1",
                frame=frame,
                hints=(stiffer(self.swarm, "the grains are pressed into each other", 4.0), bake_again()),
            )
        return {"overlap": overlap, "packing": packing}
