"""Light of a world as Mitsuba dictionaries: sky, ground where none reaches the horizon, studio and area lights.

Radiometry is scaled so that clear sky with the sun at 40 deg gives about 700 W/m^2 on the ground, overcast 150 and
the studio 60; area lights keep their declared watts beside them, lamps give their lumens at the efficacy of daylight. A night has the light
of a full moon. Exposure is metered afterwards.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F32, F64
from ...worlds.candidate import Candidate
from ...worlds.spec import AreaLight, Lamp, Look
from ..glow import glow
from ..views import Bounds, focus_bounds
from .meshes import mesh_of, rgb
from .surfaces import Surface
from .textures import pattern_tiles

__all__ = ["ground_level", "lamp_radiance", "lamp_shape", "light_dicts", "reaches_horizon"]

SUN_SKY_SCALE = 700.0
"""Mitsuba's sunsky with turbidity 3 gives 1.0 on the ground at 40 deg (measured); this makes it W/m^2."""
SUN_APERTURE_DEG = 2.5
"""Apparent size of the sun [deg]; 0.53 in nature. Wider for softer shadows and less noise; the irradiance is the same."""
SUN_DISTANCE = 2000.0
"""In focus diagonals: its light is parallel within 0.03 deg over the focus."""
SUN_IRRADIANCE = (
    (2.0, (0.261, 0.070, 0.0)),
    (5.0, (0.643, 0.286, 0.039)),
    (10.0, (0.992, 0.602, 0.215)),
    (20.0, (1.281, 0.942, 0.538)),
    (40.0, (1.446, 1.175, 0.845)),
    (60.0, (1.498, 1.255, 0.967)),
    (90.0, (1.520, 1.287, 1.018)),
)
"""Irradiance across the sun's direction by elevation [deg], of `sunsky` at turbidity 3 (measured with and without its sun)."""
OVERCAST_IRRADIANCE = 150.0
NIGHT_IRRADIANCE = 0.0023
"""[W/m^2] Full moon: 0.25 lx (Kyba, Mohar & Posch 2017, doi:10.1093/astrogeo/atx025) at the efficacy of daylight."""
DAYLIGHT_EFFICACY = 110.0
"""[lm/W] Sun and sky together (Littlefair 1985, doi:10.1177/14771535850170040401: 93 to 115), so that lamps and daylight are as bright beside
each other as they are."""
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Share of the three colours in luminance (ITU-R BT.709)."""
STUDIO_IRRADIANCE = 60.0
HORIZON_RATIO = 12.0
"""Static ground this many focus diagonals wide on either side counts as reaching the horizon; own choice."""

GROUND_RATIO = 400.0
"""Half side of the added ground in focus diagonals."""
GROUND_TILE = 3.0
"""Side of its texture in focus diagonals."""


def _direction(elevation_deg: float, azimuth_deg: float) -> list[float]:
    e, a = math.radians(elevation_deg), math.radians(azimuth_deg)
    return [math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)]


def reaches_horizon(candidate: Candidate, focus: Bounds) -> bool:
    """True if a static entity, or a landscape, extends far beyond the focus on all sides."""
    if candidate.spec.terrains:
        return True
    need = HORIZON_RATIO * focus.diagonal
    for name in candidate.built:
        if candidate.spec.entities[name].motion != "static":
            continue
        vertices = candidate.vertices(name, 0)
        low, high = vertices.min(0)[:2], vertices.max(0)[:2]
        if bool(np.all(focus.center[:2] - low >= need) and np.all(high - focus.center[:2] >= need)):
            return True
    return False


def ground_level(candidate: Candidate, focus: Bounds) -> float:
    """Height of the added ground [m]: under everything static, and under what falls, at most one focus diagonal down."""
    names = [n for n in candidate.built if candidate.spec.entities[n].motion == "static"] or list(candidate.built)
    level = min(float(candidate.vertices(n, 0)[:, 2].min()) for n in names)
    for name in candidate.built:
        if candidate.moves(name):
            own = candidate.vertices(name, 0)
            radius = 0.5 * float(np.linalg.norm(np.ptp(own, axis=0)))
            for body in candidate.entity(name).bodies:
                lowest = float(candidate.track(name, body.name)[0][:, 2].min()) - radius
                if lowest < level - radius:
                    level = max(lowest, level - focus.diagonal)
    return level - 2e-4 * focus.diagonal


class _Patch(NamedTuple):
    """Soft round light painted into a dome."""

    elevation_deg: float
    azimuth_deg: float
    radius_deg: float
    irradiance: float
    """On a horizontal plane [W/m^2]."""
    color: tuple[float, float, float]


def _dome(
    mi: Any, rows: list[tuple[float, tuple[float, float, float]]], irradiance: float, patches: Sequence[_Patch] = ()
) -> dict[str, Any]:
    """Environment whose radiance depends on elevation, scaled to a horizontal irradiance [W/m^2], plus patches.

    `rows` are (elevation in degrees, relative RGB) from nadir to zenith.
    """
    count = 128
    elevation = 90.0 - (np.arange(count) + 0.5) * 180.0 / count
    values = np.stack([np.interp(elevation, [e for e, _ in rows], [color[k] for _, color in rows]) for k in range(3)], axis=-1)
    sine, cosine = np.sin(np.radians(elevation)), np.cos(np.radians(elevation))
    cap = cosine * (np.pi / count) * 2 * np.pi
    given = float((values.mean(1) * np.maximum(sine, 0) * cap).sum())
    columns = 2 * count if patches else 8
    image = np.repeat((values * irradiance / given)[:, None], columns, axis=1)
    # Row 0 is the zenith; after the turn to Z up, column u lies at azimuth 90 deg - 360 deg u (tested).
    azimuth = np.radians(90.0 - 360.0 * (np.arange(columns) + 0.5) / columns)
    towards = np.stack(
        [cosine[:, None] * np.cos(azimuth), cosine[:, None] * np.sin(azimuth), np.repeat(sine[:, None], columns, 1)], axis=-1
    )
    for patch in patches:
        angle = np.degrees(np.arccos(np.clip(towards @ _direction(patch.elevation_deg, patch.azimuth_deg), -1, 1)))
        shape = np.clip((patch.radius_deg * 1.15 - angle) / (0.3 * patch.radius_deg), 0, 1)
        weight = float((shape * np.maximum(sine, 0)[:, None] * cap[:, None] / columns).sum())
        image += (shape * patch.irradiance / weight)[..., None] * np.array(patch.color)
    turn = mi.ScalarTransform4f().rotate([1, 0, 0], 90)
    return {"type": "envmap", "bitmap": mi.Bitmap(image.astype(np.float32)), "to_world": turn}


def _panel(mi: Any, position: list[float], target: list[float], size: float, radiance: list[float]) -> dict[str, Any]:
    """Square one-sided emitter at `position` facing `target`."""
    along = np.array(target) - np.array(position)
    up = [0, 0, 1] if np.hypot(along[0], along[1]) > 1e-6 * (1e-9 + np.linalg.norm(along)) else [0, 1, 0]
    place = mi.ScalarTransform4f().look_at(origin=position, target=target, up=up)
    return {
        "type": "rectangle",
        "to_world": place @ mi.ScalarTransform4f().scale([size / 2, size / 2, 1]),
        "emitter": {"type": "area", "radiance": {"type": "rgb", "value": radiance}},
        "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.1}},
    }


def _declared(mi: Any, light: AreaLight) -> dict[str, Any]:
    """A light of the specification: radiance = power / (pi area) per colour."""
    radiance = [light.power * c / (math.pi * light.size**2) for c in light.color]
    return _panel(mi, list(light.position), list(light.target), light.size, radiance)


def lamp_radiance(lamp: Lamp, positions: F32 | F64, faces: NDArray[np.int32]) -> F64:
    """Radiance of a part that shines evenly over its surface, with the flux of its lamp and the colour of a black body [W/(m^2 sr)], shape (3,).

    Args:
        lamp: its lumens and colour temperature.
        positions: corners of the part [m], shape (n, 3).
        faces: its triangles, shape (m, 3).
    """
    corners = positions[faces]
    area = float(0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum())
    color = glow(np.array(lamp.kelvin))
    return np.asarray(color / float(color @ LUMINANCE) * lamp.lumens / DAYLIGHT_EFFICACY / (math.pi * area))


def lamp_shape(mi: Any, lamp: Lamp, name: str, surface: Surface, placed: tuple[F32, F32]) -> Any:
    """A part that shines evenly over its surface."""
    radiance = lamp_radiance(lamp, surface.positions, surface.faces)
    emitter = mi.load_dict({"type": "area", "radiance": rgb(radiance)})
    bsdf = mi.load_dict({"type": "diffuse", "reflectance": rgb((0.8, 0.8, 0.8))})
    return mesh_of(mi, name, (placed[0], surface.faces), bsdf, normals=placed[1], uv=surface.uv, emitter=emitter)


def _studio(mi: Any, look: Look) -> dict[str, Any]:
    """Key, fill and rim soft boxes at infinity, in a dome that fades like a photographer's backdrop."""
    # The horizon is as bright as the lit ground (0.45 x irradiance / pi), so that no line shows where they meet.
    low, high = (1.0, 1.0, 1.01), (0.80, 0.83, 0.88)
    patches = [
        _Patch(50.0, look.sun_azimuth_deg, 16.0, 0.42 * STUDIO_IRRADIANCE, (1.0, 0.96, 0.90)),
        _Patch(45.0, look.sun_azimuth_deg + 115.0, 20.0, 0.08 * STUDIO_IRRADIANCE, (0.90, 0.95, 1.0)),
        _Patch(48.0, look.sun_azimuth_deg + 205.0, 13.0, 0.12 * STUDIO_IRRADIANCE, (1.0, 1.0, 1.0)),
    ]
    rows = [(-90.0, low), (0.0, low), (30.0, high), (90.0, high)]
    return _dome(mi, rows, 0.38 * STUDIO_IRRADIANCE, patches)


