"""A stream carries beams and a log, from its prompt to acceptance through a real client: `python -m worldagent.examples.stream`.

The land is generated and the stream follows from it. The agent cuts the ground, has its water made a liquid, reads from the
specification where the stream runs and how fast, asks the land for heights, and puts bridge, log and beams there.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import math
import os
import shutil
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .domino_run import Agent

__all__ = ["PROMPT", "land_spec", "main", "run"]

PROMPT = "A stream carries beams and a log under a footbridge."
CLAIMS = (
    "A [stream](thing river) [carries](event flows log_passes beams_drift) [beams](thing {}) and a [log](thing log) [under](route log_passes) a "
    "[footbridge](thing footbridge)."
)
"""The prompt, marked; `{}` stands for the ids of the beams."""
WAIT_SECONDS = 25.0
EXTENT = (320.0, 128.0)
"""Extent of the landscape x, y [m]."""
DISCHARGE = 5.5
"""Discharge of the stream where it comes in, mean over the year [m^3/s]; it runs bankfull, at five times that."""
BRIDGE_AT = 26.0
"""Where the bridge stands along x [m]: the stream runs straight there."""
CLEARANCE = 2.1
"""Height of the bridge over the water [m]; over the banks at its feet three cells are left for water to pass."""
DECK = (2.2, 0.35)
"""Width and thickness of the bridge's deck [m]."""
WALL = 0.3
"""Thickness of its parapets [m]: walls that the water's cells see."""
PARAPET = 1.0
"""Their height [m]: they are its girders. The air of the water's domain goes on over them."""
GROUND_CELL = 0.55
"""Cell of the ground [m]: finer than the bed, and few enough corners of the water for the specification."""
LOG = (0.3, 3.2)
"""Radius and length [m]."""
LOG_DENSITY, BEAM_DENSITY = 600.0, 550.0
"""Densities of air-dry beech and pine [kg/m^3]."""
BEAM = (2.4, 0.3, 0.3)
"""Length, width, thickness [m]: squared timber of 119 kg. It is as thick as the water's cells, which then bear it at its true draft (within
a millimetre in still water); a board of 0.12 m sinks 4 cm too deep in them, and a real leaf is far thinner than both."""
BEAMS = ((4.5, 0.5), (5.5, -3.0), (-4.2, -1.6), (-5.5, 2.4), (8.0, 1.6), (-8.5, -1.0))
"""Along and across the stream from the log [m]."""
CARRIED = 0.3
"""Least way of the floating bodies, which lie at rest at first, in parts of the water's: the stream has to take them along."""
SPACING = 0.3
"""Cell of the liquid [m]: the deepest water is five cells across, as buoyancy asks."""
SECONDS = 8.0
REACH = (44.0, 30.0)
"""Size of the ground with its stream x, y [m]."""
CENTER = (24.0, 4.0)


def _line() -> list[list[float]]:
    """The valley, from west to east."""
    places = np.linspace(-0.5, 0.5, 33) * EXTENT[0]
    return [
        [round(float(x), 1), round(11 * math.sin(2 * math.pi * x / 95) + 4 * math.sin(2 * math.pi * x / 41 + 1), 1)]
        for x in places
    ]


