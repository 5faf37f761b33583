"""Small worlds with a liquid, for tests and seeded defects: a tank of water and a crate that floats in it, waves in a flume."""

from __future__ import annotations

from typing import Any

__all__ = ["PROMPT", "jelly_tank_spec", "sea_spec", "springboard_spec", "tank_spec"]

PROMPT = "A wooden crate drops in a tank of water."
INNER = (0.4, 0.4, 0.3)
"""Inside of the tank, its floor at z = 0 [m]."""
WALL = 0.03
CRATE = 0.12
LINER = 0.08
"""[m]"""


def _box(size: tuple[float, ...], at: tuple[float, ...]) -> dict[str, Any]:
    return {"shape": {"kind": "box", "size": [round(v, 6) for v in size]}, "pose": {"position": [round(v, 6) for v in at]}}


def _entity(role: str, motion: str, material: str, size: tuple[float, ...], at: tuple[float, ...], **more: Any) -> dict[str, Any]:
    return {
        "role": role,
        "motion": motion,
        "material": material,
        "dimensions": {"size": [round(v, 6) for v in size]},
        "pose": {"position": [round(v, 6) for v in at]},
        "parts": more.pop("parts", {"body": {"shape": {"kind": "box", "size": [round(v, 6) for v in size]}}}),
        **more,
    }


def tank_spec(
    *,
    spacing: float = 0.025,
    depth: float = 0.2,
    frames: int = 24,
    density: float = 500.0,
    crate_at: float | None = 0.26,
    engine: str = "dfsph",
    coupled: bool = True,
    closed: bool = False,
    **changes: Any,
) -> dict[str, Any]:
    """A specification without its prompt; `changes` replace top-level members.

    Args:
        spacing: of the particles [m].
        depth: of the water [m].
        frames: at 24 per second.
        density: of the crate [kg/m^3].
        crate_at: height of the crate's centre at frame 0 [m]; None: no crate.
        engine: of the liquid.
        coupled: whether water and crate act on each other.
        closed: whether the domain's own walls, `LINER` inside the tank's, hold the water.
    """
    x, y, z = INNER
    outer = (x + 2 * WALL, y + 2 * WALL, z + WALL)
    walls = {
        "bottom": _box((outer[0], outer[1], WALL), (0, 0, -WALL / 2)),
        "left": _box((WALL, outer[1], z), (-(x + WALL) / 2, 0, z / 2)),
        "right": _box((WALL, outer[1], z), ((x + WALL) / 2, 0, z / 2)),
        "front": _box((x, WALL, z), (0, -(y + WALL) / 2, z / 2)),
        "back": _box((x, WALL, z), (0, (y + WALL) / 2, z / 2)),
    }
    crate = crate_at is not None
    domain: dict[str, Any] = {"center": [0, 0, 0.2], "size": [0.6, 0.6, 0.6]}
    base = LINER if closed else 0.0
    wide = (x - 2 * base, y - 2 * base)
    if closed:
        domain = {"center": [0, 0, base + 0.25], "size": [*wide, 0.5], "sides": ["closed"] * 5 + ["open"]}
    spec: dict[str, Any] = {
        "title": "A tank of water",
        "spec_version": "2",
        "claims": {
            **({"drops": {"quote": "drops", "type": "event", "by": ["/story/beats/drop"]}} if crate else {}),
            **{n: {"quote": n, "type": "thing", "by": [f"/entities/{n}"]} for n in (*(["crate"] if crate else []), "tank", "water")},
        },
        "story": {
            "beats": {
                "drop": {"text": "the crate drops into the water", "owner": "rigid", "subject": "crate", "frames": [0, 12],
                         "predicate": {"kind": "crosses", "entity": "crate", "point": [0, 0, round((crate_at or 0) - 0.03, 6)], "normal": [0, 0, -1]}},
            }
            if crate
            else {}
        },
        "materials": {
            "water": {"density": 1000, "substance": "water", "appearance": {"color": [0.8, 0.9, 0.95], "transmission": 1}},
            "wood": {"density": density, "substance": "wood", "friction": 0.3},
            "stone": {"density": 2600, "substance": "stone", "friction": 0.5},
        },
        "entities": {
            "tank": _entity("tank", "static", "stone", outer, (0, 0, 0), parts=walls),
            "water": _entity("water in the tank", "dynamic", "water", (*wide, depth), (0, 0, base + depth / 2),
                             physics={"category": "liquid", "resolution": spacing}),
            **({"crate": _entity("wooden crate", "dynamic", "wood", (CRATE,) * 3, (0, 0, crate_at or 0.0))} if crate else {}),
        },
        "graph": {"relations": {}},
        "shots": {
            "wide": {"frames": [0, frames - 1], "covers": ["drop"] if crate else [], "subjects": ["water"],
                     "keys": {"k": {"frame": 0, "position": [1.0, -1.2, 0.9], "target": [0, 0, 0.1]}}},
        },
        "simulation": {
            "fps": 24,
            "frames": frames,
            "solvers": {
                "rigid": {"engine": "mujoco", "members": ["tank", *(["crate"] if crate else [])]},
                "water": {"engine": engine, "members": ["water"], "settings": {"domain": domain}},
            },
            "couplings": {
                "float": {"source": "water", "target": "rigid", "direction": "two_way", "variables": ["motion", "wrench"]},
            }
            if coupled
            else {},
        },
    }  # fmt: skip
    return {**spec, **changes}