def _sun(mi: Any, look: Look, focus: Bounds, reach: float) -> dict[str, Any]:
    """The sun as a far disc with the irradiance that Mitsuba's own sun would give; `reach` is the widest landscape [m].

    As an emitter of its own it is aimed at by every other light sample; inside `sunsky` it gets so few that 16
    samples are mostly noise (measured: 13.6 dB against 1024 samples).
    """
    towards = np.array(_direction(look.sun_elevation_deg, look.sun_azimuth_deg))
    distance = SUN_DISTANCE * max(focus.diagonal, reach / 10, 1e-3)
    half = math.radians(SUN_APERTURE_DEG) / 2
    elevations = [row[0] for row in SUN_IRRADIANCE]
    irradiance = [float(np.interp(look.sun_elevation_deg, elevations, [row[1][k] for row in SUN_IRRADIANCE])) for k in range(3)]
    radiance = [SUN_SKY_SCALE * e / (math.pi * math.sin(half) ** 2) for e in irradiance]
    position = focus.center + distance * towards
    up = [0.0, 0.0, 1.0] if look.sun_elevation_deg < 89.9 else [0.0, 1.0, 0.0]
    place = mi.ScalarTransform4f().look_at(origin=position.tolist(), target=focus.center.tolist(), up=up)
    return {
        "type": "disk",
        "to_world": place @ mi.ScalarTransform4f().scale(distance * math.tan(half)),
        "emitter": {"type": "area", "radiance": {"type": "rgb", "value": radiance}},
        "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}},
    }


