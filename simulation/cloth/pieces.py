"""One part of a cloth entity: what it is made of, and its sheet as far as it is whole."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ...worlds.arrays import F64, I32, pose_of
from ...worlds.categories.cloth.tears import seams_of
from ...worlds.errors import InputError
from .mesh import Fabric, Sheet, sheet_of
from .tearing import Tearing

if TYPE_CHECKING:
    from ...worlds.built import BuiltPart
    from ...worlds.spec import ClothPhysics, Entity

__all__ = ["Piece", "piece_of"]


@dataclass(frozen=True)
class Piece:
    """A part at rest. Its written vertices are those of its simulation mesh: of one that can tear, corners of triangles."""

    member: str
    rest: F64
    """Written vertices in the world at frame 0 (c, 3) [m]."""
    faces: I32
    """Among them (t, 3)."""
    fabric: Fabric
    warp: F64
    flat: bool
    tearing: Tearing | None

    def weld(self) -> I32:
        """Vertex of the sheet at each written vertex, shape (c,)."""
        return np.arange(len(self.rest), dtype=np.int32) if self.tearing is None else self.tearing.weld()

    def sheet(self, weld: I32) -> Sheet:
        """The sheet at rest with these vertices."""
        count = int(weld.max()) + 1
        first = np.full(count, len(weld), dtype=np.int64)
        np.minimum.at(first, weld, np.arange(len(weld)))
        sheet = sheet_of(self.rest[first], weld[self.faces], self.fabric, warp=self.warp, flat=self.flat)
        return sheet if self.tearing is None else replace(sheet, kin=self.tearing.seams.kin[first])


def piece_of(member: str, entity: Entity, physics: ClothPhysics, part: BuiltPart) -> Piece:
    """A built part.

    Raises:
        InputError: it has no simulation mesh, or one that cannot tear and has to.
    """
    if part.simulation is None:
        raise InputError(f"part {part.part!r} has no simulation mesh; call place_object again")
    pose = pose_of(entity.pose)
    stretch = physics.stretch_stiffness
    fabric = Fabric(
        area_density=physics.area_density,
        stretch=(stretch, physics.weft_stiffness or stretch),
        shear=physics.shear_stiffness or 0.1 * stretch,
        bend=physics.bend_stiffness,
        damping=physics.damping,
        thickness=physics.thickness,
    )
    turn = pose.apply(np.eye(3)) - pose.position
    axis = pose_of(entity.parts[part.part].pose)
    warp = (axis.apply(np.eye(3)) - axis.position)[0] @ turn
    tearing = None
    if physics.tear is not None:
        seams = seams_of(part.simulation.vertices)
        tearing = Tearing(seams, physics.tear.strength, np.zeros(len(seams.kin), dtype=bool))
    return Piece(member, pose.apply(part.simulation.vertices), part.simulation.faces, fabric, warp, physics.flat, tearing)
