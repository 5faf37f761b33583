"""A tank bursts, floods a street and sweeps crates of bricks along, from its prompt to acceptance through a real client: `python -m worldagent.examples.burst_tank`."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from typing import Any

from ..worlds.claim_marks import with_claims
from .client_run import accept, play
from .domino_run import Agent

__all__ = ["PROMPT", "flood_spec", "main", "run"]

PROMPT = "A tank bursts when its gate is lifted, and the flood sweeps crates of bricks along a model street."
CLAIMS = (
    "A [tank](thing {0}/rear {0}/tank_north {0}/tank_south) [bursts](event bursts) [when](order lifts bursts) its [gate](thing gate) is "
    "[lifted](event lifts), and the [flood](thing water) [sweeps](event sweeps) [crates of bricks](thing crate_a crate_b crate_c) "
    "[along](route sweeps) a [model street](thing {0}/floor {0}/kerb_north {0}/kerb_south)."
).format("entities/basin/parts")
FPS = 24
STREET = (2.4, 1.0)
"""Length beyond the gate and inner width [m]."""
TANK = 0.7
"""Inner length of the tank [m]."""
HIGH = 0.75
"""Height of the tank's walls [m]."""
WALL = 0.1
KERB = 0.25
DEPTH = 0.5
"""Depth of the water in the tank [m]."""
GATE = 0.08
LIFTED = 1e-3
"""Between what stands and the floor at frame 0: two skins [m]."""
GAP = 0.002
"""Play of the gate between the walls [m]: far less than the water resolves."""
CRATE = (0.2, 0.2, 0.12)
CRATE_DENSITY = 1200.0
"""Density of a crate packed with bricks [kg/m^3], 5.8 kg each. Heavier than water, for they stand flat on the floor, where particles do not get
under them: the flood pushes them, and nothing has to lift them."""
SWEPT = 0.4
"""Least way that the flood sweeps each crate along the street [m]; a crate is 0.2 m long."""
CRATES = {"crate_a": (0.7, 0.2), "crate_b": (0.95, -0.22), "crate_c": (1.25, 0.05)}
LIFT = (0.25, 1.0)
"""The gate rises between these times [s]."""


def _box(size: Sequence[float], at: Sequence[float]) -> dict[str, Any]:
    return {"shape": {"kind": "box", "size": [round(v, 4) for v in size]}, "pose": {"position": [round(v, 4) for v in at]}}


def _entity(role: str, motion: str, material: str, size: Sequence[float], at: Sequence[float], **more: Any) -> dict[str, Any]:
    size, at = [round(v, 4) for v in size], [round(v, 4) for v in at]
    parts = more.pop("parts", {"body": {"shape": {"kind": "box", "size": size}}})
    return {"role": role, "motion": motion, "material": material, "dimensions": {"size": size}, "pose": {"position": at}, "parts": parts, **more}  # fmt: skip


def _basin() -> dict[str, Any]:
    """Street and tank in one: floor, the tank's walls, kerbs, and a step at the street's end that keeps some water in."""
    length, width = STREET
    left, right = -GATE - TANK - WALL, length + WALL
    outer = width + 2 * WALL
    parts = {"floor": _box((right - left, outer, WALL), ((left + right) / 2, 0, -WALL / 2)),
             "rear": _box((WALL, outer, HIGH), (left + WALL / 2, 0, HIGH / 2)),
             "end": _box((WALL, outer, KERB), (right - WALL / 2, 0, KERB / 2))}  # fmt: skip
    for name, side in (("north", 1), ("south", -1)):
        y = side * (width + WALL) / 2
        parts[f"tank_{name}"] = _box((TANK + GATE, WALL, HIGH), (-(TANK + GATE) / 2, y, HIGH / 2))
        parts[f"kerb_{name}"] = _box((length, WALL, KERB), (length / 2, y, KERB / 2))
    return _entity(
        "street with a tank at its head", "static", "stone", (right - left, outer, HIGH + WALL), (0, 0, 0), parts=parts
    )


def _crate(x: float, y: float) -> dict[str, Any]:
    """A box that stands flat on the street."""
    return _entity("crate of bricks on the street", "dynamic", "packed", CRATE, (x, y, CRATE[2] / 2 + LIFTED))


