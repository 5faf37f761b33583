"""A small world with balloons: three of them rise from a floor."""

from __future__ import annotations

from typing import Any

__all__ = ["BALLOON_PROMPT", "balloon_spec"]

BALLOON_PROMPT = "Three balloons rise from the floor."
RADIUS = 0.15


def balloon_spec(*, frames: int = 24, **changes: Any) -> dict[str, Any]:
    """A specification without its prompt; `changes` replace top-level members."""
    parts = {
        name: {"shape": {"kind": "sphere", "radius": RADIUS}, "pose": {"position": [x, 0, 0]}}
        for name, x in (("left", -0.5), ("middle", 0.0), ("right", 0.5))
    }
    size = [1.0 + 2 * RADIUS, 2 * RADIUS, 2 * RADIUS]
    return {
        "title": "balloons",
        "materials": {
            "stone": {"density": 2400.0, "substance": "stone"},
            "balloon": {"density": 0.6, "appearance": {"color": [0.8, 0.1, 0.1]}},
        },
        "entities": {
            "floor": {
                "role": "floor",
                "motion": "static",
                "material": "stone",
                "dimensions": {"size": [4.0, 4.0, 0.1]},
                "pose": {"position": [0, 0, -0.05]},
                "parts": {"slab": {"shape": {"kind": "box", "size": [4.0, 4.0, 0.1]}}},
            },
            "balloons": {
                "role": "three balloons",
                "motion": "dynamic",
                "material": "balloon",
                "dimensions": {"size": size},
                "pose": {"position": [0, 0, 0.2]},
                "physics": {"category": "balloons", "air_drag": 0.05},
                "parts": parts,
            },
        },
        "simulation": {
            "fps": 24,
            "frames": frames,
            "solvers": {
                "bodies": {"engine": "mujoco", "members": ["floor"]},
                "air": {"engine": "aerostat", "members": ["balloons"]},
            },
        },
        **changes,
    }
