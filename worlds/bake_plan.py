"""Plan of a bake, as the specification alone decides it: which instances run together, and when checkpoints are taken (R80)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .instances import bake_order, coupled_groups

if TYPE_CHECKING:
    from .spec import WorldSpec

__all__ = ["CHECKPOINT_SECONDS", "checkpoint_frames", "groups_of"]

CHECKPOINT_SECONDS = 0.5
"""Interval between checkpoints [s of the world]: what a resumed or replayed run repeats at most."""


def groups_of(spec: WorldSpec) -> list[tuple[str, ...]]:
    """Instances in the order of the bake; those with two-way couplings stand together, the rigid one first."""
    together = {name: group for group in coupled_groups(spec) for name in group}
    order = bake_order(spec)
    found = [tuple(sorted(together.get(n, {n}), key=lambda m: (m not in spec.simulation.rigid, order.index(m)))) for n in order]
    return list(dict.fromkeys(found))


def checkpoint_frames(spec: WorldSpec, frames: int) -> list[int]:
    """Frames at which checkpoints are taken, frame 0 first."""
    every = max(1, round(CHECKPOINT_SECONDS * spec.simulation.fps))
    return list(range(0, frames, every))
