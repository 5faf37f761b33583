"""Channels of liquids, and of what is made of a liquid's cache: surfaces and wet maps."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from ...channel import Channel, quantity, vector
from ..shared_channels import DRIVER_WORK, GIVEN, IN_DOMAIN, ITERATIONS_CAPPED, MOTION, ORIGIN, POINTS, REACTION
from .facts import declares_heat

if TYPE_CHECKING:
    from ...spec import WorldSpec

__all__ = ["CHANNELS", "DIMENSIONS", "writers"]

DIMENSIONS: Mapping[str, str] = {
    "surface vertices": "vertices of the closed meshes of all liquids",
    "surface faces": "triangles of these meshes",
    "spray": "particles apart from the liquid, left out of the meshes",
    "bubbles": "bubbles on the surface; they carry no mass",
    "foaming": "particles that carry foam: the state that the next frame continues from",
    "wet": "texels with liquid on their outer side, ascending",
    "tracked": "texels whose film changed by contact with another surface since the frame before, ascending",
}

SOURCE = Channel("source", "u1", (32,), "1", "digest of the particles' container")
CHANNELS: Mapping[str, tuple[Channel, ...]] = {
    "liquid": (
        *POINTS,
        *MOTION,
        *IN_DOMAIN,
        DRIVER_WORK,
        GIVEN,
        REACTION,
        ITERATIONS_CAPPED,
        Channel("particle/fluid", "i4", ("particles",), "1", "index into `CacheIndex.bodies`", sign="+"),
        Channel("particle/volume", "f4", ("particles",), "m^3", "at rest density", "sum", "+"),
        Channel("particle/density", "f4", ("particles",), "kg/m^3", "present density"),
        Channel("particle/pressure", "f4", ("particles",), "Pa", "present pressure"),
        Channel("inflow/mass", "f8", ("drivers",), "kg", "let in since frame 0; 0 for outflows", "sum", "+"),
        Channel("outflow/mass", "f8", ("drivers",), "kg", "taken away since frame 0; 0 for inflows", "sum", "+"),
        *vector("driver_impulse", "kg m/s", "momentum that zones of waves gave to a liquid since frame 0"),
        *vector("field_impulse", "kg m/s", "momentum that force fields gave to a liquid since frame 0"),
        quantity("field_work", "J", "work that force fields did on a liquid since frame 0"),
        quantity("density_error_mean", "1", "largest mean compression at the end of a step of the frame", total="max"),
        quantity("density_error_max", "1", "largest compression at the end of a step of the frame", total="max"),
        quantity("iterations_pressure", "1", "most iterations of the density or pressure solve in a step of the frame", total="max", sign="+"),
        quantity("iterations_divergence", "1", "most iterations of the divergence solve in a step of the frame", total="max", sign="+"),
        quantity("outflow_mass", "kg", "taken away by outflows since frame 0", sign="+"),
    ),
    "liquid heat": (
        Channel("particle/temperature", "f4", ("particles",), "K", "present temperature", sign="+"),
    ),
    "surface": (
        SOURCE,
        ORIGIN,
        Channel("surface/vertices", "f4", ("surface vertices", 3), "m", "relative to `origin`"),
        Channel("surface/velocity", "f4", ("surface vertices", 3), "m/s", "of the liquid"),
        Channel("surface/faces", "i4", ("surface faces", 3), "1", "vertices of each triangle, outward", sign="+"),
        Channel("surface/fluid", "i4", ("surface faces",), "1", "index into `CacheIndex.bodies`", sign="+"),
        Channel("spray/position", "f4", ("spray", 3), "m", "relative to `origin`"),
        Channel("spray/velocity", "f4", ("spray", 3), "m/s", "world axes"),
        Channel("spray/volume", "f4", ("spray",), "m^3", "at rest density", "sum", "+"),
        Channel("spray/fluid", "i4", ("spray",), "1", "index into `CacheIndex.bodies`", sign="+"),
        Channel("spray/id", "i4", ("spray",), "1", "of the particle", sign="+"),
        Channel("foam/position", "f4", ("bubbles", 3), "m", "relative to `origin`"),
        Channel("foam/id", "i4", ("foaming",), "1", "of the particle that carries foam", sign="+"),
        Channel("foam/amount", "f4", ("foaming",), "1", "0 to 1", sign="+"),
        quantity("surface_volume", "m^3", "inside the reconstructed surface of a liquid"),
        quantity("surface_area", "m^2", "of that surface", sign="+"),
        quantity("surface_components", "1", "separate pieces of that surface, cavities not counted", sign="+"),
        quantity("spray_volume", "m^3", "of particles apart from the liquid, which the surface leaves out", sign="+"),
    ),
    "surface heat": (
        Channel("surface/temperature", "f4", ("surface vertices",), "K", "of the liquid"),
        Channel("spray/temperature", "f4", ("spray",), "K", "of the particle"),
    ),
    "wet": (
        SOURCE,
        Channel("wet/texel", "i4", ("wet",), "1", "which texel", sign="+"),
        Channel("wet/depth", "f4", ("wet",), "m", "under the top of the liquid that it touches, along gravity", "max", "+"),
        Channel("wet/fluid", "i4", ("wet",), "1", "index into `CacheIndex.bodies` of what it touches", sign="+"),
        Channel("track/texel", "i4", ("tracked",), "1", "which texel", sign="+"),
        Channel("track/film", "f4", ("tracked",), "1", "amount of film that it has then, 1 under liquid", sign="+"),
        Channel("track/fluid", "i4", ("tracked",), "1", "index into `CacheIndex.bodies` of what the film is of"),
    ),
}  # fmt: skip
"""By kind of writer."""


def writers(spec: WorldSpec, name: str) -> Iterator[str]:
    """Further kind of writer: a liquid instance that tells temperatures."""
    if name in spec.simulation.liquid and declares_heat(spec, name):
        yield "liquid heat"
