"""Meshes and queries: solids, exact signed clearance, containment, broad phase, the camera and an id ray-caster."""

from .clearance import Clearance, clearance_series, query_noise, signed_clearance
from .inside import contains, distance_to_surface
from .solids import Solid

__all__ = [
    "Clearance",
    "Solid",
    "clearance_series",
    "contains",
    "distance_to_surface",
    "query_noise",
    "signed_clearance",
]
