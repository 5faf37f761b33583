"""Divergence-free smoothed particles: the particle engine of liquids."""

from .engine import Dfsph
from .settings import DfsphSettings

__all__ = ["Dfsph", "DfsphSettings"]
