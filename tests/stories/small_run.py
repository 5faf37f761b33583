"""A small world that is accepted in seconds: a ball rolls into three blocks on a shelf, and the last one falls off."""

from __future__ import annotations

import copy
from functools import cache
from typing import Any

from worldagent.worlds.claim_marks import claims_from
from worldagent.worlds.patch import parse_spec

__all__ = ["MARKED", "PROMPT", "small_spec"]

PROMPT = "A steel ball rolls into a row of three blocks. The last block falls off the shelf."
MARKED = (
    "A [steel](property ball) [ball](thing ball) [rolls](event roll) into a row of [three](count b1 b2 b3) [blocks](thing b1 b2 b3). "
    "The last [block](thing b3 same_as=blocks) [falls off](event fall) the [shelf](thing shelf)."
)
"""The prompt with its claims."""
TOP = 0.3
"""Height of the shelf's top [m]."""
SKIN = 0.0005
GAP = 2 * SKIN
BALL = 0.02
BLOCK = (0.03, 0.05, 0.05)
SPEED = 1.0
FRAMES = 36
EDGE = 0.22
"""Where the shelf ends [m]."""


def _entity(
    role: str, motion: str, material: str, size: tuple[float, ...], position: tuple[float, ...], **more: Any
) -> dict[str, Any]:
    shape = more.pop("shape", {"kind": "box", "size": list(size)})
    return {
        "role": role,
        "motion": motion,
        "material": material,
        "dimensions": {"size": list(size)},
        "pose": {"position": [round(p, 6) for p in position]},
        "parts": {"body": {"shape": shape}},
        **more,
    }


def small_spec(**changes: Any) -> dict[str, Any]:
    """The specification without its prompt, with the claims of `MARKED`; `changes` replace top-level members."""
    return copy.deepcopy({**_claimed(), **changes})


@cache
def _claimed() -> dict[str, Any]:
    spec = _unclaimed()
    return {**spec, "claims": claims_from(MARKED, parse_spec({**spec, "prompt": PROMPT}))}


def _unclaimed() -> dict[str, Any]:
    blocks = ("b1", "b2", "b3")
    return {
        "spec_version": "2",
        "title": "Three blocks",
        "story": {
            "beats": {
                "roll": {"text": "the ball rolls", "owner": "rigid", "subject": "ball", "frames": [0, 6],
                         "predicate": {"kind": "rolls", "entity": "ball"}},
                "strike": {"text": "it strikes the first block", "owner": "rigid", "subject": "b1", "frames": [1, 10], "causes": ["roll"],
                           "predicate": {"kind": "contact", "a": "ball", "b": "b1", "min_impulse": 0.05}},
                "fall": {"text": "the last block falls off the shelf", "owner": "rigid", "subject": "b3", "frames": [4, 24],
                         "causes": ["strike"],
                         "predicate": {"kind": "falls", "entity": "b3", "min": 0.15}},
            }
        },
        "materials": {
            "steel": {"density": 7850, "substance": "steel", "friction": 0.3, "rolling_friction": 0.0005, "restitution": 0.1,
                      "appearance": {"color": [0.7, 0.7, 0.75], "metallic": 1, "roughness": 0.3}},
            "wood": {"density": 600, "substance": "wood", "friction": 0.3, "appearance": {"color": [0.7, 0.25, 0.12]}},
            "stone": {"density": 2600, "substance": "stone", "friction": 0.5, "appearance": {"color": [0.45, 0.45, 0.43]}},
        },
        "entities": {
            "floor": _entity("floor", "static", "stone", (3.0, 2.0, 0.1), (0, 0, -0.05)),
            "shelf": _entity("shelf", "static", "stone", (0.8, 0.3, TOP), (EDGE - 0.4, 0, TOP / 2)),
            "ball": _entity("steel ball", "dynamic", "steel", (2 * BALL,) * 3, (-0.2, 0, TOP + GAP + BALL),
                            shape={"kind": "sphere", "radius": BALL},
                            physics={"category": "rigid", "linear_velocity": [SPEED, 0, 0], "angular_velocity": [0, SPEED / BALL, 0]}),
            **{
                name: _entity(f"block {k + 1}", "dynamic", "wood", BLOCK, (EDGE - 0.0155 - 0.034 * (2 - k), 0, TOP + GAP + BLOCK[2] / 2))
                for k, name in enumerate(blocks)
            },
        },
        "graph": {
            "relations": {
                "shelf_on_floor": {"kind": "supports", "a": "floor", "b": "shelf"},
                "ball_on_shelf": {"kind": "supports", "a": "shelf", "b": "ball", "frames": [0, 0]},
                **{f"on_shelf_{n}": {"kind": "supports", "a": "shelf", "b": n, "frames": [0, 0]} for n in blocks},
                "hits": {"kind": "interacts", "a": "ball", "b": "b1"},
            }
        },
        "shots": {
            "only": {"frames": [0, FRAMES - 1], "covers": ["roll", "strike", "fall"], "intent": "all of it from the side",
                     "keys": {"a": {"frame": 0, "position": [0.25, -1.3, 0.55], "target": [0.15, 0, 0.2], "fov_deg": 40}}}
        },
        "simulation": {
            "fps": 24,
            "frames": FRAMES,
            "solvers": {"rigid": {"engine": "mujoco", "members": ["floor", "shelf", "ball", *blocks],
                                  "settings": {"step": 0.0005, "skin": SKIN}}},
        },
        "look": {"sky": "studio", "width": 64, "height": 64, "samples": 2},
    }  # fmt: skip
