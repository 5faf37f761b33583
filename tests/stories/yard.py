"""A yard with a stone, a table, and a cart whose wheels turn on hinges: what is put in places together, in turn and many at once."""

from __future__ import annotations

from typing import Any

import numpy as np

__all__ = ["CART", "MARKED", "PROMPT", "yard_spec"]

PROMPT = "A cart rolls through a yard with a table and stones."
MARKED = "A [cart](thing body wheel_fr) [rolls](event roll) through a [yard](place ground) with a [table](thing table) and [stones](thing stone)."
"""The prompt with its claims."""
WHEELS = ("wheel_fl", "wheel_fr", "wheel_bl", "wheel_br")
CART = ("body", *WHEELS)
"""Entities of the cart."""
RADIUS, WIDTH = 0.25, 0.08
SKIN = 0.0005
SPEED = 1.0
"""[m/s]"""


def yard_spec() -> dict[str, Any]:
    """The specification without its prompt: a level floor of 12 x 12 m at z = 0."""
    entities = {
        "ground": _entity("ground", "static", "earth", (12, 12, 0.5), (0, 0, -0.25)),
        "table": _entity("table", "static", "oak", (1.2, 0.8, 0.75), (3, 3, 0.375 + 1e-4)),
        "stone": _entity("stone", "static", "granite", (0.4, 0.3, 0.2), (-4, -4, 0.2)),
        "body": _entity("cart", "dynamic", "oak", (1.6, 0.8, 0.3), (0, 0, RADIUS + 0.2)),
    }
    entities["stone"]["parts"]["body"]["shape"] = _stone((0.4, 0.3, 0.2))
    joints = {}
    for wheel in WHEELS:
        x, y = (0.5 if wheel[6] == "f" else -0.5), (0.5 if wheel[7] == "l" else -0.5)
        at = (x, y, RADIUS + 2 * SKIN)
        entities[wheel] = _entity("wheel", "dynamic", "oak", (2 * RADIUS, WIDTH, 2 * RADIUS), at)
        entities[wheel]["parts"]["body"] = {
            "shape": {"kind": "cylinder", "radius": RADIUS, "height": WIDTH},
            "pose": {"euler": [np.pi / 2, 0, 0]},
        }
        joints[f"axle_{wheel[6:]}"] = {
            "kind": "hinge",
            "parent": "body",
            "child": wheel,
            "anchor": [x, 0.919 * y, at[2]],
            "axis": [0, 1, 0],
        }
    for k, x in (("front", 0.5), ("back", -0.5)):
        axle = {"shape": {"kind": "box", "size": [0.05, 0.918, 0.05]}, "pose": {"position": [x, 0, -0.15]}}
        entities["body"]["parts"][k] = axle
    entities["body"]["dimensions"]["size"] = [1.6, 0.918, 0.325]
    entities["body"]["pose"]["position"][2] = RADIUS + 0.15 + 2 * SKIN
    return {
        "title": "yard",
        "materials": {
            "earth": {"density": 1800, "friction": 0.8, "substance": "soil"},
            "oak": {"density": 700, "friction": 0.5, "substance": "wood"},
            "granite": {"density": 2600, "friction": 0.6, "substance": "stone"},
        },
        "entities": entities,
        "graph": {"relations": {"carries": {"kind": "supports", "a": "ground", "b": "stone"}}},
        "simulation": {
            "fps": 24,
            "frames": 40,
            "solvers": {"rigid": {"engine": "mujoco", "members": list(entities), "settings": {"skin": SKIN}}},
            "joints": joints,
            "drivers": {
                f"drive_{side}": {
                    "kind": "motor",
                    "joint": f"axle_{side}",
                    "velocity": SPEED / RADIUS,
                    "max_effort": 60,
                    "end": 10,
                }
                for side in ("bl", "br")
            },
        },
        "story": {
            "beats": {
                "roll": {
                    "text": "the cart rolls",
                    "subject": "wheel_fr",
                    "owner": "drive_br",
                    "frames": [0, 39],
                    "predicate": {"kind": "rolls", "entity": "wheel_fr"},
                }
            }
        },
        "shots": {
            "all": {
                "frames": [0, 39],
                "keys": {"a": {"frame": 0, "position": [5, -5, 3], "target": [0, 0, 0.3], "fov_deg": 45}},
                "subjects": ["body"],
                "covers": ["roll"],
            }
        },
    }


def _entity(role: str, motion: str, material: str, size: tuple[float, ...], position: tuple[float, ...]) -> dict[str, Any]:
    return {
        "role": role,
        "motion": motion,
        "material": material,
        "dimensions": {"size": list(size)},
        "pose": {"position": list(position)},
        "parts": {"body": {"shape": {"kind": "box", "size": list(size)}}},
    }


def _stone(size: tuple[float, float, float]) -> dict[str, Any]:
    """A convex stone that just fills a box."""
    from scipy.spatial import ConvexHull

    points = np.random.default_rng(1).normal(size=(40, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    hull = ConvexHull(points)
    points = points - 0.5 * (points.min(0) + points.max(0))
    points *= np.array(size) / np.ptp(points, axis=0)
    faces = []
    for a, b, c in hull.simplices:
        outward = np.cross(points[b] - points[a], points[c] - points[a]) @ points[a] > 0
        faces.append([int(a), int(b), int(c)] if outward else [int(a), int(c), int(b)])
    return {"kind": "mesh", "vertices": points.round(6).tolist(), "faces": faces, "collision": "hull"}
