"""What one category of matter declares about itself."""

from __future__ import annotations

from dataclasses import dataclass

from ..matter import MatterShape

__all__ = ["CategorySpec"]


@dataclass(frozen=True)
class CategorySpec:
    """One category of matter."""

    name: str
    shape: MatterShape
