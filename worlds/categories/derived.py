"""Products of caches, kept beside them, of all categories. A new one is a line here."""

from __future__ import annotations

from collections.abc import Callable

from ..cache import Cache
from ..derived import Derived
from ..settled import SettledFrames
from .liquid.surface import LiquidSurface
from .liquid.wet import WetMap

__all__ = ["DERIVED"]

DERIVED: tuple[Callable[[Cache], Derived], ...] = (LiquidSurface, WetMap, SettledFrames)
"""Readers, each made of a cache, in the order in which the digest of caches takes them."""
