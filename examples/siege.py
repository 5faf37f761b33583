"""A cannonball breaches a city wall under a flag, from its prompt to acceptance through a real client: `python -m worldagent.examples.siege`."""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Sequence
from typing import Any

from ..worlds.claim_marks import with_claims
from .client_run import accept, play
from .domino_run import Agent

__all__ = ["PROMPT", "SECONDS", "main", "run", "siege_spec"]

PROMPT = "A cannonball breaches a city wall, the breach collapses, and the flag on the tower whips in the gust."
CLAIMS = (
    "A [cannonball](thing ball) [breaches](event strikes breaches) a [city wall](thing wall), the [breach](thing same_as=city_wall) "
    "[collapses](event collapses), and the [flag](thing flag) on the [tower](thing tower_east) [whips](event whips) in the [gust](weather gust)."
)
FPS = 24
WALL = (3.6, 0.25, 2.0)
STONE = (0.39, 0.25, 0.19)
JOINT = 0.01
BALL = 0.3
"""Radius of the ball [m]: of a great bombard, 814 kg of iron."""
BARREL = 0.42
SPEED = 22.0
AIM = 0.75
"""Height at which the ball meets the wall [m], about."""
OVER = AIM + BALL + 0.02
"""Stones that are built higher [m] the ball does not reach: they come down when those beneath are gone."""
FALLEN = {"min": 5, "min_distance": 0.4}
"""The breach collapses: so many of them fall so far [m]."""
MUZZLE = -5.0
"""y of the ball before it is fired [m]."""
FIRED, BURN = 0.25, 0.02
"""When the charge burns, and how long [s]."""
TOWER = (1.1, 1.1, 2.8)
GAP = 0.02
"""Between wall and towers, and two skins under what stands [m]."""
POLE = (0.03, 1.7)
FLAG = (0.95, 0.6)
SECONDS = 3.0
HANGING = 4.0
"""So long the flag has hung in still air before frame 0 [s]."""
GUST, RISE = 0.9, 0.3
"""When the gust comes, and in which time it comes up [s]."""
SWUNG = 0.6
"""So long after it began the hanging flag has swung out [s]: what it does from then on is its whipping."""
WIND = (8.0, -1.5, 0.0)
"""Mean wind of the gust [m/s]."""
RISEN = 0.1
"""Rise of the flag's middle in the gust [m]: against its weight, so nothing else here does it."""
WHIP = {"min_amplitude": 0.05, "min_cycles": 3, "min_frequency": 1.5}
"""Least motion of a flag that whips. In a wind U a flag of length L waves at 0.2 to 0.4 U / L, 1.7 to 3.4 Hz here; one that hangs in
still air sways as a pendulum of its height does, at sqrt(g / h) / 2 pi = 0.6 Hz, by some centimetres."""
LIFT = 1e-3


def _part(kind: str, at: Sequence[float] = (0, 0, 0), turn: Sequence[float] | None = None, **shape: Any) -> dict[str, Any]:
    pose: dict[str, Any] = {"position": [round(v, 4) for v in at]}
    if turn is not None:
        pose["quaternion"] = list(turn)
    return {"shape": {"kind": kind, **shape}, "pose": pose}


def _entity(role: str, motion: str, material: str, size: Sequence[float], at: Sequence[float], **more: Any) -> dict[str, Any]:
    size, at = [round(v, 4) for v in size], [round(v, 4) for v in at]
    parts = more.pop("parts", {"body": {"shape": {"kind": "box", "size": size}}})
    return {"role": role, "motion": motion, "material": material, "dimensions": {"size": size}, "pose": {"position": at}, "parts": parts, **more}  # fmt: skip


def _tower() -> dict[str, Any]:
    """A square tower with a merlon on each corner; its frame stands on the ground."""
    wide, deep, tall = TOWER
    merlon = 0.3
    parts = {"shaft": _part("box", (0, 0, (tall - merlon) / 2), size=[wide, deep, tall - merlon])}
    for k, (x, y) in enumerate(((-1, -1), (1, -1), (-1, 1), (1, 1))):
        place = (x * (wide - merlon) / 2, y * (deep - merlon) / 2, tall - merlon / 2)
        parts[f"merlon_{k}"] = _part("box", place, size=[merlon, merlon, merlon])
    return parts


def _cannon() -> dict[str, Any]:
    """A barrel on its carriage; the frame's origin is the middle of the barrel."""
    along = [math.sqrt(0.5), math.sqrt(0.5), 0, 0]
    return {
        "barrel": _part("cylinder", turn=along, radius=BARREL, height=1.4),
        "carriage": _part("box", (0, -0.15, -(AIM + BARREL) / 2), size=[0.5, 1.0, AIM - BARREL]),
    }


