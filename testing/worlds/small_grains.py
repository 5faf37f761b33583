"""Small worlds with particles, for tests, seeded defects and benchmarks: a ball that falls into a tray of sand, sparks over a floor."""

from __future__ import annotations

from typing import Any

__all__ = ["SAND_PROMPT", "SPARK_PROMPT", "sand_spec", "spark_spec"]

SAND_PROMPT = "A steel ball drops into a tray of sand."
SPARK_PROMPT = "Sparks spray from a grinder, bounce on the floor and go out."
INNER, WALL, HIGH = 0.24, 0.03, 0.12
"""Inside of the tray, its walls' thickness and height [m]."""


def _part(size: tuple[float, ...], at: tuple[float, ...]) -> dict[str, Any]:
    return {"shape": {"kind": "box", "size": list(size)}, "pose": {"position": list(at)}}


def tray(inner: float = INNER, wall: float = WALL, high: float = HIGH) -> dict[str, Any]:
    """A tray whose floor is at z = 0, as one static entity."""
    out = inner + 2 * wall
    parts = {
        "floor": _part((out, out, wall), (0, 0, -wall / 2)),
        "east": _part((wall, out, high), (inner / 2 + wall / 2, 0, high / 2)),
        "west": _part((wall, out, high), (-inner / 2 - wall / 2, 0, high / 2)),
        "north": _part((inner, wall, high), (0, inner / 2 + wall / 2, high / 2)),
        "south": _part((inner, wall, high), (0, -inner / 2 - wall / 2, high / 2)),
    }
    return {
        "role": "tray of wood",
        "motion": "static",
        "material": "wood",
        "dimensions": {"size": [out, out, high + wall]},
        "parts": parts,
    }


def sand_spec(
    *,
    radius: float = 0.008,
    depth: float = 0.07,
    frames: int = 24,
    ball_at: float | None = 0.2,
    coupled: bool = True,
    young: float = 6e7,
    preroll: float = 0.3,
    **changes: Any,
) -> dict[str, Any]:
    """A specification without its prompt; `changes` replace top-level members.

    Args:
        radius: of the grains [m].
        depth: of the volume that they fill before they settle [m].
        frames: at 24 per second.
        ball_at: height of the ball's centre at frame 0 [m]; None: no ball.
        coupled: whether sand and ball act on each other.
        young: modulus of the grains [Pa].
        preroll: in which the sand settles [s].
    """
    side = INNER - 0.002
    entities: dict[str, Any] = {
        "tray": tray(),
        "sand": {
            "role": "sand in the tray",
            "motion": "dynamic",
            "material": "sand",
            "dimensions": {"size": [side, side, depth]},
            "pose": {"position": [0, 0, depth / 2 + 0.001]},
            "physics": {"category": "particles", "radius": radius, "young_modulus": young, "rolling": 0.1},
            "parts": {"volume": {"shape": {"kind": "box", "size": [side, side, depth]}}},
        },
    }
    members = ["tray"]
    drivers: dict[str, Any] = {}
    if ball_at is not None:
        entities["ball"] = {
            "role": "steel ball that falls into the sand",
            "motion": "dynamic",
            "material": "steel",
            "dimensions": {"size": [0.05, 0.05, 0.05]},
            "pose": {"position": [0, 0, ball_at]},
            "parts": {"body": {"shape": {"kind": "sphere", "radius": 0.025}}},
        }
        members.append("ball")
        drivers["hold"] = {"kind": "release", "entity": "ball", "time": 0.0}
    both = {"source": "bodies", "target": "grains", "direction": "two_way", "variables": ["motion", "wrench"]}
    return {
        "title": "sand",
        "materials": {
            "wood": {"density": 600.0, "friction": 0.5, "substance": "wood", "appearance": {"color": [0.35, 0.2, 0.1]}},
            "steel": {"density": 7800.0, "friction": 0.4, "restitution": 0.3, "substance": "steel"},
            "sand": {
                "density": 2600.0,
                "friction": 0.5,
                "restitution": 0.2,
                "substance": "stone",
                "appearance": {"color": [0.62, 0.45, 0.24]},
            },
        },
        "entities": entities,
        "simulation": {
            "fps": 24,
            "frames": frames,
            "preroll": preroll,
            "solvers": {
                "bodies": {"engine": "mujoco", "members": members},
                "grains": {
                    "engine": "dem",
                    "members": ["sand"],
                    "settings": {"domain": {"center": [0, 0, 0.15], "size": [0.6, 0.6, 0.5]}},
                },
            },
            "drivers": drivers,
            "couplings": {"sand_and_ball": both} if coupled and ball_at is not None else {},
        },
        **changes,
    }


def spark_spec(
    *, rate: float = 400.0, frames: int = 24, wind: float = 3.0, on_hit: str = "bounce", **changes: Any
) -> dict[str, Any]:
    """Sparks from a nozzle over a floor, in a wind."""
    return {
        "title": "sparks",
        "materials": {
            "stone": {"density": 2400.0, "friction": 0.6, "restitution": 0.4, "substance": "stone"},
            "iron": {"density": 7800.0, "friction": 0.4, "restitution": 0.4, "substance": "steel", "appearance": {"color": [1.0, 0.45, 0.08]}},
        },
        "entities": {
            "floor": {
                "role": "floor of stone",
                "motion": "static",
                "material": "stone",
                "dimensions": {"size": [4.0, 4.0, 0.1]},
                "pose": {"position": [0, 0, -0.05]},
                "parts": {"slab": {"shape": {"kind": "box", "size": [4.0, 4.0, 0.1]}}},
            },
            "sparks": {
                "role": "sparks of a grinder",
                "motion": "dynamic",
                "material": "iron",
                "dimensions": {"size": [0.05, 0.05, 0.05]},
                "pose": {"position": [0, 0, 1.0]},
                "physics": {
                    "category": "particles", "law": "ballistic", "radius": 0.001, "radius_spread": 0.3, "on_hit": on_hit,
                    "life": 0.9, "life_spread": 0.3,
                },
                "parts": {"nozzle": {"shape": {"kind": "box", "size": [0.05, 0.05, 0.05]}}},
            },
        },
        "simulation": {
            "fps": 24,
            "frames": frames,
            "solvers": {
                "bodies": {"engine": "mujoco", "members": ["floor"]},
                "flight": {
                    "engine": "ballistic",
                    "members": ["sparks"],
                    "settings": {"domain": {"center": [0, 0, 1.5], "size": [4.0, 4.0, 4.0]}},
                },
            },
            "drivers": {
                "grinder": {
                    "kind": "emitter", "entity": "sparks", "rate": rate, "speed": 5.0, "speed_spread": 0.3, "cone": 0.3,
                    "pose": {"position": [0, 0, 1.0], "euler": [0, 1.2, 0]}, "end": 0.6,
                },
                "breeze": {"kind": "field", "field": {"kind": "wind", "velocity": [0, wind, 0]}},
            },
        },
        **changes,
    }  # fmt: skip
