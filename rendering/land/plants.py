"""Plants and stones of a landscape as triangles, in three grades of detail.

A form stands on the origin, is one unit high, and is placed by scale, turn and shift; all instances of a kind become one mesh.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...worlds.arrays import F64

__all__ = ["Form", "form_of", "placed"]

LEAF_CLUSTERS = 90
"""Leaf clusters of a tree near a camera. Own choice: a crown closes from about sixty."""


class Form(NamedTuple):
    """Triangles of a plant of unit height: corners (n, 3), faces (m, 3), and per face whether it is foliage."""

    vertices: F64
    faces: np.ndarray
    foliage: np.ndarray


def form_of(shape: str, *, detail: int, seed: int) -> Form:
    """The form of a kind.

    Args:
        shape: `broad`, `cone`, `palm`, `bush`, `tuft`, `column` or `rock`.
        detail: 0 a few triangles, 1 a low form, 2 with branches and leaves.
        seed: of its irregularity.
    """
    rng = np.random.default_rng([seed, 7])
    if detail == 0:
        return _far(shape, rng)
    near = detail == 2
    makers = {"broad": _broad, "cone": _cone, "palm": _palm, "bush": _bush, "tuft": _tuft, "column": _column, "rock": _rock}
    return makers[shape](rng, near)


_FAR = {"broad": (0.3, 0.5, 0.3), "cone": (0.19, 0.1, 0.12), "palm": (0.3, 0.82, 0.7), "bush": (0.55, 0.4, 0.0),
        "tuft": (0.15, 0.5, 0.0), "column": (0.06, 0.5, 0.0), "rock": (0.65, 0.3, -0.2)}  # fmt: skip
"""Far forms: half the width, height of the widest part, foot, over the height of the plant."""


def _far(shape: str, rng: np.random.Generator) -> Form:
    """A crown of two rings as wide and high as the plant; a pyramid for what is pointed."""
    wide, middle, foot = _FAR[shape]
    turn = np.arange(5) * 2 * np.pi / 5 + rng.uniform()
    k = np.arange(5)
    n = (k + 1) % 5

    def ring(radius: float, z: float) -> F64:
        ragged = radius * (1 + rng.uniform(-0.15, 0.15, 5))
        return np.stack([ragged * np.cos(turn), ragged * np.sin(turn), np.full(5, z) + rng.uniform(-0.04, 0.04, 5)], 1)

    top, tip, bottom = np.full(5, 5), np.array([[0, 0, 1.0 if shape != "rock" else 0.85]]), np.array([[0, 0, foot]])
    if shape in ("cone", "tuft", "column"):
        faces = np.concatenate([np.stack([k, n, top], 1), np.stack([n, k, top + 1], 1)])
        vertices = np.concatenate([ring(wide, middle), tip, bottom])
    else:
        sides = [np.stack([k, n, n + 5], 1), np.stack([k, n + 5, k + 5], 1)]
        faces = np.concatenate([*sides, np.stack([k + 5, n + 5, top + 5], 1), np.stack([n, k, top + 6], 1)])
        vertices = np.concatenate([ring(wide, middle), ring(0.65 * wide, 0.3 * middle + 0.63), tip, bottom])
    return Form(vertices, faces, np.full(len(faces), shape != "rock"))


def placed(form: Form, position: F64, height: F64, yaw: F64) -> tuple[F64, np.ndarray]:
    """All instances of a form as one mesh.

    Args:
        form: of unit height.
        position: of the feet [m], shape (n, 3).
        height: [m], shape (n,).
        yaw: [rad], shape (n,).

    Returns:
        vertices (n * k, 3) and faces (n * m, 3).
    """
    c, s = np.cos(yaw)[:, None], np.sin(yaw)[:, None]
    x, y, z = form.vertices.T
    corners = np.stack([c * x - s * y, s * x + c * y, np.broadcast_to(z, (len(yaw), len(z)))], axis=-1) * height[:, None, None]
    shifted = corners + position[:, None, :]
    step = np.arange(len(yaw))[:, None, None] * len(form.vertices)
    return shifted.reshape(-1, 3), (form.faces[None] + step).reshape(-1, 3)


def _join(parts: list[tuple[F64, np.ndarray, bool]]) -> Form:
    starts = np.cumsum([0, *(len(v) for v, _, _ in parts)])
    return Form(
        np.concatenate([v for v, _, _ in parts]),
        np.concatenate([f + s for (_, f, _), s in zip(parts, starts, strict=False)]),
        np.concatenate([np.full(len(f), leaf) for _, f, leaf in parts]),
    )


def _stem(base: F64, tip: F64, low: float, high: float, sides: int) -> tuple[F64, np.ndarray, bool]:
    """A tapered tube between two points."""
    axis = (tip - base) / max(float(np.linalg.norm(tip - base)), 1e-9)
    side = np.cross(axis, [0.0, 1.0, 0.0] if abs(axis[1]) < 0.9 else [1.0, 0.0, 0.0])
    side /= np.linalg.norm(side)
    other = np.cross(axis, side)
    turn = np.arange(sides) * 2 * np.pi / sides
    ring = np.cos(turn)[:, None] * side + np.sin(turn)[:, None] * other
    vertices = np.concatenate([base + low * ring, tip + high * ring])
    k, n = np.arange(sides), np.roll(np.arange(sides), -1)
    faces = np.concatenate([np.stack([k, n, n + sides], 1), np.stack([k, n + sides, k + sides], 1)])
    return vertices, faces, False


def _ball(
    center: F64, radii: F64, rng: np.random.Generator, rough: float, rings: int = 4, around: int = 7
) -> tuple[F64, np.ndarray, bool]:
    """A lumpy ellipsoid."""
    polar = np.linspace(0, np.pi, rings + 1)[1:-1]
    turn = np.arange(around) * 2 * np.pi / around
    grid = np.stack(
        [
            np.outer(np.sin(polar), np.cos(turn)),
            np.outer(np.sin(polar), np.sin(turn)),
            np.repeat(np.cos(polar)[:, None], around, 1),
        ],
        -1,
    )
    unit = np.concatenate([[[0, 0, 1.0]], grid.reshape(-1, 3), [[0, 0, -1.0]]])
    vertices = center + unit * radii * (1 + rough * rng.uniform(-1, 1, (len(unit), 1)))
    faces = [(0, 1 + k, 1 + (k + 1) % around) for k in range(around)]
    for r in range(len(polar) - 1):
        for k in range(around):
            a, b = 1 + r * around + k, 1 + r * around + (k + 1) % around
            faces += [(a, a + around, b), (b, a + around, b + around)]
    last = len(unit) - 1
    faces += [(last, last - around + (k + 1) % around, last - around + k) for k in range(around)]
    return vertices, np.array(faces), True


def _leaves(centers: F64, size: float, rng: np.random.Generator) -> tuple[F64, np.ndarray, bool]:
    """Crossed quads turned at random: a cluster of leaves at each centre."""
    count = len(centers)
    normal = rng.normal(size=(count, 2, 3))
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    side = np.cross(normal, rng.normal(size=(count, 2, 3)))
    side /= np.linalg.norm(side, axis=-1, keepdims=True)
    up = np.cross(normal, side)
    scale = size * rng.uniform(0.6, 1.2, (count, 2, 1))
    corners = np.stack([side + up, up - side, -side - up, side - up], axis=2) * scale[:, :, None, :] + centers[:, None, None, :]
    vertices = corners.reshape(-1, 3)
    start = np.arange(count * 2) * 4
    faces = np.concatenate([np.stack([start, start + 1, start + 2], 1), np.stack([start, start + 2, start + 3], 1)])
    return vertices, faces, True


def _colonised(rng: np.random.Generator, low: float, radius: float, height: float, steps: int) -> tuple[F64, np.ndarray]:
    """Branch points and their parents by space colonisation (Runions, Lane & Prusinkiewicz 2007) in an ellipsoidal crown."""
    goals = rng.normal(size=(160, 3))
    goals /= np.linalg.norm(goals, axis=1)[:, None]
    goals *= rng.uniform(0.25, 1, (160, 1)) ** (1 / 3)
    goals = goals * [radius, radius, (height - low) / 2] + [0, 0, (height + low) / 2]
    points = [np.array([0.0, 0.0, z]) for z in np.linspace(0, low + 0.1 * height, 5)]
    parent = [0, 0, 1, 2, 3]
    reach, step, kill = 0.5 * height, 0.07 * height, 0.1 * height
    for _ in range(steps):
        if not len(goals):
            break
        tree = np.array(points)
        away = np.linalg.norm(goals[:, None] - tree[None], axis=2)
        nearest = away.argmin(1)
        pulled = away.min(1) < reach
        grown = []
        for k in np.unique(nearest[pulled]):
            pull = goals[pulled & (nearest == k)] - tree[k]
            toward = (pull / np.linalg.norm(pull, axis=1)[:, None]).sum(0) + rng.normal(scale=0.05, size=3)
            grown.append((tree[k] + step * toward / max(float(np.linalg.norm(toward)), 1e-9), int(k)))
        if not grown:
            break
        points += [p for p, _ in grown]
        parent += [k for _, k in grown]
        goals = goals[np.linalg.norm(goals[:, None] - np.array(points)[None], axis=2).min(1) > kill]
    return np.array(points), np.array(parent)


def _broad(rng: np.random.Generator, near: bool) -> Form:
    if not near:
        trunk = _stem(np.zeros(3), np.array([0, 0, 0.4]), 0.025, 0.018, 4)
        return _join([trunk, _ball(np.array([0, 0, 0.66]), np.array([0.27, 0.27, 0.34]), rng, 0.15)])
    points, parent = _colonised(rng, 0.3, 0.3, 0.97, 14)
    children = np.bincount(parent[1:], minlength=len(points))
    weight = np.ones(len(points))
    for k in range(len(points) - 1, 0, -1):
        weight[parent[k]] += weight[k]
    thick = 0.019 * np.sqrt(weight / weight[0])
    parts = [
        _stem(points[parent[k]], points[k], thick[parent[k]], thick[k], 8 if weight[k] > 8 else 4) for k in range(1, len(points))
    ]
    tips = points[(children == 0) | (weight < 5)]
    chosen = tips[rng.choice(len(tips), min(LEAF_CLUSTERS * 2, len(tips) * 3))] + rng.normal(
        scale=0.03, size=(min(LEAF_CLUSTERS * 2, len(tips) * 3), 3)
    )
    return _join([*parts, _leaves(chosen, 0.05, rng)])


def _cone(rng: np.random.Generator, near: bool) -> Form:
    trunk = _stem(np.zeros(3), np.array([0, 0, 0.95]), 0.02, 0.004, 5 if near else 4)
    levels = 12 if near else 3
    parts = [trunk]
    for k in range(levels):
        low = 0.12 + 0.8 * k / levels
        wide = 0.2 * (1 - (low - 0.12) / 0.9) + 0.01
        tall = 0.8 / levels * 1.6
        around = 11 if near else 7
        turn = (np.arange(around) + rng.uniform()) * 2 * np.pi / around
        ragged = wide * (1 + 0.25 * rng.uniform(-1, 1, around))
        ring = np.stack([ragged * np.cos(turn), ragged * np.sin(turn), np.full(around, low)], 1)
        vertices = np.concatenate([ring, [[0, 0, min(low + tall, 1.0)]]])
        faces = np.array([(i, (i + 1) % around, around) for i in range(around)])
        parts.append((vertices, faces, True))
    return _join(parts)


def _palm(rng: np.random.Generator, near: bool) -> Form:
    lean = np.array([0.06, 0.0, 0.86])
    parts = [_stem(np.zeros(3), lean, 0.022, 0.016, 6 if near else 4)]
    fronds = 16 if near else 8
    for k in range(fronds):
        turn, rise = 2 * np.pi * (k + rng.uniform(-0.3, 0.3)) / fronds, rng.uniform(0.0, 0.14)
        out = np.array([np.cos(turn), np.sin(turn), 0.0])
        across = np.array([-out[1], out[0], 0.0]) * 0.035
        spine = [
            lean,
            lean + 0.14 * out + [0, 0, rise],
            lean + 0.26 * out + [0, 0, rise - 0.06],
            lean + 0.33 * out + [0, 0, rise - 0.18],
        ]
        widths = [0.4, 1.0, 0.8, 0.05]
        vertices = np.concatenate([[p - w * across, p + w * across] for p, w in zip(spine, widths, strict=True)])
        faces = np.array([t for j in range(3) for t in ((2 * j, 2 * j + 1, 2 * j + 3), (2 * j, 2 * j + 3, 2 * j + 2))])
        parts.append((vertices, faces, True))
    return _join(parts)


def _bush(rng: np.random.Generator, near: bool) -> Form:
    if not near:
        return _join([_ball(np.array([0, 0, 0.45]), np.array([0.55, 0.55, 0.5]), rng, 0.2)])
    centers = rng.normal(size=(LEAF_CLUSTERS, 3)) * [0.24, 0.24, 0.2] + [0, 0, 0.5]
    stems = [_stem(np.zeros(3), c, 0.02, 0.006, 3) for c in centers[:10]]
    return _join([*stems, _leaves(np.clip(centers, [-0.6, -0.6, 0.1], [0.6, 0.6, 1.0]), 0.12, rng)])


def _tuft(rng: np.random.Generator, near: bool) -> Form:
    blades = 14 if near else 5
    turn, lean = rng.uniform(0, 2 * np.pi, blades), rng.uniform(0.05, 0.35, blades)
    out = np.stack([np.cos(turn), np.sin(turn), np.zeros(blades)], 1)
    across = np.stack([-out[:, 1], out[:, 0], out[:, 2]], 1) * 0.02
    tip = out * lean[:, None] + np.array([0, 0, 1.0]) * rng.uniform(0.7, 1.0, blades)[:, None]
    vertices = np.stack([0.08 * out - across, 0.08 * out + across, tip], 1).reshape(-1, 3)
    return _join([(vertices, np.arange(3 * blades).reshape(-1, 3), True)])


def _column(rng: np.random.Generator, near: bool) -> Form:
    sides = 12 if near else 6
    body = _stem(np.zeros(3), np.array([0, 0, 0.97]), 0.06, 0.05, sides)
    top = _ball(np.array([0, 0, 0.95]), np.array([0.05, 0.05, 0.05]), rng, 0.0)
    return _join([(body[0], body[1], True), top])


def _rock(rng: np.random.Generator, near: bool) -> Form:
    rings, around = (7, 12) if near else (4, 7)
    vertices, faces, _ = _ball(np.array([0, 0, 0.3]), np.array([0.75, 0.6, 0.65]), rng, 0.18, rings, around)
    return _join([(vertices, faces, False)])
