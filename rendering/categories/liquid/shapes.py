"""Liquids of one frame as Mitsuba shapes: clear or opaque faces, drops, foam, and lava that glows by its temperature."""

from __future__ import annotations

from typing import Any

import numpy as np

from ....worlds.arrays import F64, I32
from ...glow import COLD, glow
from ...tracer.clear_path import IOR
from ...tracer.meshes import mesh_of, rgb
from ...tracer.surfaces import soft_normals
from ..balls import joined_balls
from ..layer import TracedShapes
from .meshes import Liquid

__all__ = ["liquid_shapes"]

FOAM = (0.86, 0.88, 0.88)
CRUST = (0.025, 0.022, 0.02)
"""Colour of lava that has stopped glowing."""
RAMP = (600.0, 2200.0)
"""Temperatures that colours are tabled for [K]."""


def _mesh(mi: Any, name: str, vertices: F64, faces: I32, bsdf: Any, *, heat: F64 | None = None) -> Any:
    """A smooth mesh; with the temperature of its vertices (v,) [K] it glows."""
    normals = soft_normals(vertices, faces)
    if heat is None or not (heat > COLD).any():
        return mesh_of(mi, name, (vertices, faces), bsdf, normals=normals)
    # A ramp over u: colours per vertex as radiance end the scalar variant of Mitsuba 3.9.
    ramp = glow(np.linspace(*RAMP, 512)).astype(np.float32)[None]
    texture = {"type": "bitmap", "bitmap": mi.Bitmap(np.ascontiguousarray(ramp)), "raw": True, "wrap_mode": "clamp"}
    u = (heat - RAMP[0]) / (RAMP[1] - RAMP[0])
    uv = np.stack([u, np.full(len(u), 0.5)], axis=1)
    emitter = mi.load_dict({"type": "area", "radiance": texture})
    return mesh_of(mi, name, (vertices, faces), bsdf, normals=normals, uv=uv, emitter=emitter)


def _face_bsdf(mi: Any, liquid: Liquid, size: float) -> Any:
    """Material of a liquid's face; where no vectorised tracer absorbs along the way, the whole liquid is tinted alike."""
    look = liquid.look
    if not look.clear:
        return mi.load_dict(
            {"type": "principled", "base_color": rgb(look.color), "specular": 0.5,
             "roughness": max(look.roughness if not look.glows else 0.75, 0.05)}
        )  # fmt: skip
    tint = np.exp(-look.absorption * 0.25 * size).tolist()
    return mi.load_dict(
        {"type": "dielectric", "int_ior": IOR, "ext_ior": 1.0, "specular_transmittance": {"type": "rgb", "value": tint}}
    )


def liquid_shapes(mi: Any, liquids: list[Liquid], frame: int) -> TracedShapes:
    """Shapes of all liquids at a frame."""
    shapes: dict[str, Any] = {}
    clear: dict[str, F64] = {}
    for liquid in liquids:
        drawn = liquid.drawn(frame)
        drop_heat = None if drawn.drop_temperature is None else np.repeat(drawn.drop_temperature, 12)
        pieces = {
            "liquid": (drawn.vertices, drawn.faces, drawn.temperature),
            "drops": (*joined_balls(drawn.drops, drawn.drop_radius), drop_heat),
        }
        size = float(np.linalg.norm(np.ptp(drawn.vertices, axis=0))) if len(drawn.vertices) else 0.0
        bsdf = _face_bsdf(mi, liquid, size)
        for kind, (vertices, faces, heat) in pieces.items():
            if not len(faces):
                continue
            name = f"{kind}-{liquid.entity}"
            if liquid.look.glows and heat is not None:
                shapes[name] = _lava(mi, name, vertices, faces, heat)
                continue
            shapes[name] = _mesh(mi, name, vertices, faces, bsdf)
            if liquid.look.clear:
                clear[name] = liquid.look.absorption
        if len(drawn.bubbles):
            white = mi.load_dict({"type": "diffuse", "reflectance": rgb(FOAM)})
            name = f"foam-{liquid.entity}"
            shapes[name] = _mesh(mi, name, *joined_balls(drawn.bubbles, np.full(len(drawn.bubbles), drawn.bubble_radius)), white)
    return TracedShapes(shapes, clear)


def _lava(mi: Any, name: str, vertices: F64, faces: I32, temperature: F64) -> Any:
    """Dark crust and the glow of its temperature."""
    crust = mi.load_dict({"type": "principled", "base_color": rgb(CRUST), "roughness": 0.8})
    return _mesh(mi, name, vertices, faces, crust, heat=temperature)
