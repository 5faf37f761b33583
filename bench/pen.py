"""Benchmark `pen`: the benchmark's depth of penetration against closed forms, and against Blender's tree on the same meshes where it is there."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ..geometry import Solid
from ..worlds.arrays import F64, I32, RigidPose
from ..worlds.built import TriangleMesh
from .clearance import box_mesh
from .contact_shapes import sphere
from .evaluation.metrics.pen import FRAMES, LEAST_DEPTH, Evaluated, penetration, sampled_frames
from .evaluation.metrics.pen_peer import peer_depths

__all__ = ["cases", "run", "seen_shares"]

COUNT = 49
"""Frames of a moving case: every second one is looked at, the deepest among them."""


class Case(NamedTuple):
    """Objects that move, and what the metric must give."""

    objects: Callable[[int], list[Evaluated]]
    frames: int
    """Number of frames."""
    depth: float
    """[m] Largest depth over the frames that are looked at."""
    scale: float
    """[m] Diagonal of the scene at frame 0."""

    @property
    def score(self) -> float:
        """100 depth / L."""
        return 100.0 * self.depth / self.scale


def _body(name: str, mesh: tuple[F64, I32], at: Any, *, dynamic: bool = True, closed: bool = True) -> Evaluated:
    return Evaluated(name, name, dynamic, closed, mesh[0] + np.asarray(at, dtype=np.float64), mesh[1])


def _towards_x(mesh: tuple[F64, I32]) -> tuple[F64, I32]:
    """The mesh turned so that its first vertex looks along +x."""
    first = mesh[0][0] / np.linalg.norm(mesh[0][0])
    other = np.cross(first, [0.0, 0.0, 1.0])
    other /= np.linalg.norm(other)
    return mesh[0] @ np.stack([first, other, np.cross(first, other)]).T, mesh[1]


def _spheres(*, both: bool, moving: bool) -> Case:
    """A coarse ball whose foremost vertex dips into a fine one: the vertex at x is r - |x - c| deep in the other."""
    small, large, dip = 0.2, 0.5, 0.02
    coarse, fine = _towards_x(sphere(small, 1)), sphere(large, 5)

    def gap(frame: int) -> float:
        # There and back, deepest at the middle frame.
        return 0.1 * abs(2.0 * frame / (COUNT - 1) - 1.0) if moving else 0.0

    def objects(frame: int) -> list[Evaluated]:
        return [_body("ball", coarse, (-small - large + dip - gap(frame), 0, 0)), _body("rock", fine, (0, 0, 0), dynamic=both)]

    count = COUNT if moving else 1
    deepest = max(dip - gap(k) for k in sampled_frames(count))
    long = 2 * (small + large) - dip + gap(0)
    return Case(objects, count, deepest, math.hypot(long, 2 * large, 2 * large))


def _boxes(*, both: bool) -> Case:
    """A box on one corner, which falls 1 cm per frame into the top of another: the corner's depth is that below the top."""
    turn = np.array([math.cos(0.4), *(math.sin(0.4) * np.array([0.6, 0.8, 0.0]))])
    corners, faces = box_mesh((0.3, 0.2, 0.25))
    tilted = RigidPose(np.zeros(3), turn).apply(corners)
    lowest, step, count = float(tilted[:, 2].min()), 0.01, 5

    def objects(frame: int) -> list[Evaluated]:
        height = 0.5 - lowest - step * frame
        return [
            _body("crate", (tilted, faces), (0, 0, height)),
            _body("table", box_mesh((2.0, 2.0, 1.0)), (0, 0, 0), dynamic=both),
        ]

    top = 0.5 - lowest + float(tilted[:, 2].max())
    return Case(objects, count, step * (count - 1), math.hypot(2.0, 2.0, top + 0.5))


def _bowl() -> Case:
    """A ball in a round bowl of a wall's thickness: its lowest vertex is |x| - R beyond the inner surface."""
    inner, outer, small, dip = 0.5, 0.6, 0.2, 0.01
    shell = _shell(inner, outer)
    coarse = _towards_x(sphere(small, 1))
    down = (coarse[0] @ np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]), coarse[1])
    low = _body("ball", down, (0.0, 0.0, -(inner - small + dip)))
    bowl = _body("bowl", shell, (0, 0, 0), dynamic=False)
    return Case(
        lambda _: [low, bowl],
        1,
        dip,
        math.hypot(2 * outer, 2 * outer, float(np.ptp(np.concatenate([low.vertices, bowl.vertices])[:, 2]))),
    )


