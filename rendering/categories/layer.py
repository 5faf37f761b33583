"""Layer of one category of matter: its entities are drawn by their parts, or as loose matter with a cast of its own."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np

from ...geometry.camera import Camera
from ...geometry.idcast import IdImage
from ...worlds.arrays import F64
from ...worlds.built import BuiltPart, TriangleMesh
from ...worlds.candidate import Candidate

if TYPE_CHECKING:
    from ..tracer.surfaces import Surface
    from .soft_part import SoftPart

__all__ = ["GLOWS", "Daylight", "Fog", "Layer", "LooseLayer", "PartsLayer", "TracedShapes", "VolumeLayer", "over"]


GLOWS = tuple(f"glow{k}" for k in range(8))
"""Kinds of lights that stand for the heat of a gas, of which a scene of the path tracer has no other."""


def over(behind: IdImage, before: IdImage, first: int, front: Any = None) -> IdImage:
    """The second cast over the first where `front` says, default where it is nearer; its ids count from `first`."""
    if front is None:
        front = (before.ids >= 0) & (before.depth < behind.depth)
    return IdImage(
        np.where(front, before.ids + first, behind.ids).astype(np.int32),
        np.where(front, before.depth, behind.depth),
        np.where(front[..., None], before.normals, behind.normals),
    )


class Layer:
    """The entities of one category in one candidate, as pictures show them."""

    quantities: ClassVar[tuple[str, ...]] = ()
    """Recorded or derived quantities that a plot of the records shows for this category unless told otherwise."""

    nearer: ClassVar[float] = 0.0
    """Distance by which plans and sections draw it nearer, in spans of the picture, so that it shows before walls it reaches into."""

    def __init__(self, candidate: Candidate, entities: Sequence[str]) -> None:
        self.candidate = candidate
        self.entities: tuple[str, ...] = tuple(entities)
        """Ids, which pictures draw."""

    def extents(self) -> list[tuple[F64, F64]]:
        """Corners (3,) of boxes that an automatic camera frames beside the bodies and their paths [m]."""
        return []

    def meshes(self, entity: str, frame: int) -> list[TriangleMesh]:
        """Meshes of an entity in the world at a frame, for plans and sections."""
        parts = self.candidate.built[entity].parts
        return [TriangleMesh(self.candidate.surface(entity, p.part, frame), p.render.faces) for p in parts]


class PartsLayer(Layer):
    """Bodies: the render surface of each part, at the pose of its body."""

    quantities = ("min_gap", "contacts")

    def bends(self, entity: str) -> bool:
        """True where the surface of an entity changes its form from frame to frame."""
        return False

    def tone(self, entity: str, part: str) -> float:
        """Share of its material's colour that a part shows."""
        return 1.0

    def soft(self, entity: str, part: BuiltPart, surface: Surface, start: int) -> SoftPart | None:
        """Binding of a batch's vertices from row `start` on to a part that bends; None for a part that keeps its form."""
        return None


class Fog(NamedTuple):
    """A box whose inside takes and scatters light, in a scene of the path tracer."""

    low: F64
    """Lower corner [m], shape (3,)."""
    high: F64
    medium: Any
    """Mitsuba medium."""


@dataclass(frozen=True)
class TracedShapes:
    """Shapes that a layer adds to a scene of the path tracer at one frame."""

    shapes: dict[str, Any]
    """By name."""
    clear: Mapping[str, F64] = field(default_factory=dict)
    """Absorption [1/m] per colour of those that light passes through, by name."""
    fogs: Mapping[str, Fog] = field(default_factory=dict)
    """Those that are boxes of gas, by name."""


class LooseLayer(Layer, ABC):
    """Matter without parts of its own: cast beside the bodies, shapes anew in every frame."""

    opaque: ClassVar[bool] = True
    """Hides and shadows what is behind, like a body; else `paint` lays its colour over what is seen through it."""

    @abstractmethod
    def cast(self, frame: int, camera: Camera, entity: str | None = None) -> IdImage:
        """The view of all its entities, or of one, if nothing else were there; ids are indices into `entities`."""

    @abstractmethod
    def traced(self, mi: Any, frame: int) -> TracedShapes:
        """Mitsuba shapes at a frame."""

    @property
    @abstractmethod
    def colors(self) -> F64:
        """Linear RGB per entity, shape (n, 3)."""

    def paint(self, below: F64, ids: Any, normals: F64, directions: F64, sun: F64, sky: tuple[float, ...]) -> F64:
        """Linear RGB of pixels of a preview that show this layer, shape (n, 3).

        Args:
            below: colour behind (n, 3).
            ids: index into `entities` of what is seen (n,).
            normals: of what is seen (n, 3).
            directions: of sight (n, 3).
            sun: unit vector towards it.
            sky: colour that smooth faces mirror.
        """
        return np.asarray(self.colors[ids])


class Daylight(NamedTuple):
    """Light of previews, as radiance of white sheets, each linear RGB of shape (3,)."""

    sun: F64
    """Unit vector towards it."""
    sunlight: F64
    """Radiance of a sheet that faces the sun."""
    sky: F64
    """Radiance of a sheet that faces up and sees no sun."""
    ground: F64
    """Radiance of a sheet that faces down."""
    share: Callable[[F64], Any]
    """Share of sunlight that bodies leave at points (n, 3), shape (n,)."""


class VolumeLayer(LooseLayer):
    """Matter without a face, which dims and lights up what is seen through it; its cast says where it is thick."""

    opaque = False
    thick: ClassVar[float]
    """Optical depth from which on a pixel counts as its own."""

    @abstractmethod
    def depths(self, frame: int, camera: Camera, spans: F64, entity: str | None = None) -> F64:
        """Optical depth of all its entities, or of one, along the sight of each pixel, shape (height, width).

        Args:
            frame: frame index.
            camera: the view.
            spans: first and last depth along the viewing axis [m], shape (height, width, 2).
            entity: id.
        """

    @abstractmethod
    def glowing(self, frame: int, camera: Camera, spans: F64, entity: str) -> F64:
        """Radiance of the heat of one entity along the sight of each pixel [W/(m^2 sr)], shape (height, width, 3); spans as in `depths`."""

    @abstractmethod
    def laid(self, picture: F64, depth: Any, frame: int, camera: Camera, light: Daylight) -> tuple[F64, F64]:
        """A linear picture (height, width, 3) through the matter before what is there, and the share of that which it shows (height, width).

        Args:
            picture: what is there.
            depth: of what is there along the viewing axis [m], infinite for none, shape (height, width).
            frame: frame index.
            camera: the view.
            light: that falls on the matter.
        """

    @abstractmethod
    def dimmed(self, frame: int, points: F64, sun: F64) -> F64:
        """Share of sunlight that comes through the matter to points (n, 3) [m], shape (n, 3): one per colour."""
