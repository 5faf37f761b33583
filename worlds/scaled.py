"""An entity larger or smaller by a factor about its own origin, as JSON: shapes, places of parts, declared size and mass."""

from __future__ import annotations

import copy
from typing import Any

from .errors import InputError
from .spec import WorldSpec

__all__ = ["scaled_entity"]

LENGTHS = ("size", "radius", "height", "length", "depth", "polygon", "profile", "points", "path", "position", "move")
"""Fields of shapes, of their members and of poses that are lengths [m], alone or in lists."""
NESTED = ("of", "sections", "shape", "pose", "repeat")
"""Fields that hold members, sections, or their shapes and places."""
FIXED = ("heightfield", "stems", "sheet")
"""Shapes of other matter or of files that stand for places, which are not scaled."""


def scaled_entity(spec: WorldSpec, name: str, factor: float) -> dict[str, Any]:
    """An entity of a specification, scaled: density stays, a declared mass goes with the cube.

    Raises:
        InputError: it is no plain rigid entity of parts, whose size means nothing else.
    """
    entity = spec.entities[name]
    document: dict[str, Any] = copy.deepcopy(entity.model_dump(mode="json", exclude_none=True))
    if factor == 1.0:
        return document
    fixed = [k for k, p in entity.parts.items() if p.shape.kind in FIXED]
    if entity.physics.shape != "solid" or entity.breakable is not None or not entity.parts or fixed:
        raise InputError(
            f"sizes vary of rigid entities made of parts, without pieces, grounds and sheets; {name!r} is none: leave size out"
        )
    for part in document["parts"].values():
        shape = part["shape"]
        if shape["kind"] == "mesh":
            shape["scale"] = factor * shape.get("scale", 1.0)
        else:
            _scale(shape, factor)
        part["pose"]["position"] = _times(part["pose"]["position"], factor)
    document["dimensions"]["size"] = _times(document["dimensions"]["size"], factor)
    if "nominal_diagonal" in document:
        document["nominal_diagonal"] *= factor
    if "mass" in document["physics"]:
        document["physics"]["mass"] *= factor**3
    return document


def _scale(document: dict[str, Any], factor: float) -> None:
    """Multiply every length of a shape's document, those of its members and sections too."""
    document.update({k: _times(document[k], factor) for k in LENGTHS if k in document})
    for key in NESTED:
        below = document.get(key)
        for inner in below if isinstance(below, list) else [below] if below else []:
            _scale(inner, factor)


def _times(value: Any, factor: float) -> Any:
    return [_times(v, factor) for v in value] if isinstance(value, list) else value * factor
