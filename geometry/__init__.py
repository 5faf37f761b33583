"""Meshes and queries: solids, exact signed clearance, containment, broad phase, the camera and an id ray-caster."""

from .broadphase import aabb_of, candidate_pairs
from .camera import Camera, camera_at
from .clearance import Clearance, clearance_series, query_noise, signed_clearance
from .idcast import IdCaster, IdImage, coverage
from .inside import contains, distance_to_surface, winding_number
from .solids import Solid
from .triangles import Nearest

__all__ = [
    "Camera",
    "Clearance",
    "IdCaster",
    "IdImage",
    "Nearest",
    "Solid",
    "aabb_of",
    "camera_at",
    "candidate_pairs",
    "clearance_series",
    "contains",
    "coverage",
    "distance_to_surface",
    "query_noise",
    "signed_clearance",
    "winding_number",
]