def _ground_texture(mi: Any, color: tuple[float, float, float], *, plain: bool) -> dict[str, Any]:
    """Colour of the added ground: mottled outdoors, so that motion and distance read; plain in the studio."""
    if plain:
        return {"type": "rgb", "value": list(color)}
    tile = pattern_tiles("concrete", color)["side"]
    image = np.array(color) + 0.5 * (tile.image - np.array(color))
    return {
        "type": "bitmap",
        "bitmap": mi.Bitmap(np.ascontiguousarray(image, dtype=np.float32)),
        "raw": True,
        "wrap_mode": "mirror",
        "to_uv": mi.ScalarTransform3f().scale(2 * GROUND_RATIO / GROUND_TILE),
    }


def light_dicts(mi: Any, candidate: Candidate) -> dict[str, Any]:
    """Emitters and the added ground of a candidate, as entries of a Mitsuba scene dictionary."""
    look = candidate.spec.look
    focus = focus_bounds(candidate)
    found: dict[str, Any] = {}
    ground: tuple[float, float, float]
    if look.sky == "sunsky":
        found["sky"] = {
            "type": "sunsky",
            "sun_direction": _direction(look.sun_elevation_deg, look.sun_azimuth_deg),
            "turbidity": 3.0,
            "sun_scale": 0.0,
            "sky_scale": SUN_SKY_SCALE,
            "albedo": 0.3,
        }
        reach = max((max(t.extent) for t in candidate.spec.terrains.values()), default=0.0)
        found["sun"] = _sun(mi, look, focus, reach)
        ground = (0.30, 0.29, 0.265)
    elif look.sky == "overcast":
        rows = [(-90.0, (0.25, 0.25, 0.25)), (-1.0, (0.3, 0.3, 0.3)), (1.0, (0.62, 0.64, 0.67)), (90.0, (0.95, 0.98, 1.0))]
        found["sky"] = _dome(mi, rows, OVERCAST_IRRADIANCE)
        ground = (0.36, 0.36, 0.35)
    elif look.sky == "night":
        rows = [(-90.0, (0.2, 0.22, 0.28)), (-1.0, (0.25, 0.28, 0.36)), (1.0, (0.42, 0.52, 0.78)), (90.0, (0.22, 0.32, 0.62))]
        moon = _Patch(look.sun_elevation_deg, look.sun_azimuth_deg, 3.0, 0.7 * NIGHT_IRRADIANCE, (0.92, 0.97, 1.0))
        found["sky"] = _dome(mi, rows, 0.3 * NIGHT_IRRADIANCE, [moon])
        ground = (0.30, 0.29, 0.265)
    else:
        found["sky"] = _studio(mi, look)
        ground = (0.45, 0.45, 0.45)
    found |= {f"light-{name}": _declared(mi, light) for name, light in look.lights.items()}
    if not reaches_horizon(candidate, focus):
        place = mi.ScalarTransform4f().translate([focus.center[0], focus.center[1], ground_level(candidate, focus)])
        found["ground"] = {
            "type": "rectangle",
            "to_world": place @ mi.ScalarTransform4f().scale(GROUND_RATIO * focus.diagonal),
            "bsdf": {"type": "diffuse", "reflectance": _ground_texture(mi, ground, plain=look.sky == "studio")},
        }
    return found
