"""Small worlds of soft matter of several kinds, for tests and seeded defects: what drops on a cloth between four posts."""

from __future__ import annotations

from typing import Any

from .small_cloth import COTTON
from .small_grains import tray

__all__ = ["HAMMOCK_PROMPT", "HIGH", "caught_spec", "hammock_spec"]

HAMMOCK_PROMPT = "A jelly drops on a cloth hung between four posts over a tray of sand."
HALF, HIGH, POST = 0.22, 0.3, 0.012
"""Half the side of the cloth, its height, and the posts' radius [m]."""
SIDE = 0.1
"""Side of the jelly [m]."""


def _entity(role: str, motion: str, material: str, parts: dict[str, Any], size: list[float], at: list[float]) -> dict[str, Any]:
    return {
        "role": role,
        "motion": motion,
        "material": material,
        "dimensions": {"size": size},
        "pose": {"position": at},
        "parts": parts,
    }


def _matter() -> dict[str, Any]:
    return {
        "jelly": {"density": 1050, "friction": 0.5, "appearance": {"color": [0.72, 0.05, 0.06], "roughness": 0.15}},
        "cotton": {"density": 250, "friction": 0.5, "appearance": {"color": [0.85, 0.83, 0.75], "roughness": 0.9}},
        "wood": {"density": 600, "substance": "wood", "friction": 0.5, "appearance": {"color": [0.45, 0.3, 0.16], "pattern": "wood"}},
        "stone": {"density": 2500, "substance": "stone", "friction": 0.5, "appearance": {"color": [0.42, 0.42, 0.44]}},
        "sand": {"density": 2600, "friction": 0.6, "restitution": 0.3, "appearance": {"color": [0.7, 0.55, 0.33], "roughness": 1.0}},
    }  # fmt: skip


def hammock_spec(
    *,
    frames: int = 20,
    edge: float = 0.03,
    drop: float = 0.1,
    radius: float | None = 0.008,
    coupled: bool = True,
    **changes: Any,
) -> dict[str, Any]:
    """A specification without its prompt; `changes` replace top-level members.

    Args:
        frames: at 24 per second.
        edge: of the cloth's squares [m].
        drop: height of the jelly over the cloth at frame 0 [m].
        radius: of the grains [m]; None: no sand.
        coupled: whether jelly and cloth act on each other.
    """
    corners = {"a": (-1, -1), "b": (1, -1), "c": (-1, 1), "d": (1, 1)}
    away = HALF + POST
    posts = {
        k: {"shape": {"kind": "cylinder", "radius": POST, "height": HIGH + 0.03}, "pose": {"position": [x * away, y * away, 0]}}
        for k, (x, y) in corners.items()
    }
    ground = {"slab": {"shape": {"kind": "box", "size": [1.6, 1.6, 0.1]}}}
    sheet = {"sheet": {"shape": {"kind": "sheet", "size": [2 * HALF, 2 * HALF], "resolution": edge}}}
    entities: dict[str, Any] = {
        "ground": _entity("stone floor", "static", "stone", ground, [1.6, 1.6, 0.1], [0, 0, -0.05]),
        "posts": _entity(
            "four posts", "static", "wood", posts, [2 * away + 2 * POST, 2 * away + 2 * POST, HIGH + 0.03], [0, 0, (HIGH + 0.03) / 2]
        ),
        "cloth": _entity("cloth between the posts", "dynamic", "cotton", sheet, [2 * HALF, 2 * HALF, COTTON["thickness"]], [0, 0, HIGH]),
        "jelly": _entity(
            "jelly that drops on the cloth", "dynamic", "jelly", {"body": {"shape": {"kind": "box", "size": [SIDE, SIDE, 0.06]}}},
            [SIDE, SIDE, 0.06], [0.01, 0, HIGH + drop + 0.03],
        ),
        "tray": {**tray(0.26, 0.02, 0.05), "pose": {"position": [0, 0, 0.02]}},
    }  # fmt: skip
    entities["cloth"]["physics"] = {
        "category": "cloth", **COTTON, "stretch_stiffness": 6000.0, "max_stretch": 0.3,
        "pins": {k: {"center": [x * HALF, y * HALF, 0], "radius": 0.03, "to": "posts"} for k, (x, y) in corners.items()},
    }  # fmt: skip
    entities["jelly"]["physics"] = {
        "category": "elastic", "young_modulus": 30000, "poisson_ratio": 0.4, "damping": 0.003, "resolution": 0.05,
    }  # fmt: skip
    solvers: dict[str, Any] = {
        "bodies": {
            "engine": "mujoco",
            "members": ["ground", "posts", "tray", "jelly"],
            "settings": {"step": 0.0005, "skin": 0.001},
        },
        "cloth": {"engine": "shell", "members": ["cloth"]},
    }
    if radius is not None:
        entities["sand"] = {
            **_entity("sand in the tray", "dynamic", "sand", {"bed": {"shape": {"kind": "box", "size": [0.25, 0.25, 0.04]}}}, [0.25, 0.25, 0.04], [0, 0, 0.042]),
            "physics": {"category": "particles", "radius": radius, "young_modulus": 1e7, "rolling": 0.1},
        }  # fmt: skip
        domain = {"center": [0, 0, 0.25], "size": [0.5, 0.5, 0.7]}
        solvers["grains"] = {"engine": "dem", "members": ["sand"], "settings": {"domain": domain}}
    both = {"source": "cloth", "target": "bodies", "direction": "two_way", "variables": ["motion", "wrench"]}
    return {
        "title": "Jelly on a cloth",
        "spec_version": "2",
        "claims": {
            "drops": {"quote": "drops", "type": "event", "by": ["/story/beats/drops"]},
            "four": {"quote": "between four", "type": "place", "by": ["/entities/posts"]},
            **{n: {"quote": n, "type": "thing", "by": [f"/entities/{n}"]} for n in ("jelly", "cloth", "posts", "tray", "sand") if n in entities},
        },
        "materials": _matter(),
        "entities": entities,
        "graph": {},
        "story": {
            "beats": {
                "drops": {
                    "text": "the jelly drops on the cloth", "owner": "let_go", "subject": "jelly", "frames": [0, frames - 1],
                    "predicate": {"kind": "crosses", "entity": "jelly", "point": [0, 0, round(HIGH + drop - 0.05, 6)], "normal": [0, 0, -1]},
                }
            }
        },
        "shots": {
            "main": {
                "frames": [0, frames - 1], "covers": ["drops"],
                "keys": {"k0": {"frame": 0, "position": [0.8, -0.85, 0.6], "target": [0, 0, 0.2], "fov_deg": 40}},
            }
        },
        "simulation": {
            "fps": 24,
            "frames": frames,
            "preroll": 0.1 if radius is not None else 0.0,
            "solvers": solvers,
            "drivers": {"let_go": {"kind": "release", "entity": "jelly", "time": 0.0}},
            "couplings": {"both": both} if coupled else {},
        },
        "look": {"width": 480, "height": 360, "samples": 16},
        **changes,
    }  # fmt: skip


