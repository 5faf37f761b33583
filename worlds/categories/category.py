"""What one category of matter declares about itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

__all__ = ["CategorySpec", "Shape"]

Shape = Literal["solid", "deforming", "loose"]
"""`solid`: surfaces that keep their form; `deforming`: surfaces that bend; `loose`: matter without a surface of its own."""


@dataclass(frozen=True)
class CategorySpec:
    """One category of matter."""

    name: str
    shape: Shape