def jelly_tank_spec(*, frames: int = 24, young: float = 15000.0, density: float = 600.0, **tank: Any) -> dict[str, Any]:
    """The tank with a jelly in place of the crate, without its prompt.

    Args:
        frames: at 24 per second.
        young: modulus of the jelly [Pa].
        density: of the jelly [kg/m^3].
        tank: arguments of `tank_spec`.
    """
    spec = tank_spec(frames=frames, **tank)
    low, high = 0.12, 0.08
    jelly = {**spec["entities"].pop("crate"), "role": "jelly", "material": "jelly", "dimensions": {"size": [low, low, high]}}
    jelly["parts"] = {"body": {"shape": {"kind": "box", "size": [low, low, high]}}}
    jelly["physics"] = {
        "category": "elastic", "young_modulus": young, "poisson_ratio": 0.4, "damping": 0.004, "resolution": 0.06,
    }  # fmt: skip
    spec["entities"]["jelly"] = {**jelly, "outputs": ["deformation"]}
    look = {"color": [0.75, 0.12, 0.08], "roughness": 0.2}
    spec["materials"]["jelly"] = {"density": density, "friction": 0.4, "appearance": look}
    spec["simulation"]["solvers"]["rigid"]["members"] = ["tank", "jelly"]
    spec["simulation"]["drivers"] = {"let_go": {"kind": "release", "entity": "jelly", "time": 0.0}}
    for beat in spec["story"]["beats"].values():
        beat["owner"], beat["subject"] = "let_go", "jelly"
        beat["predicate"]["entity"] = "jelly"
    if "crate" in spec["claims"]:
        spec["claims"]["crate"]["by"] = ["/entities/jelly"]
    return spec


def springboard_spec(*, frames: int = 8, crate_at: float = 0.13, **tank: Any) -> dict[str, Any]:
    """The tank with a crate that bobs in it and a short board that sticks out of its wall, without its prompt.

    Args:
        frames: at 24 per second.
        crate_at: height of the crate's centre at frame 0 [m]; held there while the water settles, under the surface.
        tank: arguments of `tank_spec`.
    """
    spec = tank_spec(frames=frames, crate_at=crate_at, **tank)
    size, at = (0.24, 0.08, 0.04), (INNER[0] / 2 + WALL + 0.12, 0.0, INNER[2] + 0.1)
    board = _entity("springboard", "dynamic", "board", size, at, outputs=["deformation"])
    board["physics"] = {
        "category": "elastic", "young_modulus": 1e6, "poisson_ratio": 0.3, "damping": 0.002, "resolution": 0.04,
        "pins": {"foot": {"center": [-0.1, 0, 0], "size": [0.045, 0.09, 0.05]}},
    }  # fmt: skip
    spec["entities"]["board"] = board
    spec["materials"]["board"] = {"density": 700, "friction": 0.4}
    spec["simulation"]["solvers"]["rigid"]["members"].append("board")
    # Held under while the water settles about it, the crate rises when it is let go.
    spec["simulation"]["preroll"] = 0.3
    spec["simulation"]["drivers"] = {f"let_go_{n}": {"kind": "release", "entity": n, "time": 0.0} for n in ("board", "crate")}
    return spec