def land_spec(seconds: float, fps: float) -> dict[str, Any]:
    """The first specification: the land and what things are made of."""
    line = _line()
    return {
        "title": "Stream under a footbridge",
        "terrains": {
            "valley": {
                "extent": EXTENT,
                "cell": 1.0,
                "layers": {
                    "slope": {"kind": "ramp", "rise": 2.2, "direction_deg": 180, "order": 1},
                    "meadow": {"kind": "noise", "style": "fbm", "amplitude": 1.2, "wavelength": 60, "order": 2, "seed": 3},
                    "valley": {"kind": "valley", "line": line, "width": 44, "depth": 3, "fall": 1.6, "floor": 0.1, "order": 3},
                },
                "erosion": {"years": 300, "steps": 4, "creep": 0.002},
                "climate": {"biome": "temperate"},
                "hydrology": {
                    "inflows": {"upstream": {"position": [1 - EXTENT[0] / 2, line[0][1]], "discharge": DISCHARGE}},
                    "required": ["river"],
                    "density": 0,
                },
                "ground": {
                    "grass": {"order": 1, "material": "meadow"},
                    "bed": {"order": 2, "material": "gravel", "blend": 2.0, "where": [{"field": "water_distance", "at_most": 1.0}]},
                },
                "vegetation": {"density": 0.35},
            }
        },
        "materials": {
            "meadow": {"density": 1400, "substance": "other", "friction": 0.7, "appearance": {"color": [0.075, 0.11, 0.03], "roughness": 0.9}},
            "gravel": {"density": 1900, "substance": "stone", "friction": 0.7, "appearance": {"color": [0.20, 0.17, 0.13], "roughness": 0.9}},
            "water": {"density": 1000, "substance": "water", "appearance": {"color": [0.72, 0.84, 0.80], "transmission": 1, "roughness": 0.04}},
            "larch": {"density": 590, "substance": "wood", "friction": 0.5, "appearance": {"color": [0.36, 0.25, 0.15], "pattern": "wood"}},
            "wood": {"density": LOG_DENSITY, "substance": "wood", "friction": 0.5, "appearance": {"color": [0.30, 0.19, 0.10], "pattern": "wood"}},
            "pine": {"density": BEAM_DENSITY, "substance": "wood", "friction": 0.5, "appearance": {"color": [0.62, 0.45, 0.26], "pattern": "wood"}},
        },
        "look": {"width": 1280, "height": 720, "sun_elevation_deg": 42, "sun_azimuth_deg": 200},
        "simulation": {"fps": fps, "frames": round(seconds * fps) + 1},
    }  # fmt: skip


class Course:
    """The stream as the specification tells it: a line on its surface with speeds."""

    def __init__(self, river: dict[str, Any]) -> None:
        current = max(river["physics"]["currents"].values(), key=lambda c: len(c["line"]))
        self.line = np.array(current["line"]) + np.array(river["pose"]["position"])
        self.speeds = np.array(current["speeds"])
        self.width = float(current["width"])
        steps = np.linalg.norm(np.diff(self.line[:, :2], axis=0), axis=1)
        self.way = np.concatenate([[0.0], np.cumsum(steps)])

    @property
    def length(self) -> float:
        """[m]"""
        return float(self.way[-1])

    def along_x(self, x: float) -> float:
        """Way to where it passes this x [m]."""
        return float(np.interp(x, self.line[:, 0], self.way))

    def at(self, way: float, aside: float = 0.0) -> tuple[np.ndarray, np.ndarray, float]:
        """Place on the surface, direction and speed; `aside` to the left [m]."""
        place = np.array([np.interp(way, self.way, self.line[:, k]) for k in range(3)])
        ahead = np.array([np.interp(way + 1.0, self.way, self.line[:, k]) for k in range(2)])
        along = (ahead - place[:2]) / max(float(np.linalg.norm(ahead - place[:2])), 1e-9)
        place[:2] += aside * np.array([-along[1], along[0]])
        return place, along, float(np.interp(way, self.way, self.speeds))


def _turned(along: np.ndarray, extra: float = 0.0) -> list[float]:
    """About z so that local x points along."""
    half = 0.5 * (math.atan2(along[1], along[0]) + extra)
    return [round(math.cos(half), 9), 0.0, 0.0, round(math.sin(half), 9)]


def _floating_height(radius: float, ratio: float) -> float:
    """Height of a lying cylinder's axis over the water at rest [m]; `ratio` of its section is under it."""
    low, high = -radius, radius
    for _ in range(60):
        middle = 0.5 * (low + high)
        angle = math.acos(middle / radius)
        under = (angle - math.sin(angle) * math.cos(angle)) / math.pi
        low, high = (middle, high) if under > ratio else (low, middle)
    return 0.5 * (low + high)


def _numbers(values: Sequence[float] | np.ndarray) -> list[float]:
    return [round(float(v), 5) for v in values]


def _body(role: str, material: str, shape: dict[str, Any], size: Sequence[float], place: Any, turn: list[float], at: Any = None) -> dict[str, Any]:  # fmt: skip
    part = {"shape": shape, **({"pose": at} if at else {})}
    return {
        "role": role, "motion": "dynamic", "material": material, "dimensions": {"size": list(size)}, "parts": {"body": part},
        "pose": {"position": _numbers(place), "quaternion": turn},
    }  # fmt: skip


