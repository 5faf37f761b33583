"""Materials of bodies for Mitsuba: principled BSDFs, toned, textured, and wet under a film of liquid."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ...worlds.spec import Appearance
from ..categories.charring import CHAR
from ..categories.liquid.wet_look import darkened
from .meshes import rgb
from .textures import Tile

__all__ = ["BURNT", "FILM", "PANE", "bsdf_of", "toned"]

FILM = "vertex_film"
"""Attribute of meshes: share of a liquid's film that is left on them."""
BURNT = "vertex_char"
"""The same: how black they are."""
FILM_ROUGHNESS = 0.12
"""Most that a surface under a film has; own choice."""
PANE = 0.5
"""Transmission from which on light crosses a solid beside liquids."""


def toned(look: Appearance, tile: Tile | None, tone: float) -> tuple[Appearance, Tile | None]:
    """An appearance and its tile so many times lighter."""
    if tone == 1.0:
        return look, tile
    lit = look.model_copy(update={"color": tuple(min(1.0, tone * c) for c in look.color)})
    return lit, None if tile is None else replace(tile, image=np.minimum(tone * tile.image, 1.0).astype(np.float32))


def bsdf_of(mi: Any, look: Appearance, tile: Tile | None, *, open_surface: bool, wets: bool = False, burns: bool = False) -> Any:
    """Principled BSDF of an appearance; open surfaces show both sides, those that get wet or burn blend to their wet look or to char."""
    described = _described(mi, look, tile, wet=False)
    if wets:
        weight = {"type": "mesh_attribute", "name": FILM}
        described = {"type": "blendbsdf", "weight": weight, "dry": described, "wet": _described(mi, look, tile, wet=True)}
    if burns:
        char = {"type": "principled", "base_color": rgb(CHAR), "roughness": 1.0, "specular": 0.2}
        described = {"type": "blendbsdf", "weight": {"type": "mesh_attribute", "name": BURNT}, "whole": described, "char": char}
    if open_surface and look.transmission == 0:
        return mi.load_dict({"type": "twosided", "bsdf": described})
    return mi.load_dict(described)


def _described(mi: Any, look: Appearance, tile: Tile | None, *, wet: bool) -> dict[str, Any]:
    """Description of a principled BSDF. A film smooths what is rough, and darkens what is no metal."""
    dark = wet and look.metallic < 0.5
    color: dict[str, Any] = rgb(darkened(look.color) if dark else look.color)
    if tile is not None:
        image = darkened(tile.image).astype(np.float32) if dark else tile.image
        color = {
            "type": "bitmap",
            "bitmap": mi.Bitmap(np.ascontiguousarray(image)),
            "raw": True,
            "wrap_mode": "repeat",
            "filter_type": "nearest" if tile.sharp else "bilinear",
        }
    description: dict[str, Any] = {
        "type": "principled",
        "base_color": color,
        "roughness": max(min(look.roughness, FILM_ROUGHNESS) if wet else look.roughness, 0.03),
    }
    if look.metallic > 0:
        description["metallic"] = look.metallic
    if look.transmission > 0:
        description |= {"spec_trans": look.transmission, "eta": 1.5}
    else:
        description["specular"] = 0.5
    return description