def caught_spec(
    *,
    frames: int = 13,
    spacing: float = 0.02,
    size: tuple[float, float, float] = (0.2, 0.2, 0.06),
    above: float = 0.004,
    speed: float = 0.0,
    stiffness: float = 3000.0,
    direction: str = "two_way",
) -> dict[str, Any]:
    """Water in place of the jelly and no sand, without its prompt.

    Args:
        frames: at 24 per second.
        spacing: of the particles [m].
        size: of the water [m].
        above: height of its lowest face over the cloth at frame 0 [m].
        speed: with which it falls at frame 0 [m/s].
        stiffness: of the cloth [N/m].
        direction: of the coupling of cloth and water.
    """
    spec = hammock_spec(frames=frames, edge=0.055, radius=None)
    for gone in ("jelly", "tray"):
        del spec["entities"][gone]
    plan = spec["simulation"]
    plan["drivers"] = {}
    plan["solvers"]["bodies"]["members"] = ["ground", "posts"]
    plan["solvers"]["water"] = {"engine": "dfsph", "members": ["water"], "settings": {
        "domain": {"center": [0, 0, 0.3], "size": [0.6, 0.6, 0.8], "sides": ["open"] * 6},
    }}  # fmt: skip
    passed = ["motion", "wrench"] if direction == "two_way" else ["motion"]
    plan["couplings"]["wet"] = {"source": "cloth", "target": "water", "direction": direction, "variables": passed}
    look = {"color": [0.75, 0.88, 0.95], "transmission": 1.0, "roughness": 0.02}
    spec["materials"] = {k: spec["materials"][k] for k in ("cotton", "wood", "stone")}
    spec["materials"]["water"] = {"density": 1000, "substance": "water", "appearance": look}
    moving = {"linear_velocity": [0.0, 0.0, -speed]} if speed else {}
    spec["entities"]["water"] = {
        **_entity("water", "dynamic", "water", {"body": {"shape": {"kind": "box", "size": list(size)}}}, list(size),
                  [0.0, 0.0, round(HIGH + above + size[2] / 2, 6)]),
        "physics": {"category": "liquid", "resolution": spacing, **moving}, "outputs": ["motion"],
    }  # fmt: skip
    cloth = spec["entities"]["cloth"]["physics"]
    cloth["damping"], cloth["stretch_stiffness"] = 1e-4, stiffness
    for pin in cloth["pins"].values():
        pin["radius"] = 0.09
    drops = {"kind": "liquid_speed", "entity": "water", "min": 0.3}
    beat = {
        "text": "the water drops",
        "owner": "water",
        "subject": "water",
        "frames": [0, min(6, frames - 1)],
        "predicate": drops,
    }
    spec["story"] = {"beats": {"drops": {**beat, "causes": []}}}
    spec["claims"] = {n: spec["claims"][n] for n in ("cloth", "four", "posts")}
    return spec