def _shell(inner: float, outer: float, around: int = 256, down: int = 64) -> tuple[F64, I32]:
    """A closed half shell, opening upwards: an outline of outer and inner quarter circle turned about z."""
    angle = np.linspace(-math.pi / 2, 0.0, down + 1)
    quarter = np.c_[np.cos(angle), np.sin(angle)]
    quarter[0, 0] = 0.0  # the foot is one point
    outline = np.concatenate([outer * quarter, inner * quarter[::-1]])
    turns = np.linspace(0.0, 2 * math.pi, around, endpoint=False)
    points = np.stack([np.c_[r * np.cos(turns), r * np.sin(turns), np.full(around, z)] for r, z in outline])
    row, column = np.meshgrid(np.arange(len(outline) - 1), np.arange(around), indexing="ij")
    after = (column + 1) % around
    a, b, c, d = (row * around + column, row * around + after, (row + 1) * around + after, (row + 1) * around + column)
    faces = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    solid = Solid.from_mesh(TriangleMesh(points.reshape(-1, 3), faces.astype(np.int32)), closed=True)
    return solid.vertices, solid.faces


def _touch() -> Case:
    """A dip of a hundredth of a millimetre counts as a tenth (R143)."""
    ball, rock = _towards_x(sphere(0.2, 2)), box_mesh((1.0, 1.0, 1.0))
    objects = [_body("ball", ball, (-0.7 + 1e-5, 0, 0)), _body("rock", rock, (0, 0, 0), dynamic=False)]
    low, high = np.array([o.box for o in objects]).min(axis=(0, 1)), np.array([o.box for o in objects]).max(axis=(0, 1))
    return Case(lambda _: objects, 1, LEAST_DEPTH, float(np.linalg.norm(high - low)))


def cases() -> dict[str, Case]:
    """All analytic cases by name."""
    return {
        "spheres": _spheres(both=False, moving=False),
        "spheres_both_dynamic": _spheres(both=True, moving=False),
        "spheres_moving": _spheres(both=True, moving=True),
        "boxes_falling": _boxes(both=False),
        "boxes_both_dynamic": _boxes(both=True),
        "sphere_in_bowl": _bowl(),
        "touch": _touch(),
    }


def seen_shares() -> dict[str, float]:
    """Depth that the definition sees of a ball sunk by a tenth of its radius, over its true depth, by triangles of the ball.

    Only corners of crossing triangles are asked (R143), so that of finer meshes less is seen: a limit of the metric, not of this code.
    """
    floor = _body("floor", box_mesh((2.0, 2.0, 0.5)), (0, 0, -0.25), dynamic=False)
    shares = {}
    for splits in (1, 2, 3, 4):
        coarse = _towards_x(sphere(0.2, splits))
        down = (coarse[0] @ np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]), coarse[1])
        found = penetration(lambda _, mesh=down: [_body("ball", mesh, (0, 0, 0.18)), floor], (0,))  # type: ignore[misc]
        shares[str(len(coarse[1]))] = found.depth / 0.02
    return shares


def run() -> dict[str, Any]:
    """Largest relative error of the score over the cases, seconds of each, and Blender's depths over ours."""
    figures: dict[str, Any] = {}
    worst, compared = 0.0, []
    for name, case in cases().items():
        started = time.perf_counter()
        found = penetration(case.objects, sampled_frames(case.frames))
        error = abs(found.score - case.score) / case.score
        worst = max(worst, error)
        figures[name] = {
            "score": found.score,
            "closed_form": case.score,
            "relative_error": error,
            "seconds": time.perf_counter() - started,
        }
        if found.worst is not None:
            compared.append((case.objects(found.worst.frame), found.worst))
    return {
        "frames": FRAMES,
        "cases": figures,
        "max_relative_error": worst,
        "seen_of_depth_by_triangles": seen_shares(),
        "blender": peer_depths(compared),
    }
