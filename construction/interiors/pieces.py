"""Things with their footprint, ready to be placed: generated once, by kind and seed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..assets.documents import asset_box
from ..assets.made import Made
from ..assets.registry import generator
from .plans import Rect

__all__ = ["Piece", "piece"]


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


def piece(name: str, parameters: Mapping[str, Any], rng: np.random.Generator) -> Piece:
    """A thing of a kind; its materials vary among those that suit, its other parameters are the defaults."""
    kind = generator(name)
    schema = kind.model.model_json_schema()["properties"]
    chosen = {
        k: str(rng.choice(f["choices"]))
        for k, f in schema.items()
        if "choices" in f and k not in parameters and rng.random() < 0.7
    }
    seed = int(rng.integers(2**31))
    given = {**chosen, **parameters}
    made = kind.make(given, seed)
    low, high = asset_box(made)
    return Piece(name, given, seed, made, Rect(float(low[0]), float(low[1]), float(high[0]), float(high[1])), float(high[2]))
