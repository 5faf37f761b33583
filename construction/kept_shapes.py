"""Shapes made concrete, kept by content: a hundred equal panes, handles and legs of furniture are built and measured once."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from ..geometry.recent import Recent
from ..worlds.spec import HeightField, Mesh, Shape, StemField
from .primitives import ShapeGeometry, build_shape

__all__ = ["KeptShape", "kept_shape"]

KEPT_VERTICES = 1_500_000
"""Vertices of the meshes that are kept at most: about 100 MB with their triangles."""
FROM_FILES = (HeightField, Mesh, StemField)
"""Shapes that files decide, which may change; large ones besides."""

_Found = TypeVar("_Found")


class KeptShape:
    """A shape with what was measured of it."""

    def __init__(self, geometry: ShapeGeometry) -> None:
        for array in (geometry.render.vertices, geometry.render.faces):
            array.setflags(write=False)
        for piece in geometry.collision:
            piece.points.setflags(write=False)
        self.geometry = geometry
        self._measured: dict[Any, Any] = {}

    def measured(self, what: Any, measure: Callable[[], _Found]) -> _Found:
        """The measure of a name, taken the first time that it is asked for."""
        if what not in self._measured:
            self._measured[what] = measure()
        found: _Found = self._measured[what]
        return found


_kept: Recent[KeptShape] = Recent(KEPT_VERTICES)
"""By the shape as JSON."""


def kept_shape(shape: Shape, assets: Path) -> KeptShape:
    """A shape as `build_shape` makes it, of equal ones the same; its arrays cannot be written to.

    Raises:
        InputError: as `build_shape`.
    """
    if isinstance(shape, FROM_FILES):
        return KeptShape(build_shape(shape, assets))
    key = f"{shape.kind}{shape.model_dump_json()}"
    return _kept.of(key, lambda: KeptShape(build_shape(shape, assets)), lambda kept: len(kept.geometry.render.vertices))
