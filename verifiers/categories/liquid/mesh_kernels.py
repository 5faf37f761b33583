# mypy: ignore-errors
# The language of kernels looks like Python and is none: Warp checks the types when it compiles them.
"""Warp kernel of a closed mesh's measures, face by face. Import only where warp is used."""

import warp as wp

wp.set_module_options({"enable_backward": False})

__all__ = ["measure"]


@wp.func
def mark_of(a: wp.int32, b: wp.int32, key: wp.uint64) -> wp.uint64:
    """A directed edge as a number that its opposite cancels: a mix of its ends (SplitMix64), with the sign of its direction."""
    low = wp.uint64(wp.min(a, b))
    high = wp.uint64(wp.max(a, b))
    mixed = ((low << wp.uint64(32)) | high) ^ key
    mixed = (mixed ^ (mixed >> wp.uint64(30))) * wp.uint64(0xBF58476D1CE4E5B9)
    mixed = (mixed ^ (mixed >> wp.uint64(27))) * wp.uint64(0x94D049BB133111EB)
    mixed = mixed ^ (mixed >> wp.uint64(31))
    if a < b:
        return mixed
    return wp.uint64(0) - mixed


@wp.kernel
def measure(
    first: wp.int32,
    points: wp.array(dtype=wp.vec3d),
    faces: wp.array2d(dtype=wp.int32),
    middle: wp.vec3d,
    key: wp.uint64,
    volume: wp.array(dtype=wp.float64),
    area: wp.array(dtype=wp.float64),
    marks: wp.array(dtype=wp.uint64),
):
    """Six times the volume between each face and `middle` [m^3], twice its area [m^2], and the sum of its edges' marks."""
    i = first + wp.tid()
    a = points[faces[i, 0]] - middle
    b = points[faces[i, 1]] - middle
    c = points[faces[i, 2]] - middle
    volume[i] = wp.dot(a, wp.cross(b, c))
    area[i] = wp.length(wp.cross(b - a, c - a))
    one = mark_of(faces[i, 0], faces[i, 1], key)
    two = mark_of(faces[i, 1], faces[i, 2], key)
    marks[i] = one + two + mark_of(faces[i, 2], faces[i, 0], key)
