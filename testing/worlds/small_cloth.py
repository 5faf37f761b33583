"""Small worlds with cloth, for tests and seeded defects: a flag in the wind, a cloth that falls over a ball, a ball caught by a sheet."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...worlds.categories.cloth.facts import sheet_grid
from ...worlds.spec import Sheet

__all__ = ["CATCH_PROMPT", "DRAPE_PROMPT", "FLAG_PROMPT", "PULLED_PROMPT", "catch_spec", "drape_spec", "flag_spec", "pulled_spec"]

FLAG_PROMPT = "A flag flies in the wind."
DRAPE_PROMPT = "A cloth falls over a ball and drapes it."
PULLED_PROMPT = "A strip of cloth between two rods is pulled until it tears."
CATCH_PROMPT = "A ball falls into a cloth held at its corners."
COTTON = {"area_density": 0.15, "thickness": 0.0006, "stretch_stiffness": 1000.0, "bend_stiffness": 2e-5}
MATERIALS: dict[str, Any] = {
    "stone": {"density": 2500, "substance": "stone", "friction": 0.5, "appearance": {"color": [0.45, 0.43, 0.4]}},
    "steel": {
        "density": 7850,
        "substance": "steel",
        "appearance": {"color": [0.5, 0.5, 0.52], "metallic": 0.8, "roughness": 0.3},
    },
    "rubber": {"density": 1100, "substance": "rubber", "appearance": {"color": [0.1, 0.2, 0.5]}},
    "foam": {"density": 120, "substance": "foam", "appearance": {"color": [0.1, 0.3, 0.55]}},
    "cotton": {"density": 250, "friction": 0.4, "appearance": {"color": [0.65, 0.06, 0.05], "roughness": 0.9}},
}


def _entity(role: str, motion: str, material: str, shape: dict[str, Any], size: list[float], at: list[float]) -> dict[str, Any]:
    return {
        "role": role,
        "motion": motion,
        "material": material,
        "dimensions": {"size": size},
        "pose": {"position": at},
        "parts": {"body": {"shape": shape}},
    }


def _ground(size: float) -> dict[str, Any]:
    full = [size, size, 0.2]
    return _entity("ground", "static", "stone", {"kind": "box", "size": full}, full, [0.0, 0.0, -0.1])


def _solvers(rigid: list[str], cloth: list[str]) -> dict[str, Any]:
    return {"rigid": {"engine": "mujoco", "members": rigid}, "cloth": {"engine": "shell", "members": cloth}}


def _beat(text: str, owner: str, subject: str, predicate: dict[str, Any]) -> dict[str, Any]:
    return {"text": text, "owner": owner, "subject": subject, "predicate": predicate}


def _claims(event: str, **things: str) -> dict[str, Any]:
    """The words of the event and of the things of a prompt: entity by word."""
    told = {"event": {"quote": event, "type": "event", "by": ["/story/beats/event"]}}
    return told | {n: {"quote": n, "type": "thing", "by": [f"/entities/{e}"]} for n, e in things.items()}


def _world(
    title: str,
    entities: dict[str, Any],
    simulation: dict[str, Any],
    beat: dict[str, Any],
    claims: dict[str, Any],
    shot: dict[str, Any],
    changes: dict[str, Any],
) -> dict[str, Any]:
    frames = simulation["frames"]
    relations = {"no_lift": {"kind": "supports", "a": "ground", "b": "pole"}} if "pole" in entities else {}
    return {
        "title": title,
        "spec_version": "2",
        "claims": claims,
        "materials": MATERIALS,
        "entities": entities,
        "graph": {"relations": relations},
        "story": {"beats": {"event": {"frames": [0, frames - 1], **beat}}},
        "shots": {"main": {"frames": [0, frames - 1], "covers": ["event"], "keys": {"k0": {"frame": 0, **shot}}}},
        "simulation": {"fps": 24, **simulation},
        "look": {"width": 480, "height": 360, "samples": 16},
        **changes,
    }


def flag_spec(*, frames: int = 48, resolution: float = 0.05, **changes: Any) -> dict[str, Any]:
    """A flag at a pole, in a wind with gusts; `changes` replace top-level members."""
    size = [1.2, 0.8]
    flag = _entity(
        "flag",
        "dynamic",
        "cotton",
        {"kind": "sheet", "size": size, "resolution": resolution},
        [*size, COTTON["thickness"]],
        [0.65, 0.0, 2.1],
    )
    flag["pose"]["euler"] = [math.pi / 2, 0.0, 0.0]
    flag["physics"] = {"category": "cloth", **COTTON, "max_stretch": 0.12, "pins": {"hoist": {"edge": "-x"}}}
    pole = _entity(
        "pole", "static", "steel", {"kind": "cylinder", "radius": 0.03, "height": 2.6}, [0.06, 0.06, 2.6], [0.0, 0.0, 1.3]
    )
    wind = {"kind": "field", "field": {"kind": "wind", "velocity": [7.0, 1.5, 0.0], "gust": 0.3, "gust_period": 1.0}}
    return _world(
        "Flag",
        {"ground": _ground(6.0), "pole": pole, "flag": flag},
        {
            "frames": frames,
            "solvers": _solvers(["ground", "pole"], ["flag"]),
            "drivers": {"breeze": wind},
        },
        _beat("the flag flies", "breeze", "flag", {"kind": "rises", "entity": "flag"}),
        _claims("flies", flag="flag") | {"wind": {"quote": "wind", "type": "weather", "by": ["/simulation/drivers/breeze"]}},
        {"position": [0.7, -3.2, 2.0], "target": [0.6, 0.0, 1.8], "fov_deg": 45},
        changes,
    )


def drape_spec(*, frames: int = 36, resolution: float = 0.035, **changes: Any) -> dict[str, Any]:
    """A square cloth over a ball that lies on the ground."""
    size = [1.0, 1.0]
    cloth = _entity(
        "cloth",
        "dynamic",
        "cotton",
        {"kind": "sheet", "size": size, "resolution": resolution},
        [*size, COTTON["thickness"]],
        [0.0, 0.02, 0.53],
    )
    cloth["physics"] = {"category": "cloth", **COTTON}
    ball = _entity("ball", "static", "rubber", {"kind": "sphere", "radius": 0.25}, [0.5, 0.5, 0.5], [0.0, 0.0, 0.25])
    return _world(
        "Drape",
        {"ground": _ground(3.0), "ball": ball, "cloth": cloth},
        {
            "frames": frames,
            "solvers": _solvers(["ground", "ball"], ["cloth"]),
            "drivers": {
                "air": {"kind": "field", "field": {"kind": "drag"}},
                "let_go": {"kind": "release", "entity": "cloth", "time": 0.0},
            },
        },
        _beat("the cloth drapes the ball", "let_go", "cloth", {"kind": "falls", "entity": "cloth"}),
        _claims("falls", cloth="cloth", ball="ball"),
        {"position": [1.3, -1.6, 1.1], "target": [0.0, 0.0, 0.25], "fov_deg": 40},
        changes,
    )


def catch_spec(*, frames: int = 24, resolution: float = 0.05, coupled: bool = True, **changes: Any) -> dict[str, Any]:
    """A ball that falls into a sheet held at its corners; both push each other."""
    size, height = [1.0, 1.0], 0.8
    cloth = _entity(
        "cloth",
        "dynamic",
        "cotton",
        {"kind": "sheet", "size": size, "resolution": resolution},
        [*size, COTTON["thickness"]],
        [0.0, 0.0, height],
    )
    corners = {
        f"c{k}": {"center": [x, y, 0.0], "radius": 0.12}
        for k, (x, y) in enumerate([(-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5)])
    }
    cloth["physics"] = {"category": "cloth", **COTTON, "stretch_stiffness": 4000.0, "max_stretch": 0.12, "pins": corners}
    ball = _entity("ball", "dynamic", "foam", {"kind": "sphere", "radius": 0.08}, [0.16, 0.16, 0.16], [0.0, 0.0, height + 0.2])
    both = {"source": "cloth", "target": "rigid", "direction": "two_way", "variables": ["motion", "wrench"]}
    return _world(
        "Catch",
        {"ground": _ground(3.0), "ball": ball, "cloth": cloth},
        {
            "frames": frames,
            "solvers": _solvers(["ground", "ball"], ["cloth"]),
            "drivers": {
                "air": {"kind": "field", "field": {"kind": "drag"}},
                "let_go": {"kind": "release", "entity": "ball", "time": 0.0},
            },
            "couplings": {"both": both} if coupled else {},
        },
        _beat("the ball falls into the cloth", "let_go", "ball", {"kind": "falls", "entity": "ball", "min": 0.1}),
        _claims("falls", ball="ball", cloth="cloth"),
        {"position": [1.3, -1.6, 1.3], "target": [0.0, 0.0, 0.7], "fov_deg": 40},
        changes,
    )


def pulled_spec(
    *,
    stretch: float = 0.12,
    strength: float | None = 100.0,
    frames: int = 12,
    resolution: float = 0.05,
    notch: bool = False,
    **changes: Any,
) -> dict[str, Any]:
    """A strip in the air between a rod that stands and one that is drawn away by `stretch` of its length, without weight."""
    size, made_of = [0.5, 0.25], {**COTTON, "bend_stiffness": 1e-6}
    shape: dict[str, Any] = {"kind": "sheet", "size": size, "resolution": resolution}
    if notch:
        points, faces = sheet_grid(Sheet(size=(size[0], size[1]), resolution=resolution))
        middle = points[faces].mean(axis=1)
        kept = faces[(np.abs(middle[:, 0]) > resolution) | (middle[:, 1] < 0.5 * size[1] - resolution)]
        used, own = np.unique(kept, return_inverse=True)
        shape = {"kind": "mesh", "vertices": points[used].tolist(), "faces": own.reshape(-1, 3).tolist()}
    strip = _entity("strip", "dynamic", "cotton", shape, [*size, COTTON["thickness"]], [0.0, 0.0, 1.0])
    strip["physics"] = {
        "category": "cloth",
        **made_of,
        "max_stretch": 0.5,
        "damping": 1e-4,
        "pins": {"still": {"edge": "-x", "to": "post"}, "drawn": {"edge": "+x", "to": "rod"}},
    }
    if strength is not None:
        strip["physics"]["tear"] = {"strength": strength}
    bar = [0.02, 0.3, 0.02]
    rod = {"kind": "box", "size": bar}
    post = _entity("post", "static", "steel", rod, bar, [-0.26, 0.0, 1.0])
    drawn = _entity("rod", "kinematic", "steel", rod, bar, [0.26, 0.0, 1.0])
    seconds = (frames - 1) / 24
    keys = {
        "k0": {"time": 0.0, "pose": {"position": [0.26, 0.0, 1.0]}},
        "k1": {"time": 0.8 * seconds, "pose": {"position": [0.26 + stretch * size[0], 0.0, 1.0]}},
    }
    return _world(
        "Strip",
        {"post": post, "rod": drawn, "strip": strip},
        {
            "frames": frames,
            "gravity": [0.0, 0.0, 0.0],
            "solvers": _solvers(["post", "rod"], ["strip"]),
            "drivers": {"pull": {"kind": "path", "entity": "rod", "keys": keys}},
        },
        _beat("the strip tears", "cloth", "strip", {"kind": "tears", "entity": "strip"}),
        _claims("pulled until it tears", strip="strip")
        | {"rods": {"quote": "two rods", "type": "count", "by": ["/entities/post", "/entities/rod"]}},
        {"position": [0.0, -1.0, 1.5], "target": [0.0, 0.0, 1.0], "fov_deg": 45},
        changes,
    )
