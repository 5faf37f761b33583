"""Light, exposure and colour with which a subject would be seen."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...worlds.spec import AreaLight
from ..categories.registry import judge_of
from ..rows.corrections import correction, pointer, set_value
from .bounds import DARK, MIDDLE_GREY

if TYPE_CHECKING:
    from ...worlds.plates import View
    from ...worlds.requirements import Correction
    from .sight import Sight

__all__ = ["Shade", "brighter", "darker", "dimmed", "lit", "recoloured"]

FILL = 300.0
"""[W/m^2] Own choice: irradiance that a suggested light gives its subject, some half of a clear sky's with its sun."""
UP, BACK, WIDE = 0.35, 0.25, 0.5
"""Own choice: how far above and behind the camera a suggested light stands, and its side, in distances of the subject: out of the picture."""
LEAST_LUMINANCE = 1.0 / 255.0 / 12.92
"""The darkest that 8 bits tell from black."""
MOST_LIGHTS = 16
"""`max_length` of `look.lights`."""
PALE, DEEP = 0.8, 0.05
"""Own choice: largest component of a colour that stands out before a dark and before a light background."""


class Shade(NamedTuple):
    """Lightness of a subject in a picture, and of what is around it."""

    luminance: float
    """Mean of the subject's pixels; white is 1."""
    subject: float
    """Median lightness of its pixels (CIELAB L*, 0..100)."""
    behind: float
    """The same of what is seen in its place without it."""
    picture: float
    """The same of the whole picture."""


def brighter(sight: Sight, view: View, shade: Shade) -> list[Correction]:
    """Edits that lift a subject out of the dark, the likeliest first."""
    exposure, light = sight.candidate.spec.look.exposure, lit(sight, view, f"hardly any light reaches {view.subject}")
    if shade.picture >= DARK:  # the picture is well exposed, its subject in the dark
        return [light]
    if exposure < 0.0:
        return [_exposed(0.0, f"the picture is exposed {-exposure:g} stops below what the meter gives"), light]
    stops = math.log2(MIDDLE_GREY / max(shade.luminance, LEAST_LUMINANCE))
    cause = f"mean luminance {shade.luminance:.4f} of white"
    return [_exposed(min(10.0, exposure + stops), f"{cause}: {stops:.1f} stops below middle grey"), light]


def darker(sight: Sight, view: View, shade: Shade) -> list[Correction]:
    """Edits that take light off a subject that is as white as all around it."""
    exposure = sight.candidate.spec.look.exposure
    if exposure > 0.0:
        return [_exposed(0.0, f"the picture is exposed {exposure:g} stops above what the meter gives")]
    stops = math.log2(max(shade.luminance, MIDDLE_GREY) / MIDDLE_GREY)
    return [
        _exposed(max(-10.0, exposure - stops), f"mean luminance {shade.luminance:.2f} of white: {stops:.1f} stops above grey")
    ]


def _exposed(value: float, cause: str) -> Correction:
    place = pointer("look", "exposure")
    stops = round(value, 2)
    return correction(cause, "look", f"set the exposure to {stops:g} stops", pointers=(place,), patch=set_value(place, stops))


def dimmed(sight: Sight, view: View) -> list[Correction]:
    """Less light from elsewhere on what glows by itself; as a ready edit where the sky gives that light."""
    look = sight.candidate.spec.look
    cause = f"{view.subject} glows, and the light of the scene drowns it"
    place = pointer("look", "sky")
    if look.sky == "night":
        place = pointer("look", "lights")
        return [correction(cause, "look", "take lamps away from it, or lower their power", pointers=(place,))]
    text = f"take the sky 'night' in place of {look.sky!r}, and lamps where the rest must be seen"
    return [correction(cause, "look", text, pointers=(place,), patch=set_value(place, "night"))]


def lit(sight: Sight, view: View, cause: str) -> Correction:
    """A light behind the camera that shines on the subject; as a ready edit where one more is allowed."""
    candidate = sight.candidate
    camera = sight.camera(view.shot, view.frame)
    center = judge_of(candidate.spec, view.subject).centers(candidate, view.subject)[view.frame]
    if not np.isfinite(center).all():
        center = camera.target
    away = float(np.linalg.norm(center - camera.position))
    position = camera.position + away * (UP * camera.axes[1] + BACK * camera.axes[2])
    power = math.pi * float(np.sum((center - position) ** 2)) * FILL
    light = AreaLight(
        position=_rounded(position), target=_rounded(center), size=round(WIDE * away, 4), power=float(f"{power:.3g}")
    )
    name, lights = f"on-{view.subject}"[:60], candidate.spec.look.lights
    place = pointer("look", "lights", name)
    free = len(lights) < MOST_LIGHTS and name not in lights
    where = ", ".join(f"{c:.2f}" for c in light.position)
    action = f"put a light of {light.power:g} W at ({where}) m, behind the camera, and aim it at {view.subject}"
    patch = set_value(place, light.model_dump(mode="json")) if free else ()
    return correction(cause, "look", action, pointers=(place if free else "/look/lights",), patch=patch)


def _rounded(point: np.ndarray) -> tuple[float, float, float]:
    x, y, z = (round(float(c), 4) for c in point)
    return x, y, z


def recoloured(sight: Sight, view: View, shade: Shade) -> list[Correction]:
    """A colour of the subject that differs from what is behind it; as a ready edit where no other entity has its material."""
    spec = sight.candidate.spec
    entity = spec.entities[view.subject]
    names = {entity.material, *(p.material for p in entity.parts.values() if p.material)}
    shared = {
        m for n, e in spec.entities.items() if n != view.subject for m in (e.material, *(p.material for p in e.parts.values()))
    }
    cause = f"{view.subject} has the colour of what is behind it"
    action = (
        f"give {view.subject} another colour than what is behind it; where the prompt names its colour, change what is behind it"
    )
    place = pointer("materials", entity.material, "appearance", "color")
    if names & shared or len(names) > 1 or entity.material not in spec.materials:
        return [correction(cause, "look", action, pointers=(place,))]
    old = spec.materials[entity.material].appearance.color
    peak = max(*old, 1e-3)
    wanted = DEEP if shade.behind > 50.0 else PALE
    color = [round(min(1.0, max(c, 0.02 * peak) * wanted / peak), 4) for c in old]
    text = f"{action}: e.g. the {'darker' if wanted == DEEP else 'lighter'} ({', '.join(f'{c:g}' for c in color)})"
    return [correction(cause, "look", text, pointers=(place,), patch=set_value(place, color))]