def siege_spec(edge: float = 0.05, seconds: float = SECONDS) -> dict[str, Any]:
    """The specification.

    Args:
        edge: of the flag's triangles [m].
        seconds: that are simulated.
    """
    frames = round(seconds * FPS) + 1
    last = frames - 1
    mass = 7200 * 4 / 3 * math.pi * BALL**3
    side = WALL[0] / 2 + GAP + TOWER[0] / 2
    top = TOWER[2] - 0.3
    pole_at = (side, 0, top + POLE[1] / 2 + LIFT)
    flag_at = (side + POLE[0] + 0.02 + FLAG[0] / 2, 0, top + POLE[1] - FLAG[1] / 2)

    def beat(text: str, owner: str, subject: str, frames: list[int], predicate: dict[str, Any], *causes: str) -> dict[str, Any]:
        return {
            "text": text, "owner": owner, "subject": subject, "frames": frames, "predicate": predicate, "causes": list(causes)
        }  # fmt: skip

    fallen = {"kind": "debris", "entity": "wall", "axis": [0, 0, -1], "region": "over_the_ball", **FALLEN}
    fired, gust, out = (round(t * FPS) for t in (FIRED, GUST, GUST + SWUNG))
    spec = {
        "title": "Siege",
        "materials": {
            "ashlar": {"density": 2200, "substance": "stone", "friction": 0.6, "appearance": {"color": [0.62, 0.54, 0.4], "roughness": 0.9}},
            "earth": {"density": 1800, "substance": "soil", "friction": 0.8, "appearance": {"color": [0.3, 0.36, 0.17], "roughness": 1}},
            "iron": {"density": 7200, "substance": "iron", "friction": 0.4, "appearance": {"color": [0.07, 0.07, 0.08], "roughness": 0.4}},
            "wood": {"density": 650, "substance": "wood", "friction": 0.5, "appearance": {"color": [0.35, 0.22, 0.12], "pattern": "wood"}},
            "silk": {"density": 240, "substance": "fabric", "friction": 0.4, "appearance": {"color": [0.7, 0.04, 0.05], "roughness": 0.6}},
        },
        "entities": {
            "ground": _entity("field before the city", "static", "earth", (60, 60, 0.4), (0, 0, -0.2)),
            "wall": _entity(
                "city wall and its breach", "dynamic", "ashlar", WALL, (0, 0, WALL[2] / 2 + LIFT),
                breakable={"pattern": {"kind": "bricks", "size": STONE, "joint": JOINT},
                           "bond": {"tension": 8e5, "shear": 1.2e6}, "fixed": ["z-"]},
            ),
            "tower_west": _entity("tower", "static", "ashlar", TOWER, (-side, 0, 0), parts=_tower()),
            "tower_east": _entity("tower with the flag", "static", "ashlar", TOWER, (side, 0, 0), parts=_tower()),
            "cannon": _entity(
                "cannon", "static", "iron", (2 * BARREL, 1.4, AIM + BARREL), (0, MUZZLE - BALL - 0.01 - 0.7, AIM), parts=_cannon()
            ),
            "ball": _entity("cannonball", "dynamic", "iron", (2 * BALL,) * 3, (0, MUZZLE, AIM), parts={"body": _part("sphere", radius=BALL)}),
            "pole": _entity("flagpole", "static", "wood", (2 * POLE[0], 2 * POLE[0], POLE[1]), pole_at, parts={"body": _part("cylinder", radius=POLE[0], height=POLE[1])}),
            "flag": {
                "role": "flag", "motion": "dynamic", "material": "silk", "dimensions": {"size": [FLAG[0], FLAG[1], 0.0005]},
                "pose": {"position": [round(v, 4) for v in flag_at], "quaternion": [math.sqrt(0.5), math.sqrt(0.5), 0, 0]},
                "parts": {"body": {"shape": {"kind": "sheet", "size": list(FLAG), "resolution": edge}}},
                "physics": {"category": "cloth", "area_density": 0.12, "thickness": 0.0005, "stretch_stiffness": 6000,
                            "bend_stiffness": 1e-5, "damping": 3e-5, "max_stretch": 0.08, "pins": {"hoist": {"edge": "-x"}}},
            },
        },
        "graph": {
            "regions": {
                "over_the_ball": {"kind": "box", "min": [-WALL[0] / 2, -WALL[1], round(OVER, 4)], "max": [WALL[0] / 2, WALL[1], WALL[2] + 0.1]},
            },
        },
        "story": {
            "semantics": "A siege gun breaks a wall of bonded ashlar on a day without wind, until a gust comes.",
            "beats": {
                "leaves": beat("the ball leaves its place", "hold", "ball", [fired - 1, fired + 3],
                               {"kind": "displacement", "entity": "ball", "axis": [0, 1, 0], "min": 0.05}),
                "fires": beat("the cannon fires", "charge", "ball", [fired - 1, fired + 3],
                              {"kind": "displacement", "entity": "ball", "axis": [0, 1, 0], "min": 0.5}, "leaves"),
                "strikes": beat("the ball strikes the wall", "stones", "wall", [fired, fired + 8],
                                {"kind": "hits", "entity": "ball", "other": "wall"}, "fires"),
                "breaches": beat("the ball breaks the wall", "stones", "wall", [fired, fired + 12],
                                 {"kind": "broken", "entity": "wall", "by": "ball", "min": 0.02}, "strikes"),
                "collapses": beat("the breach collapses", "stones", "wall", [fired + 2, last],
                                  {"kind": "and", "of": [{"kind": "breaks", "entity": "wall"}, fallen]}, "breaches"),
                "blows": beat("the gust lifts the flag", "gust", "flag", [gust, out + 6],
                              {"kind": "displacement", "entity": "flag", "axis": [0, 0, 1], "min": RISEN}),
                "whips": beat("the flag whips in the gust", "silk", "flag", [out, last], {"kind": "flutters", "entity": "flag", **WHIP}, "blows"),
            },
            "requirements": {
                "whole": {"text": "the wall stands whole until the ball comes", "frames": [0, fired],
                          "predicate": {"kind": "broken", "entity": "wall", "max": 0, "when": "always"}},
            },
        },
        "shots": {
            "siege": {"frames": [0, last], "covers": ["leaves", "fires", "strikes", "breaches", "collapses", "blows", "whips"], "subjects": ["wall", "flag"],
                      "keys": {"a": {"frame": 0, "position": [-3.2, -6.2, 2.3], "target": [0.7, 0, 1.65], "fov_deg": 50}}},
        },
        "simulation": {
            "fps": FPS,
            "frames": frames,
            "preroll": HANGING,
            "solvers": {
                "stones": {"engine": "mujoco", "members": ["ground", "wall", "tower_west", "tower_east", "cannon", "ball", "pole"],
                           "settings": {"step": 2.5e-4, "refine": 2, "impratio": 1.0, "tolerance": 1e-5}},
                "silk": {"engine": "shell", "members": ["flag"]},
            },
            "drivers": {
                "hold": {"kind": "release", "entity": "ball", "time": FIRED},
                "charge": {"kind": "force", "entity": "ball", "force": [0, round(mass * SPEED / BURN, 1), 0], "start": FIRED, "end": FIRED + BURN},
                "air": {"kind": "field", "field": {"kind": "drag"}, "entities": ["flag"], "start": -HANGING},
                "gust": {"kind": "field", "field": {"kind": "wind", "velocity": list(WIND), "gust": 0.3, "gust_period": 0.6}, "entities": ["flag"], "start": GUST, "rise": RISE},
            },
        },
    }  # fmt: skip
    return with_claims(spec, PROMPT, CLAIMS)


async def _work(agent: Agent, options: argparse.Namespace) -> dict[str, Any]:
    return {"accepted": await accept(agent, PROMPT, siege_spec(options.edge, options.seconds))}


def run(options: argparse.Namespace) -> dict[str, Any]:
    """One run in a fresh world folder; returns what happened."""
    return play(Agent, "siege", PROMPT, options, lambda agent: _work(agent, options))


def main(argv: Sequence[str] | None = None) -> int:
    """Exit code 0 when the world was accepted; the last line is one JSON object."""
    parser = argparse.ArgumentParser(prog="siege", description=PROMPT)
    parser.add_argument("--out", default="demo-out", help="workspace of the world")
    parser.add_argument("--edge", type=float, default=0.05, help="of the flag's triangles [m]")
    parser.add_argument("--seconds", type=float, default=SECONDS, help="that are simulated")
    parser.add_argument("--no-render", action="store_true")
    found = run(parser.parse_args(argv))
    print(json.dumps(found))
    return 0 if found["accepted"] else 1


if __name__ == "__main__":
    sys.exit(main())
