"""Meshes and queries: solids, exact signed clearance, containment, broad phase, the camera and an id ray-caster."""

from .apart import apart
from .batch import BatchClearance, ConvexGaps, clearance_batch, convex_gaps
from .broadphase import Meetings, aabb_of, candidate_pairs, meetings, turned_boxes
from .camera import Camera, camera_at
from .clearance import Care, Clearance, clearance_series, query_noise, signed_clearance
from .clearance_list import signed_clearances
from .convex_union import is_convex_union
from .forest import Forest
from .heightfields import ground_solid, is_height_field
from .idcast import IdCaster, IdImage
from .inside import contains, distance_to_surface, winding_number
from .kept import kept_solid
from .motions import Motion, State, points_travel, relative_travel
from .solids import Solid
from .soup import Crossings, mutual_crossings, pierced, self_crossings
from .sweep import Lowest, Sweep, lowest_clearance, lowest_clearances
from .triangles import Nearest
from .walls import cut_thickness, wall_thickness

__all__ = [
    "BatchClearance",
    "Camera",
    "Care",
    "Clearance",
    "ConvexGaps",
    "Crossings",
    "Forest",
    "IdCaster",
    "IdImage",
    "Lowest",
    "Meetings",
    "Motion",
    "Nearest",
    "Solid",
    "State",
    "Sweep",
    "aabb_of",
    "apart",
    "camera_at",
    "candidate_pairs",
    "clearance_batch",
    "clearance_series",
    "contains",
    "convex_gaps",
    "cut_thickness",
    "distance_to_surface",
    "ground_solid",
    "is_convex_union",
    "is_height_field",
    "kept_solid",
    "lowest_clearance",
    "lowest_clearances",
    "meetings",
    "mutual_crossings",
    "pierced",
    "points_travel",
    "query_noise",
    "relative_travel",
    "self_crossings",
    "signed_clearance",
    "signed_clearances",
    "turned_boxes",
    "wall_thickness",
    "winding_number",
]
