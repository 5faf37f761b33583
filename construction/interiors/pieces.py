"""Things with their footprint, ready to be placed: generated once, by kind and seed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np

from ...geometry.solids import Solid
from ...worlds.arrays import F64
from ...worlds.materials import row_named
from ..assets.documents import part_boxes
from ..assets.made import Made
from ..assets.registry import generator
from ..kept_shapes import kept_shape
from ..primitives import ShapeGeometry
from .plans import Rect
from .programs import SMALL
from .swept import Volume, swept_by

__all__ = ["Piece", "Stock", "made_piece"]

VARIANTS = 3
"""Own choice: different things of a kind in one interior."""
VARIED = 0.7
"""Own choice: share of materials that are not the default."""


@dataclass(frozen=True)
class Piece:
    """A generated thing."""

    generator: str
    parameters: Mapping[str, Any]
    seed: int
    made: Made
    foot: Rect
    """Box around it seen from above, in its own frame [m]."""
    height: float
    """[m]"""
    parts: Mapping[str, tuple[F64, F64]]
    """Least and greatest corners of the parts of each body, in the thing's own frame [m], shapes (n, 3)."""

    @cached_property
    def boxes(self) -> dict[str, tuple[F64, F64]]:
        """Least and greatest corner of each body, in the thing's own frame [m]."""
        return {name: (low.min(0), high.max(0)) for name, (low, high) in self.parts.items()}

    @cached_property
    def solid(self) -> Volume:
        """Boxes of its bodies, in its own frame."""
        return Volume(np.array([low for low, _ in self.boxes.values()]), np.array([high for _, high in self.boxes.values()]))

    @cached_property
    def swept(self) -> Volume:
        """Boxes that its joints sweep as they open, in its own frame."""
        return swept_by(self.generator, self.made, self.parts)

    @cached_property
    def mass(self) -> float:
        """[kg]"""
        total = 0.0
        for body in self.made.bodies.values():
            if body.physics is not None and "mass" in body.physics:
                total += float(body.physics["mass"])
                continue
            for part in body.parts.values():
                kept = kept_shape(part.shape, Path())
                volume = kept.measured("volume", partial(_volume, kept.geometry))
                row = row_named(part.material or body.material)
                assert row is not None
                total += row[1].figures["density"].range[1] * volume
        return total


def _volume(shape: ShapeGeometry) -> float:
    """[m^3]"""
    return Solid.from_mesh(shape.render, closed=True).volume if shape.mass is None else shape.mass[0]


class Stock:
    """Things made so far, a few variants of each kind, which stand in many places.

    Args:
        rng: decides on variants.
    """

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng, self._made = rng, {}  # type: tuple[np.random.Generator, dict[tuple[Any, ...], Piece]]

    def take(self, name: str, parameters: Mapping[str, Any] | None = None) -> Piece:
        """A thing of a kind; its materials vary among those that suit, its other parameters are the defaults."""
        given = dict(parameters or {})
        key = (name, tuple(sorted(given.items())), int(self._rng.integers(VARIANTS)))
        if key not in self._made:
            kind = generator(name)
            for field, info in kind.model.model_fields.items():
                choices = info.json_schema_extra.get("choices") if isinstance(info.json_schema_extra, dict) else None
                if isinstance(choices, list) and field not in given and self._rng.random() < VARIED:
                    given[field] = str(choices[int(self._rng.integers(len(choices)))])
            self._made[key] = made_piece(name, given, int(self._rng.integers(2**31)))
        return self._made[key]

    def small(self, name: str) -> Piece:
        """A thing of a kind as it lies on others."""
        return self.take(name, SMALL.get(name))


def made_piece(name: str, parameters: Mapping[str, Any], seed: int) -> Piece:
    """A thing of these parameters."""
    made = generator(name).make(parameters, seed)
    parts = part_boxes(made)
    low, high = np.min([b[0].min(0) for b in parts.values()], axis=0), np.max([b[1].max(0) for b in parts.values()], axis=0)
    return Piece(
        name, parameters, seed, made, Rect(float(low[0]), float(low[1]), float(high[0]), float(high[1])), float(high[2]), parts
    )
