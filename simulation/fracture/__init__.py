"""Breakable bodies: which pieces move as one, what their bonds carry, and when those break. See README.md."""

from .breakage import Breakage
from .clusters import Cluster, clusters_of

__all__ = ["Breakage", "Cluster", "clusters_of"]