def _open(rows: list[dict[str, Any]]) -> str:
    """Open rows, a line each."""
    told = [(r["id"], r["status"], r.get("evidence") or r.get("why") or "") for r in rows]
    return "".join(f"\n  {i}: {s}; {e.get('explanation', e) if isinstance(e, dict) else e}" for i, s, e in told)


class Ranger(Agent):
    """The agent of this world."""

    course: Course
    rate: float
    """Discharge that comes in [m^3/s]."""

    async def settle(self, options: argparse.Namespace) -> bool:
        """Declare the land, build it with its stream as a liquid, and put the things there."""
        data, refused = await self.call("edit_spec", prompt=PROMPT, spec=land_spec(options.seconds, options.fps))
        if refused:
            self.say(data["refused"])
            return False
        data, refused = await self.call(
            "build_terrain", terrain="valley", liquid="river", spacing=options.spacing, size=options.size, center=options.center,
            cells=min(512, round(max(options.size) / GROUND_CELL)), material="meadow", wait_s=WAIT_SECONDS,
        )  # fmt: skip
        if refused:
            self.say(data["refused"])
            return False
        self.say(f"water: {json.dumps(data['water'])}")
        self.rate = sum(g["rate_m3_s"] for g in data["water"]["inflows"])
        self.course = Course((await self.spec())["entities"]["river"])
        self.say(f"the stream runs {self.course.length:.0f} m through the ground, {self.course.width:.1f} m wide")
        patch = await self.things(options)
        claims = CLAIMS.format(" ".join(f"beam_{n}" for n in range(options.beams)))
        data, refused = await self.call("edit_spec", patch=patch, claims=claims)
        if refused or not data["audit"]["passed"]:
            self.say(data.get("refused") or json.dumps(data["audit"]["open_rows"])[:2000])
            return False
        return True

    async def heights(self, points: list[list[float]]) -> list[float]:
        """Heights of the ground at points x, y [m]."""
        told, refused = await self.call("inspect_world", part="terrain", points=points)
        if refused:
            raise RuntimeError(told["refused"])
        return [float(p["height"]) for p in told["places"]]

    async def bridge(self, way: float) -> dict[str, Any]:
        """A deck between two girders across the stream, on two feet in the banks."""
        place, along, _ = self.course.at(way)
        across = np.array([-along[1], along[0]])
        half = 0.5 * self.course.width + 1.3
        feet = [place[:2] + side * (half - 0.6) * across for side in (-1, 1)]
        corners = [foot + a * 0.9 * along + b * 0.5 * across for foot in feet for a in (-1, 1) for b in (-1, 1)]
        ground = await self.heights([_numbers(c) for c in corners])
        under = place[2] + CLEARANCE
        parts: dict[str, Any] = {
            "deck": {"shape": {"kind": "box", "size": [DECK[0], 2 * half, DECK[1]]}, "pose": {"position": [0, 0, 0.5 * DECK[1]]}}
        }
        for n, side in enumerate((-1, 1)):
            low = min(ground[4 * n : 4 * n + 4]) - 0.3 - under
            parts[f"foot_{n}"] = {
                "shape": {"kind": "box", "size": _numbers([1.8, 1.0, -low])},
                "pose": {"position": _numbers([0, side * (half - 0.6), 0.5 * low])},
            }
            parts[f"parapet_{n}"] = {
                "shape": {"kind": "box", "size": [WALL, 2 * half, PARAPET]},
                "pose": {"position": _numbers([side * 0.5 * (DECK[0] - WALL), 0, DECK[1] + 0.5 * PARAPET])},
            }
        high = max(p["pose"]["position"][2] + 0.5 * p["shape"]["size"][2] for p in parts.values())
        low = min(p["pose"]["position"][2] - 0.5 * p["shape"]["size"][2] for p in parts.values())
        return {
            "role": "footbridge", "motion": "static", "material": "larch", "parts": parts,
            "dimensions": {"size": _numbers([DECK[0], 2 * half, high - low])},
            "pose": {"position": _numbers([place[0], place[1], under]), "quaternion": _turned(along)},
        }  # fmt: skip

    def drifting(self, way: float, beams: int) -> dict[str, Any]:
        """The log and the beams at their drafts, at rest: the stream takes them along."""
        place, along, _ = self.course.at(way)
        height = _floating_height(LOG[0], LOG_DENSITY / 1000)
        lying = {"quaternion": [0.707106781, 0, 0.707106781, 0]}
        found = {
            "log": _body("log", "wood", {"kind": "cylinder", "radius": LOG[0], "height": LOG[1]}, (LOG[1], 2 * LOG[0], 2 * LOG[0]),
                         [*place[:2], place[2] + height], _turned(along, 0.3), lying)
        }  # fmt: skip
        for n, (ahead, aside) in enumerate(BEAMS[:beams]):
            place, along, _ = self.course.at(way + ahead, aside)
            place[2] += (0.5 - BEAM_DENSITY / 1000) * BEAM[2]
            shape = {"kind": "box", "size": list(BEAM)}
            found[f"beam_{n}"] = _body("beam on the stream", "pine", shape, BEAM, place, _turned(along, 1.1 * n))
        return found

    async def things(self, options: argparse.Namespace) -> list[dict[str, Any]]:
        """Operations for bridge, log, beams, story, shots and coupling."""
        last = round(options.told * options.fps)
        bridge = self.course.along_x(BRIDGE_AT)
        place, along, speed = self.course.at(bridge)
        drift = speed * options.told
        start = bridge - CARRIED * drift
        floats = self.drifting(start, options.beams)
        beams = [n for n in floats if n.startswith("beam")]
        moved = {"kind": "displacement", "entity": "each", "axis": [*_numbers(along), 0], "min": round(CARRIED * drift, 2)}
        flux = {"kind": "liquid_flux_through", "entity": "river", "point": _numbers(place), "normal": [*_numbers(along), 0],
                "size": [round(self.course.width + 2, 2), 4.0], "measure": "total", "min": round(0.25 * self.rate * options.told, 2)}  # fmt: skip

        def beat(text: str, owner: str, subject: str, predicate: dict[str, Any], *causes: str) -> dict[str, Any]:
            return {"text": text, "owner": owner, "subject": subject, "frames": [0, last], "predicate": predicate, "causes": list(causes)}  # fmt: skip

        bodies = await self.rigid_instance()
        drivers = (await self.spec())["simulation"]["drivers"]
        source = next(n for n, d in drivers.items() if d["kind"] == "inflow")
        beats = {
            "flows": beat("the stream flows under the bridge", source, "river", flux),
            "log_passes": beat("the log passes under the footbridge", bodies, "log",
                               {"kind": "crosses", "entity": "log", "point": _numbers(place), "normal": [*_numbers(along), 0]}, "flows"),
            "beams_drift": beat("all beams are carried on", bodies, beams[0],
                                 {"kind": "count", "entities": beams, "predicate": moved, "min": len(beams)}, "flows"),
        }  # fmt: skip
        back, _, _ = self.course.at(bridge + 13.0)
        shots = {
            "low": {"frames": [0, round(options.seconds * options.fps)], "subjects": ["log", "beam_0"], "covers": [*beats],
                    "keys": {"a": {"frame": 0, "position": _numbers([*back[:2], back[2] + 3.6]), "target": _numbers([*place[:2], place[2] + 0.2]), "fov_deg": 55}}},
        }  # fmt: skip
        self.say(f"the log lies {CARRIED * drift:.1f} m upstream of the bridge in a stream of {speed:.2f} m/s")
        relations: dict[str, dict[str, Any]] = {
            f"carries_{n}": {"kind": "supports", "a": "river", "b": n, "frames": [0, last]} for n in floats
        }
        relations["set"] = {
            "kind": "fastened", "a": "footbridge", "b": "ground", "max_depth": 1.5, "reason": "the feet of the bridge stand in the banks"
        }  # fmt: skip
        things = {"footbridge": await self.bridge(bridge), **floats}
        return [
            *({"op": "add", "path": f"/entities/{n}", "value": v} for n, v in things.items()),
            *({"op": "add", "path": f"/simulation/solvers/{bodies}/members/-", "value": n} for n in things),
            {"op": "add", "path": "/simulation/couplings", "value": {
                "carry": {"source": "river", "target": bodies, "direction": "two_way", "variables": ["motion", "wrench"]}}},
            {"op": "add", "path": "/graph", "value": {"relations": relations}},
            {"op": "add", "path": "/story", "value": {"semantics": "A calm day; nothing but the stream moves anything.", "beats": beats}},
            {"op": "add", "path": "/shots", "value": shots},
        ]  # fmt: skip

    async def rigid_instance(self) -> str:
        """The instance that moves bodies; build_terrain made it with the ground."""
        solvers = (await self.spec())["simulation"]["solvers"]
        return str(next(n for n, s in solvers.items() if s["engine"] == "mujoco"))

    async def accepted(self) -> bool:
        """From the specification to the verdict; what fails is said."""
        for tool, key in (("place_object", "static_passed"), ("probe_sim", "passed"), ("bake_sim", "passed")):
            data, refused = await self.call(tool, detail="full", **({} if tool == "place_object" else {"wait_s": WAIT_SECONDS}))
            if refused or not data[key]:
                self.say(f"{tool}: {data.get('refused') or _open(data['open_rows'])}")
                return False
            self.say(f"{tool}: {data['counts']['pass']} rows pass")
        data, refused = await self.call("run_checks", scope="acceptance", wait_s=WAIT_SECONDS)
        self.say(data.get("refused") or f"acceptance: {data['says']}, {data['counts']['pass']} rows pass")
        if refused or data["verdict"] != "accepted":
            self.say(_open(data.get("open_rows", [])))
            return False
        return True