def sea_spec(*, spacing: float = 0.05, engine: str = "flip", crate: bool = True, frames: int = 90, **sea: Any) -> dict[str, Any]:
    """A flume with waves from one end to the other in which a crate may float, without its prompt; `sea` changes the driver.

    Args:
        spacing: of the liquid [m].
        engine: of the liquid.
        crate: whether a crate floats in it.
        frames: at 24 per second.
    """
    depth, width, length = 0.3, 0.3, 2.6
    side = 0.12
    members = ["bed", *(["crate"] if crate else [])]
    wall, high = 0.06, 0.42
    long = length + 0.4
    slab = (long, width + 2 * wall, 0.1)
    flume = {
        "bottom": _box(slab, (0, 0, -0.05)),
        **{n: _box((long, wall, high), (0, y * (width + wall) / 2, high / 2)) for n, y in (("front", -1), ("back", 1))},
    }
    waves = {
        "kind": "waves", "entity": "water", "height": 0.07, "period": 0.8, "level": depth, "depth": depth, "zone": 1.0, "rise": 0.8, **sea,
    }  # fmt: skip
    return {
        "title": "A sea",
        "spec_version": "2",
        "claims": {
            **({"bobs": {"quote": "bobs", "type": "event", "by": ["/story/beats/bob"]}} if crate else {}),
            **({"crate": {"quote": "crate", "type": "thing", "by": ["/entities/crate"]}} if crate else {}),
            "waves": {"quote": "waves", "type": "weather", "by": ["/simulation/drivers/sea"]},
            "sea": {"quote": "sea", "type": "thing", "by": ["/entities/water"]},
        },
        "story": {
            "beats": {
                "bob": {"text": "the crate bobs in the waves", "owner": "rigid", "subject": "crate", "frames": [0, frames - 1],
                        "predicate": {"kind": "crosses", "entity": "crate", "point": [0, 0, round(depth + 0.012, 6)], "normal": [0, 0, 1]}},
            }
            if crate
            else {}
        },
        "materials": {
            "water": {"density": 1000, "substance": "water", "appearance": {"color": [0.8, 0.9, 0.95], "transmission": 1}},
            "wood": {"density": 500, "substance": "wood", "friction": 0.3},
            "stone": {"density": 2600, "substance": "stone", "friction": 0.5},
        },
        "entities": {
            "bed": _entity("bed of the sea between walls", "static", "stone", (slab[0], slab[1], 0.1 + high), (0, 0, 0), parts=flume),
            "water": _entity("the sea", "dynamic", "water", (length, width, depth), (0, 0, depth / 2),
                             physics={"category": "liquid", "resolution": spacing}),
            **({"crate": _entity("crate", "dynamic", "wood", (side,) * 3, (0, 0, depth + 0.002))} if crate else {}),
        },
        "graph": {"relations": {}},
        "shots": {
            "wide": {"frames": [0, frames - 1], "covers": ["bob"] if crate else [], "subjects": ["crate" if crate else "water"],
                     "keys": {"k": {"frame": 0, "position": [0.5, -1.3, 1.1], "target": [0, 0, 0.27]}}},
        },
        "simulation": {
            "fps": 24,
            "frames": frames,
            "solvers": {
                "rigid": {"engine": "mujoco", "members": members},
                "water": {"engine": engine, "members": ["water"], "settings": {
                    "domain": {"center": [0, 0, 0.25], "size": [length, width + 2 * wall, 0.7], "sides": ["closed"] * 5 + ["open"]}}},
            },
            "drivers": {"sea": waves},
            "couplings": {
                "float": {"source": "water", "target": "rigid", "direction": "two_way", "variables": ["motion", "wrench"]},
            },
        },
    }  # fmt: skip
