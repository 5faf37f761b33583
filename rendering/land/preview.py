"""Landscapes in previews: land by its triangles, level water by its planes, rivers painted on the ground, plants as silhouettes."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...geometry.camera import Camera
from ...geometry.idcast import IdCaster
from ...worlds.arrays import F64, pose_of
from ...worlds.built import TriangleMesh
from ...worlds.candidate import Candidate
from ...worlds.landscape import SavedLandscape
from ...worlds.spec import Pose
from .ground_look import ground_image
from .plant_stamps import Stand, draw_plants
from .planting import free_plants, plant_color
from .scenery import drawn_land, landscapes_of
from .triangles import grid_faces
from .waters import courses

__all__ = ["LandLayer"]

CORNERS = 40_000
"""Most corners of the land in a preview."""
FINER = 3
"""Pixels per cell along a side of the picture of the ground."""
SEA, LAKE, RIVER = (0.03, 0.16, 0.24), (0.03, 0.14, 0.17), (0.04, 0.17, 0.22)
"""Linear colours of water."""


class _Land:
    """Land, water and plants of one landscape, which stay the same over pictures."""

    def __init__(self, candidate: Candidate, name: str, land: SavedLandscape) -> None:
        self.cell, self.shape = land.cell, land.shape
        x, y, height = drawn_land(land, CORNERS)
        known = np.isfinite(height)
        keep = known[:-1, :-1] & known[1:, :-1] & known[:-1, 1:] & known[1:, 1:]
        xx, yy = np.meshgrid(x, y)
        vertices = np.stack([xx, yy, np.nan_to_num(height)], axis=-1).reshape(-1, 3)
        self.caster = IdCaster([TriangleMesh(vertices, grid_faces(len(y), len(x), keep))])
        self.sea_level = candidate.spec.terrains[name].sea_level if land.raw("sea").any() else None
        self.lake = land.raw("lake")
        self.levels = {lake["number"]: lake["level"] for lake in sorted(land.about["lakes"], key=lambda k: -k["area"])[:12]}
        solid = land.field("height")
        north, east = np.gradient(np.where(np.isfinite(solid), solid, np.nanmin(solid)), land.cell)
        normal = np.stack([-east, -north, np.ones_like(east)], axis=-1)
        self.normal = normal / np.linalg.norm(normal, axis=-1, keepdims=True)
        self.image = self._painted(ground_image(candidate, land), land)
        self.plants = self._plants(candidate, land)

    def _painted(self, image: np.ndarray, land: SavedLandscape) -> F64:
        """The ground, finer, with its rivers."""
        import cv2

        fine = np.ascontiguousarray(cv2.resize(image, None, fx=FINER, fy=FINER, interpolation=cv2.INTER_LINEAR))
        for course in courses(land):
            pixels = (course.line / land.cell + 0.5 * np.array(land.shape[::-1])) * FINER
            wide = max(1, round(float(course.width.mean()) / land.cell * FINER))
            fixed = np.round(pixels * 16).astype(np.int32).reshape(-1, 1, 2)
            cv2.polylines(fine, [fixed], False, RIVER, wide, cv2.LINE_AA, 4)
        return np.asarray(fine, dtype=np.float64)

    def _plants(self, candidate: Candidate, land: SavedLandscape) -> Stand:
        if "plant_position" not in land.names:
            return Stand(np.zeros((0, 3)), np.zeros(0), (), np.zeros(0, dtype=np.int64), np.zeros((0, 3)))
        chosen = free_plants(candidate, land)
        kind, tall = land.raw("plant_kind")[chosen], land.raw("plant_height")[chosen].astype(float)
        shapes = tuple(land.about["plant_shapes"])
        colors = np.array([plant_color(shape) for shape in shapes])
        tint = np.random.default_rng(9).uniform(0.75, 1.3, len(kind))
        return Stand(land.raw("plant_position")[chosen], tall, shapes, kind, colors[kind] * tint[:, None])

    def _at(self, points: F64, factor: int) -> tuple[np.ndarray, np.ndarray]:
        rows, cols = self.shape
        col = np.clip((points[:, 0] / self.cell + 0.5 * cols) * factor, 0, cols * factor - 1).astype(np.int64)
        row = np.clip((points[:, 1] / self.cell + 0.5 * rows) * factor, 0, rows * factor - 1).astype(np.int64)
        return row, col

    def shaded(self, points: F64, sun: F64) -> F64:
        """Light that the ground gives back at points (n, 3)."""
        row, col = self._at(points, 1)
        lit = np.maximum(self.normal[row, col] @ sun, 0.0)
        fine = self._at(points, FINER)
        return np.asarray(self.image[fine] * (0.5 + 1.9 * lit)[:, None])

    def waters(self, eye: F64, directions: F64, along: F64) -> tuple[F64, F64]:
        """Depth of level water per pixel [m], infinite where there is none, and its colour."""
        depth = np.full(along.shape, np.inf)
        color = np.zeros((*along.shape, 3))
        down = directions[..., 2] < -1e-5
        planes = [(level, SEA, 0) for level in (self.sea_level,) if level is not None]
        planes += [(level, LAKE, number) for number, level in self.levels.items()]
        for level, paint, number in planes:
            reach = np.where(down, (level - eye[2]) / np.where(down, directions[..., 2], -1.0), -1.0)
            hit = reach > 0
            if number:
                points = eye + directions[hit] * reach[hit][:, None]
                hit[hit] = self.lake[self._at(points, 1)] == number
            new = hit & (reach * along < depth)
            depth[new] = (reach * along)[new]
            sheen = np.exp(-4.0 * np.abs(directions[..., 2]))[..., None]
            color[new] = (np.array(paint) * (1 - sheen) + np.array([0.45, 0.55, 0.65]) * sheen)[new]
        return depth, color


class LandLayer:
    """The built landscapes of a candidate, to be painted under and before its bodies."""

    def __init__(self, candidate: Candidate) -> None:
        self.lands = {name: _Land(candidate, name, land) for name, land in landscapes_of(candidate).items()}

    def paint(self, picture: Any, depth: Any, ground: dict[str, np.ndarray], camera: Camera, sun: F64) -> F64:
        """Paint landscapes into a linear picture (height, width, 3) where they are nearer than what is there.

        Args:
            picture: changed in place.
            depth: of what is there, along the viewing axis [m], shape (height, width), infinite for none.
            ground: per landscape, pixels that show the ground that an entity carries of it.
            camera: the view.
            sun: direction to the sun.

        Returns:
            the depth afterwards.
        """
        eye, directions = camera.rays()
        along = -(directions @ camera.axes[2])
        found: F64 = np.array(depth, dtype=np.float64)
        for name, land in self.lands.items():
            seen = land.caster.cast(camera, [pose_of(Pose())])
            near = (seen.ids >= 0) & (seen.depth < found)
            found = np.where(near, seen.depth, found)
            shown = near | ground.get(name, np.zeros_like(near))
            points = eye + directions[shown] * (found[shown] / along[shown])[:, None]
            picture[shown] = land.shaded(points, sun)
            wet, color = land.waters(eye, directions, along)
            over = wet < found
            picture[over] = color[over]
            found = np.where(over, wet, found)
            draw_plants(picture, found, land.plants, camera, 0.8 + 1.4 * float(sun[2]))
        return found
