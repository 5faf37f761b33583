"""Liquids of one frame as Mitsuba shapes: clear or opaque faces, drops, foam, and lava that glows by its temperature."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ....worlds.arrays import F64, I32
from ...tracer.clear_path import IOR
from ...tracer.surfaces import soft_normals
from .meshes import Liquid, joined_balls

__all__ = ["LiquidShapes", "glow", "liquid_shapes"]

FOAM = (0.86, 0.88, 0.88)
CRUST = (0.025, 0.022, 0.02)
"""Colour of lava that has stopped glowing."""
BANDS = (0.61e-6, 0.55e-6, 0.465e-6)
"""Wavelengths of red, green and blue [m]."""
BAND_SHARE = 0.16
"""Share of daylight's power in each of the three bands: lights are given in power over all of them."""
BAND_WIDTH = 0.1e-6
RAMP = (600.0, 2200.0)
"""Temperatures that colours are tabled for [K]."""
COLD = 700.0
"""Below this lava does not glow visibly [K]."""


class LiquidShapes(NamedTuple):
    """What a frame's liquids add to a scene."""

    shapes: dict[str, Any]
    """By name."""
    clear: dict[str, F64]
    """Absorption [1/m] of the clear ones, by name."""


def glow(temperature: F64) -> F64:
    """Radiance of a black body in three colours on the scale of the scene's lights [W/(m^2 sr)], shape (n, 3).

    Planck's law at three wavelengths.
    """
    h, c, k = 6.62607015e-34, 299792458.0, 1.380649e-23
    wave = np.array(BANDS)
    hot = np.maximum(np.asarray(temperature, dtype=np.float64), 1.0)[:, None]
    spectral = 2 * h * c**2 / wave**5 / np.expm1(np.minimum(h * c / (wave * k * hot), 700.0))
    return np.where(hot > COLD, spectral * BAND_WIDTH / BAND_SHARE, 0.0)


def _mesh(mi: Any, name: str, vertices: F64, faces: I32, bsdf: Any, *, heat: F64 | None = None) -> Any:
    """A smooth mesh; with the temperature of its vertices (v,) [K] it glows."""
    properties = mi.Properties()
    properties["mesh_bsdf"] = bsdf
    glowing = heat is not None and bool((heat > COLD).any())
    if glowing:
        # A ramp over u: colours per vertex as radiance end the scalar variant of Mitsuba 3.9.
        ramp = glow(np.linspace(*RAMP, 512)).astype(np.float32)[None]
        texture = {"type": "bitmap", "bitmap": mi.Bitmap(np.ascontiguousarray(ramp)), "raw": True, "wrap_mode": "clamp"}
        properties["mesh_emitter"] = mi.load_dict({"type": "area", "radiance": texture})
    mesh = mi.Mesh(name, len(vertices), len(faces), props=properties, has_vertex_normals=True, has_vertex_texcoords=glowing)
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = vertices.astype(np.float32).ravel()
    parameters["vertex_normals"] = soft_normals(vertices, faces).ravel()
    parameters["faces"] = faces.astype(np.uint32).ravel()
    if heat is not None and glowing:
        u = (heat - RAMP[0]) / (RAMP[1] - RAMP[0])
        parameters["vertex_texcoords"] = np.stack([u, np.full(len(u), 0.5)], axis=1).astype(np.float32).ravel()
    parameters.update()
    return mesh


def _face_bsdf(mi: Any, liquid: Liquid, size: float) -> Any:
    """Material of a liquid's face; where no vectorised tracer absorbs along the way, the whole liquid is tinted alike."""
    look = liquid.look
    if not look.clear:
        return mi.load_dict(
            {"type": "principled", "base_color": {"type": "rgb", "value": list(look.color)}, "specular": 0.5,
             "roughness": max(look.roughness if not look.glows else 0.75, 0.05)}
        )  # fmt: skip
    tint = np.exp(-look.absorption * 0.25 * size).tolist()
    return mi.load_dict(
        {"type": "dielectric", "int_ior": IOR, "ext_ior": 1.0, "specular_transmittance": {"type": "rgb", "value": tint}}
    )


def liquid_shapes(mi: Any, liquids: list[Liquid], frame: int) -> LiquidShapes:
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
            white = mi.load_dict({"type": "diffuse", "reflectance": {"type": "rgb", "value": list(FOAM)}})
            name = f"foam-{liquid.entity}"
            shapes[name] = _mesh(mi, name, *joined_balls(drawn.bubbles, np.full(len(drawn.bubbles), drawn.bubble_radius)), white)
    return LiquidShapes(shapes, clear)


def _lava(mi: Any, name: str, vertices: F64, faces: I32, temperature: F64) -> Any:
    """Dark crust and the glow of its temperature."""
    crust = mi.load_dict({"type": "principled", "base_color": {"type": "rgb", "value": list(CRUST)}, "roughness": 0.8})
    return _mesh(mi, name, vertices, faces, crust, heat=temperature)
