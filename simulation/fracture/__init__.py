"""Breakable bodies: which pieces move as one, what their bonds carry, and when those break. See README.md."""

from .breakage import Breakage, Fate
from .clusters import Cluster, clusters_of

__all__ = ["Breakage", "Cluster", "Fate", "clusters_of"]
