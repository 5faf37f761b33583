"""Channels of cloth."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from ...channel import Channel, quantity, vector
from ..shared_channels import CONTACTS, EXCHANGES, GIVEN, MOTION, VERTICES
from .facts import tears

if TYPE_CHECKING:
    from ...spec import WorldSpec

__all__ = ["CHANNELS", "DIMENSIONS", "writers"]

DIMENSIONS: Mapping[str, str] = {
    "tears": "vertices of cloth that tore in the frame",
    "sides": "sides that opened in the frame; a side leads from a corner to the next and has its row",
    "triangles": "triangles around the tears of the frame",
}

CHANNELS: Mapping[str, tuple[Channel, ...]] = {
    "cloth": (
        *VERTICES,
        *MOTION,
        GIVEN,
        CONTACTS,
        EXCHANGES,
        quantity("stretch_energy", "J", "elastic, of stretch and shear of cloth"),
        quantity("bending_energy", "J", "elastic, of the bending of cloth"),
        quantity("stretch_max", "1", "largest extension of an edge of cloth over its length at rest", total="max"),
        quantity("stretch_min", "1", "largest shortening of an edge of cloth over its length at rest, negative", total="min"),
        quantity("cut_vertices", "1", "vertices of cloth whose way was cut short so that nothing crosses, over all exchanges", sign="+"),
        *vector("air_impulse", "kg m/s", "momentum that air and fields gave to cloth since frame 0"),
        *vector("hold_impulse", "kg m/s", "momentum that what holds vertices gave to cloth since frame 0"),
        *vector("solid_impulse", "kg m/s", "momentum that contact with solids gave to cloth since frame 0"),
        *vector("cut_impulse", "kg m/s", "momentum that ways cut short gave to cloth since frame 0"),
        *vector("load_impulse", "kg m/s", "momentum that others' forces at its vertices gave to cloth since frame 0"),
        quantity("air_work", "J", "work of air and fields on cloth since frame 0"),
        quantity("hold_work", "J", "work of what holds vertices on cloth since frame 0"),
        quantity("solid_work", "J", "work of moving solids in contact on cloth since frame 0"),
        quantity("load_work", "J", "work of others' forces at its vertices on cloth since frame 0"),
    ),
    "tearing": (
        Channel("edge/open", "u1", ("vertices",), "1", "the side that begins at this corner is open"),
        Channel("tear/time", "f8", ("tears",), "s", "end of the exchange after which it opened"),
        Channel("tear/corner", "i4", ("tears",), "1", "a corner at the vertex that tore", sign="+"),
        Channel("tear/point", "f8", ("tears", 3), "m", "where, world", finite=True),
        Channel("tear/tension", "f8", ("tears",), "N/m", "around it, the largest over all directions", "max"),
        Channel("tear/cause", "i4", ("tears",), "1", "index into `CacheIndex.colliders` of the moving body that pulled or pushed most; -1: air, weight or its own motion"),
        Channel("tear/side", "i4", ("sides", 3), "1", "which tear, a side, and the one along it", sign="+"),
        Channel("tear/triangle", "i4", ("triangles", 2), "1", "which tear, and the first corner of a triangle around it", sign="+"),
        Channel("tear/place", "f8", ("triangles", 3, 3), "m", "where that triangle's corners were", finite=True),
        quantity("torn_length", "m", "of all open edges of cloth, at rest", sign="+"),
    ),
}  # fmt: skip
"""By kind of writer."""


def writers(spec: WorldSpec, name: str) -> Iterator[str]:
    """Further kind of writer: a cloth instance with a member that can tear."""
    if name in spec.simulation.cloth and any(tears(spec, m) for m in spec.simulation.solvers[name].members):
        yield "tearing"
