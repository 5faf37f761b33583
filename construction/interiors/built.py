"""Members of collections of a specification that an interior is written as, and how single things get into them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...worlds.arrays import RigidPose
from ..assets.documents import asset_documents
from ..assets.posing import posed
from .pieces import Piece
from .plans import Plan
from .walls import Block

__all__ = ["LOOSE", "SLAB", "BuiltInterior", "block_entity", "numbers", "put_asset", "suffix"]

LOOSE = 1e-4
"""[m] Gap between parts of a building; none of them moves."""
SLAB = 0.2
"""[m] Thickness of floors and ceilings."""


@dataclass
class BuiltInterior:
    """Members of collections of a specification, by id, and what there is to say."""

    plan: Plan
    corner: tuple[float, float, float]
    """World position of the plan's corner at the lowest floor [m]."""
    entities: dict[str, dict[str, Any]] = field(default_factory=dict)
    joints: dict[str, dict[str, Any]] = field(default_factory=dict)
    relations: dict[str, dict[str, Any]] = field(default_factory=dict)
    regions: dict[str, dict[str, Any]] = field(default_factory=dict)
    rooms: dict[str, dict[str, Any]] = field(default_factory=dict)
    """Per room: rectangle [m], things and generators."""
    site: dict[str, Any] = field(default_factory=dict)
    """Height of the floor of a building on the ground, greatest height of its plinth [m], and steps before its doors."""
    lacking: list[str] = field(default_factory=list)
    """Sentences about what could not be placed."""
    left_out: list[str] = field(default_factory=list)
    """Sentences about furniture that rooms are too small for, so that it was not asked for."""

    def place(self, x: float, y: float, z: float) -> tuple[float, float, float]:
        """World position of a point of the plan [m]."""
        x0, y0, z0 = self.corner
        return (x0 + x, y0 + y, z0 + z)

    def supports(self, name: str, carrier: str, carried: str) -> None:
        """Say what carries what."""
        self.relations[name] = {"kind": "supports", "a": carrier, "b": carried}


def suffix(storey: int) -> str:
    """End of the ids of floor, walls and stairs of a storey; the lowest has none."""
    return f"_{storey}" if storey else ""


def numbers(values: Any) -> list[float]:
    """Lengths as they are written."""
    return [round(float(v), 9) + 0.0 for v in values]


def block_entity(
    role: str, material: str, blocks: Mapping[str, tuple[Block, str | None]], origin: tuple[float, float, float]
) -> dict[str, Any]:
    """A static entity of boxes with their own materials, its own origin at the plan's corner."""
    low = np.min([b.low for b, _ in blocks.values()], axis=0)
    high = np.max([b.high for b, _ in blocks.values()], axis=0)
    parts = {}
    for key, (block, own) in blocks.items():
        size, middle = np.subtract(block.high, block.low), np.add(block.high, block.low) / 2
        parts[key] = {
            "shape": {"kind": "box", "size": numbers(size)},
            "pose": {"position": numbers(middle)},
            **({} if own is None else {"material": own}),
        }
    return {
        "role": role,
        "motion": "static",
        "material": material,
        "dimensions": {"size": numbers(high - low)},
        "pose": {"position": numbers(origin)},
        "parts": parts,
    }


def put_asset(
    found: BuiltInterior,
    key: str,
    own: Piece,
    pose: RigidPose,
    *,
    motion: str,
    positions: dict[str, float] | None = None,
    fixed: bool = False,
) -> None:
    """Write a generated thing at a pose, its joints at other positions where some are given, `fixed` there where it says so."""
    asset: dict[str, Any] = {"generator": own.generator, "parameters": dict(own.parameters), "seed": own.seed}
    if positions:
        asset["positions"] = positions
    if fixed and own.made.joints:
        asset["fixed"] = True
    boxes = None if positions else own.boxes
    documents = asset_documents(key, asset, posed(own.made, positions or {}), pose, motion=motion, boxes=boxes)
    found.entities |= documents.entities
    found.joints |= documents.joints
    found.relations |= documents.relations
