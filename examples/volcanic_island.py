"""A landscape from its prompt to acceptance and pictures, through a real client: `python -m worldagent.examples.volcanic_island`.

The scripted agent first relies on rain alone; the row of the river says that it is too narrow, and the agent mends that from
the row's own numbers. It places the near camera by what `inspect_world(part='terrain')` tells of the land.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Sequence
from typing import Any

from .client_run import WAIT_SECONDS, play
from .domino_run import Agent

__all__ = ["PROMPT", "island_spec", "main", "run"]

PROMPT = "A volcanic island with a crater lake, a river to the sea, and forest on the wet side."
CLAIMS = (
    "A [volcanic island](thing island) with a [crater lake](property lake), a [river to the sea](property river), and [forest](property forest) "
    "[on the wet side](place forest)."
)
EXTENT = 6144.0
"""[m]"""
CRATER = (-250.0, -200.0)
"""Middle of the crater [m]."""
WIND_DEG = 50.0
"""Where the wind comes from, from east towards north."""
WIDTH = 9.0
"""Least width of a river where it is widest [m]: it can be seen from the air."""
MARGIN = 1.2
"""Factor on the width to which a river is widened that is too narrow."""
GROUND, GROUND_AT = 640.0, (850.0, 1650.0)
"""Side and middle of the ground that is cut out, where the valley meets the sea [m]."""
EYE = 12.0
"""Height of the near camera over the bed of the river [m]."""


def _side(sign: int) -> dict[str, Any]:
    """The half of the island on the side that the wind comes from (1), or on the other (-1)."""
    turn = math.radians(WIND_DEG)
    along, across = (sign * math.cos(turn), sign * math.sin(turn)), (-math.sin(turn), math.cos(turn))
    corners = [(250, -2300), (2300, -2300), (2300, 2300), (250, 2300)]
    return {"polygon": [[round(CRATER[k] + u * along[k] + v * across[k]) for k in (0, 1)] for u, v in corners]}


def _land(cells: int) -> dict[str, Any]:
    def rule(order: int, material: str, *where: tuple[str, str, float], **more: float) -> dict[str, Any]:
        return {"order": order, "material": material, "where": [{"field": f, how: v} for f, how, v in where], **more}

    return {
        "extent": [EXTENT, EXTENT],
        "cell": EXTENT / cells,
        "datum": -105,
        "sea_level": 0,
        "seed": 5,
        "zones": {
            "summit": {"label": "the crater and its rim", "center": CRATER, "radius": 600},
            "windward": {"label": "where the rain falls", **_side(1)},
            "leeward": {"label": "in the lee", **_side(-1)},
        },
        "layers": {
            "shield": {"kind": "cone", "radius": 2900, "height": 310, "steepness": 1.0, "irregularity": 0.3, "seed": 4, "order": 1},
            "peak": {"kind": "cone", "center": CRATER, "radius": 1650, "height": 560, "steepness": 1.8, "irregularity": 0.2, "seed": 2, "order": 1},
            "rough": {"kind": "noise", "style": "ridged", "amplitude": 75, "wavelength": 800, "warp": 150, "order": 2, "seed": 3},
            "broad": {"kind": "noise", "style": "fbm", "amplitude": 45, "wavelength": 1800, "octaves": 5, "order": 2, "seed": 8},
            "valley": {"kind": "valley", "line": [[150, 250], [650, 800], [950, 1500], [1500, 2100], [1700, 2700]], "width": 1100,
                       "depth": 110, "fall": 250, "floor": 0.15, "order": 3},
            "crater": {"kind": "crater", "center": CRATER, "radius": 390, "depth": 150, "rim": 20, "floor": 0.35, "breach_deg": 45,
                       "order": 4, "late": True},
        },
        "erosion": {"years": 50000, "steps": 12, "erodibility": 1.2e-5},
        "climate": {"biome": "volcanic-island", "rain": 2.2, "rain_shadow": 0.85, "wind_deg": WIND_DEG, "latitude_deg": 20},
        "hydrology": {"required": ["sea", "lake", "river"]},
        "ground": {
            "dry": rule(1, "dry_grass", ("moisture", "at_most", 0.34), blend=60),
            "wet": rule(1, "loam", ("moisture", "at_least", 0.34), retention=1.0, blend=60),
            "lava": rule(2, "basalt", ("slope", "at_least", 0.75), retention=0.1, blend=30),
            "ash": rule(3, "ash", ("height", "at_least", 560), retention=0.2, blend=80),
            "beach": rule(4, "sand", ("height", "at_most", 6), ("slope", "at_most", 0.3), retention=0.2, blend=20),
        },
        "vegetation": {"density": 0.65},
    }  # fmt: skip


def _material(density: float, *color: float, substance: str = "other") -> dict[str, Any]:
    return {"density": density, "substance": substance, "friction": 0.7, "appearance": {"color": color, "roughness": 0.9}}


def island_spec(cells: int) -> dict[str, Any]:
    """The first specification, with `cells` along each side of the landscape; its ground and shots come later."""
    asked = {
        "lake": ("a lake lies in the crater", {"kind": "landscape_water", "water": "lake", "zone": "summit", "min_depth": 20}),
        "river": (
            "a river runs to the sea",
            {"kind": "landscape_water", "water": "river", "ends_in": "sea", "min_length": 500, "min_width": WIDTH},
        ),
        "forest": (
            "the windward side has at least twice the trees",
            {"kind": "landscape_field", "field": "tree_density", "zone": "windward", "relative_to": "leeward", "min": 2},
        ),
    }
    return {
        "title": "Volcanic island",
        "materials": {
            "basalt": _material(2900, 0.055, 0.05, 0.047, substance="stone"),
            "sand": _material(1600, 0.30, 0.25, 0.17),
            "loam": _material(1400, 0.075, 0.11, 0.03),
            "dry_grass": _material(1400, 0.15, 0.115, 0.055),
            "ash": _material(1500, 0.13, 0.115, 0.10),
        },
        "terrains": {"island": _land(cells)},
        "story": {
            "semantics": "An island under a steady trade wind; nothing moves.",
            "requirements": {n: {"text": text, "predicate": {**p, "terrain": "island"}} for n, (text, p) in asked.items()},
        },
        "look": {"width": 1280, "height": 720, "sun_elevation_deg": 35, "sun_azimuth_deg": 5},
        "simulation": {"frames": 2, "fps": 24},
    }


class Islander(Agent):
    """The agent of this world."""

    async def settle(self, cells: int) -> bool:
        """Declare and build the land, and choose where the cameras stand."""
        data, refused = await self.call("edit_spec", prompt=PROMPT, spec=island_spec(cells), claims=CLAIMS)
        if refused:
            self.say(data["refused"])
            return False
        return await self.build() and await self._shots()

    async def build(self, **more: Any) -> bool:
        """Build the landscape and cut its ground."""
        data, refused = await self.call(
            "build_terrain", terrain="island", size=[GROUND, GROUND], center=GROUND_AT, cells=96, wait_s=WAIT_SECONDS, **more
        )
        if refused:
            self.say(data["refused"])
            return False
        self.say(f"land: {data['features']}")
        return True

    async def _shots(self) -> bool:
        """One view of the whole island, and one from low over the mouth of the widest river, upstream."""
        told, refused = await self.call("inspect_world", part="terrain")
        if refused:
            self.say(told["refused"])
            return False
        mouth = next(w["to"] for w in told["waters"] if w.get("ends_in") == "sea")
        found, refused = await self.call("inspect_world", part="terrain", find="river", points=[mouth], size=70)
        if refused:
            self.say(found["refused"])
            return False
        here, there = found["places"][0], found["places"][1]
        shots = {
            "air": {"frames": [0, 0], "subjects": ["ground"],
                    "keys": {"a": {"frame": 0, "position": [1450, 3150, 1350], "target": [40, 200, 130], "fov_deg": 40}}},
            "river": {"frames": [1, 1], "subjects": ["ground"],
                      "keys": {"a": {"frame": 1, "position": [*here["at"], round(here["bed"] + EYE, 2)],
                                     "target": [*there["at"], round(max(there["bed"], here["bed"]) + EYE, 2)], "fov_deg": 55}}},
        }  # fmt: skip
        data, refused = await self.call("edit_spec", patch=[{"op": "add", "path": "/shots", "value": shots}])
        if refused:
            self.say(data["refused"])
            return False
        self.say(f"the near camera hangs over {here['at']}, in {here['kind']} {here['reach']}")
        return True

    async def feed(self, row: dict[str, Any]) -> bool:
        """The river is too narrow: its width goes with the root of its discharge, so a spring in the crater gives what it lacks."""
        told = row["evidence"]["explanation"]
        more = round((MARGIN * WIDTH / 7.4) ** 2, 2)
        hypothesis = (
            f"{row['id']}: too little water; a width of {WIDTH:g} m needs about {more:g} m^3/s, from a spring under the lake"
        )
        self.say(f"  {told}")
        self.say(f"  {hypothesis}")
        spring = {"position": CRATER, "discharge": more}
        patch = [{"op": "add", "path": "/terrains/island/hydrology/inflows/spring", "value": spring}]
        data, refused = await self.call("edit_spec", patch=patch, hypothesis=hypothesis)
        if refused:
            self.say(data["refused"])
            return False
        self.repairs.append({"row": row["id"], "hypothesis": hypothesis})
        return await self.build(hypothesis=hypothesis)

    async def work_on_land(self, cells: int) -> bool:
        """The whole loop up to acceptance."""
        if not await self.settle(cells):
            return False
        for tool, key in (("place_object", "static_passed"), ("probe_sim", "passed"), ("bake_sim", "passed")):
            data = await self._step(tool, key)
            if data is None:
                return False
        data, refused = await self.call("run_checks", scope="acceptance", wait_s=WAIT_SECONDS)
        self.say(f"acceptance: {data.get('refused') or data['says']}")
        return not refused and data["verdict"] == "accepted"

    async def _step(self, tool: str, key: str) -> dict[str, Any] | None:
        while True:
            waiting = {} if tool == "place_object" else {"wait_s": WAIT_SECONDS}
            data, refused = await self.call(tool, detail="full", **waiting)
            if refused:
                self.say(f"{tool} refused: {data['refused'][:600]}")
                return None
            self.say(f"{tool}: {data['counts']['pass']} rows pass, {data['counts']['fail']} fail")
            short = [r for r in data["open_rows"] if r["id"].endswith(":river") and r["status"] == "fail"]
            if not short and data[key]:
                return data
            if not short or len(self.repairs) >= 4 or not await self.feed(short[0]):
                self.say(json.dumps(data["open_rows"])[:800])
                return None


async def _work(agent: Islander, options: argparse.Namespace) -> dict[str, Any]:
    accepted = await agent.work_on_land(options.cells)
    found: dict[str, Any] = {"accepted": accepted, "repairs": agent.repairs, "pictures": []}
    for field in ("hillshade", "tree_density", "accumulation") if accepted else ():
        data, refused = await agent.call("render_shot", kind="field", field=field)
        found["pictures"] += [] if refused else [data["file"]]
    return found


def run(options: argparse.Namespace) -> dict[str, Any]:
    """One run in a fresh world folder; returns what happened."""
    return play(Islander, "volcanic_island", PROMPT, options, lambda agent: _work(agent, options))


def main(argv: Sequence[str] | None = None) -> int:
    """Exit code 0 when the world was accepted; the last line is one JSON object."""
    parser = argparse.ArgumentParser(prog="volcanic_island", description=PROMPT)
    parser.add_argument("--out", default="demo-out", help="workspace of the world")
    parser.add_argument("--cells", type=int, default=256, help="cells along each side of the landscape")
    parser.add_argument("--full", action="store_true", help="1024 cells a side")
    parser.add_argument("--samples", type=int, default=32, help="samples per pixel of the final pictures")
    parser.add_argument("--no-render", action="store_true")
    options = parser.parse_args(argv)
    options.cells = 1024 if options.full else options.cells
    found = run(options)
    print(json.dumps(found))
    return 0 if found["accepted"] else 1


if __name__ == "__main__":
    sys.exit(main())