def flood_spec(spacing: float, engine: str = "dfsph", seconds: float = 2.5) -> dict[str, Any]:
    """The specification, its liquid resolved by `spacing` [m]."""
    frames = round(seconds * FPS)
    length, width = STREET
    wet = (TANK - 0.001, width - 0.001, DEPTH)
    crates = {name: _crate(x, y) for name, (x, y) in CRATES.items()}
    gate_at = (-GATE / 2, 0, HIGH / 2 + LIFTED)
    up = (gate_at[0], 0, gate_at[2] + HIGH)

    def key(at: float, place: Sequence[float]) -> dict[str, Any]:
        return {"time": at, "pose": {"position": [round(v, 4) for v in place]}}

    def beat(text: str, owner: str, subject: str, frames: list[int], predicate: dict[str, Any], *causes: str) -> dict[str, Any]:
        return {
            "text": text, "owner": owner, "subject": subject, "frames": frames, "predicate": predicate, "causes": list(causes)
        }  # fmt: skip

    last = frames - 1
    through = {"kind": "liquid_flux_through", "entity": "water", "point": [0, 0, HIGH / 2], "normal": [1, 0, 0], "size": [width, HIGH],
               "measure": "total", "min": 0.02}  # fmt: skip
    swept = {"kind": "and", "of": [{"kind": "slides", "entity": "each"},
                                   {"kind": "displacement", "entity": "each", "axis": [1, 0, 0], "min": SWEPT}]}  # fmt: skip
    spec = {
        "title": "Burst tank",
        "materials": {
            "water": {"density": 1000, "substance": "water", "appearance": {"color": [0.75, 0.88, 0.93], "transmission": 1, "roughness": 0.02}},
            "stone": {"density": 2400, "substance": "concrete", "friction": 0.6, "appearance": {"pattern": "concrete", "roughness": 0.7}},
            "wood": {"density": 600, "substance": "wood", "friction": 0.4, "appearance": {"color": [0.45, 0.30, 0.16], "pattern": "wood"}},
            "packed": {"density": CRATE_DENSITY, "substance": "other", "friction": 0.4, "appearance": {"color": [0.55, 0.36, 0.18], "pattern": "wood"}},
        },
        "entities": {
            "basin": _basin(),
            "gate": _entity("gate of the tank", "kinematic", "wood", (GATE - 2 * GAP, width - 2 * GAP, HIGH), gate_at),
            "water": _entity(
                "water in the tank", "dynamic", "water", wet, (-GATE - TANK / 2, 0, DEPTH / 2),
                physics={"category": "liquid", "resolution": spacing},
            ),
            **crates,
        },
        "graph": {
            "regions": {"street": {"kind": "box", "min": [length / 2, -width / 2, 0], "max": [length, width / 2, HIGH]}},
            "relations": {f"on_{n}": {"kind": "supports", "a": "basin", "b": n, "frames": [0, round(LIFT[0] * FPS)]} for n in crates},
        },
        "story": {
            "semantics": "A dam break in a model street; the crates stand free on its floor.",
            "beats": {
                "lifts": beat("the gate is lifted", "lift", "gate", [4, 30],
                              {"kind": "rises", "entity": "gate", "min": 0.15}),
                "bursts": beat("water bursts out", "water", "water", [6, 36],
                               {"kind": "and", "of": [through, {"kind": "liquid_speed", "entity": "water", "measure": "largest", "min": 2.0}]}, "lifts"),
                "floods": beat("the far half of the street is flooded", "water", "water", [10, last],
                               {"kind": "liquid_volume_in", "entity": "water", "region": "street", "min": 0.02}, "lifts"),
                "sweeps": beat("the flood sweeps all crates along the street", "bodies", "crate_a", [10, last],
                               {"kind": "count", "entities": list(CRATES), "predicate": swept, "min": len(CRATES)}, "bursts"),
            },
        },
        "shots": {
            "street": {"frames": [0, last], "covers": ["lifts", "bursts", "floods", "sweeps"], "subjects": ["water", "crate_a"],
                       "keys": {"a": {"frame": 0, "position": [3.0, -2.6, 2.1], "target": [0.7, 0, 0.1], "fov_deg": 42}}},
        },
        "simulation": {
            "fps": FPS,
            "frames": frames,
            "solvers": {
                "bodies": {"engine": "mujoco", "members": ["basin", "gate", *crates]},
                "water": {"engine": engine, "members": ["water"], "settings": {"domain": {
                    "center": [round((length - TANK) / 2, 4), 0, 0.55], "size": [round(length + TANK + 0.8, 4), width + 0.6, 1.5]}}},
            },
            "drivers": {"lift": {"kind": "path", "entity": "gate", "keys": {"a": key(0, gate_at), "b": key(LIFT[0], gate_at), "c": key(LIFT[1], up)}}},
            "couplings": {"push": {"source": "water", "target": "bodies", "direction": "two_way", "variables": ["motion", "wrench"]}},
        },
    }  # fmt: skip
    return with_claims(spec, PROMPT, CLAIMS)


async def _work(agent: Agent, options: argparse.Namespace) -> dict[str, Any]:
    return {"accepted": await accept(agent, PROMPT, flood_spec(options.spacing, options.engine))}


def run(options: argparse.Namespace) -> dict[str, Any]:
    """One run in a fresh world folder; returns what happened."""
    return play(Agent, "burst_tank", PROMPT, options, lambda agent: _work(agent, options))


def main(argv: Sequence[str] | None = None) -> int:
    """Exit code 0 when the world was accepted; the last line is one JSON object."""
    parser = argparse.ArgumentParser(prog="burst_tank", description=PROMPT)
    parser.add_argument("--out", default="demo-out", help="workspace of the world")
    parser.add_argument("--spacing", type=float, default=0.03, help="of the liquid's particles, or its cells [m]")
    parser.add_argument("--engine", choices=("dfsph", "flip"), default="dfsph")
    parser.add_argument("--no-render", action="store_true")
    found = run(parser.parse_args(argv))
    print(json.dumps(found))
    return 0 if found["accepted"] else 1


if __name__ == "__main__":
    sys.exit(main())