async def _session(options: argparse.Namespace, workspace: Path) -> dict[str, Any]:
    from mcp import Client, StdioServerParameters

    started = time.monotonic()
    command = StdioServerParameters(
        command=sys.executable,
        args=["-P", "-m", "worldagent.server", "serve", "--workspace", str(workspace)],
        env=dict(os.environ),
    )
    async with Client(command) as client:
        agent = Ranger(client, "stream", started)
        agent.say(f"prompt: {PROMPT}")
        ready = await agent.settle(options)
        accepted = ready and await agent.accepted()
        found: dict[str, Any] = {"accepted": accepted, "reach_m": round(agent.course.length, 1) if ready else None}
        if accepted and not options.no_render:
            agent.say("rendering the final sequence")
            data, refused = await agent.call("render_shot", kind="final", wait_s=WAIT_SECONDS, samples=options.samples)
            found["final"] = data
            agent.say(data["refused"] if refused else f"film: {data['frames']} frames of {data['width']} x {data['height']}")
        return found | {
            "calls": agent.calls,
            "seconds": round(time.monotonic() - started, 1),
            "world": str(workspace / agent.world),
        }


def run(options: argparse.Namespace) -> dict[str, Any]:
    """One run in a fresh world folder; returns what happened."""
    workspace = Path(options.out).resolve()
    shutil.rmtree(workspace / "stream", ignore_errors=True)
    workspace.mkdir(parents=True, exist_ok=True)
    return asyncio.run(_session(options, workspace))


def options_of(argv: Sequence[str] | None = None) -> argparse.Namespace:
    """The command line; `--full` is a reach of more than 200 m for 20 s."""
    parser = argparse.ArgumentParser(prog="stream", description=PROMPT)
    parser.add_argument("--out", default="demo-out", help="workspace of the world")
    parser.add_argument("--full", action="store_true", help="230 m of the valley for 20 s instead of 44 m for 8 s")
    parser.add_argument("--spacing", type=float, default=SPACING, help="cell of the liquid [m]")
    parser.add_argument("--samples", type=int, default=32, help="of each pixel of the film")
    parser.add_argument("--no-render", action="store_true")
    options = parser.parse_args(argv)
    options.fps, options.beams = 12, len(BEAMS)
    options.size, options.center = ((230.0, 52.0), (0.0, 0.0)) if options.full else (REACH, CENTER)
    options.seconds, options.told = (20.0, 5.0) if options.full else (SECONDS, SECONDS)
    return options


def main(argv: Sequence[str] | None = None) -> int:
    """Exit code 0 when the world was accepted; the last line is one JSON object."""
    found = run(options_of(argv))
    print(json.dumps(found))
    return 0 if found["accepted"] else 1


if __name__ == "__main__":
    sys.exit(main())
