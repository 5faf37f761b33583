"""A landscape from its prompt to acceptance and pictures, through a real client: `python -m worldagent.examples.volcanic_island`.

The scripted agent first asks for the rain of its biome; the row of the river says that it is too narrow, and the agent mends
that from the row's own numbers. Cameras are placed from what the server tells of the land.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import os
import shutil
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from .domino_run import Agent

__all__ = ["PROMPT", "island_spec", "main", "run"]

PROMPT = "A volcanic island with a crater lake, a river to the sea, and forest on the wet side."
EXTENT = 9000.0
"""[m]"""
HALF = 3800.0
WIDTH = 2.0
"""What is called a river here is at least so wide where it is widest [m]."""
RAIN_STEP = 1.6
WAIT_SECONDS = 25.0


def island_spec(cells: int) -> dict[str, Any]:
    """The first specification, with `cells` along each side of the landscape; its ground and shots come later."""

    def side(east: float) -> dict[str, Any]:
        near, far = 200 * east, HALF * east
        return {"polygon": [[near, -HALF], [far, -HALF], [far, HALF], [near, HALF]]}

    land = {
        "extent": [EXTENT, EXTENT],
        "cell": EXTENT / cells,
        "datum": -160,
        "sea_level": 0,
        "seed": 4,
        "zones": {
            "summit": {"label": "the crater and its rim", "center": [0, 0], "radius": 800},
            "windward": {"label": "where the rain falls", **side(1)},
            "leeward": {"label": "in the lee", **side(-1)},
        },
        "layers": {
            "mountain": {"kind": "cone", "radius": 3900, "height": 1350, "steepness": 1.5, "irregularity": 0.25, "seed": 3, "order": 1},
            "rough": {"kind": "noise", "style": "ridged", "amplitude": 150, "wavelength": 1900, "warp": 160, "order": 2},
            "crater": {"kind": "crater", "radius": 560, "depth": 210, "rim": 25, "late": True, "order": 3},
        },
        "erosion": {"years": 80000, "steps": 8, "erodibility": 2e-5},
        "climate": {"biome": "volcanic-island", "rain": 2.0, "rain_shadow": 0.9, "wind_deg": 0, "latitude_deg": 20},
        "hydrology": {"required": ["sea", "lake", "river"]},
        "vegetation": {"forms": ["tree"], "density": 0.12},
    }  # fmt: skip
    asked = {
        "lake": ("a lake lies in the crater", {"kind": "landscape_water", "water": "lake", "zone": "summit", "min_depth": 20}),
        "river": (
            "a river runs to the sea",
            {"kind": "landscape_water", "water": "river", "ends_in": "sea", "min_length": 1000, "min_width": WIDTH},
        ),
        "forest": (
            "the windward side has at least twice the trees",
            {"kind": "landscape_field", "field": "tree_density", "zone": "windward", "relative_to": "leeward", "min": 2},
        ),
    }
    return {
        "title": "Volcanic island",
        "clauses": {
            "c1": {"met_by": ["/terrains/island", "/story/requirements/lake"]},
            "c2": {"met_by": ["/story/requirements/river"]},
            "c3": {"met_by": ["/story/requirements/forest"]},
        },
        "materials": {"basalt": {"density": 2900, "substance": "stone", "friction": 0.7}},
        "terrains": {"island": land},
        "story": {
            "semantics": "An island under a steady east wind; nothing moves.",
            "requirements": {n: {"text": text, "predicate": {**p, "terrain": "island"}} for n, (text, p) in asked.items()},
        },
        "simulation": {"frames": 2, "fps": 24},
    }


class Islander(Agent):
    """The agent of this world."""

    async def settle(self, cells: int) -> bool:
        """Build the land; while it lacks what the prompt asks for, mend that from the row."""
        data, refused = await self.call("edit_spec", prompt=PROMPT, spec=island_spec(cells))
        if refused:
            self.say(data["refused"])
            return False
        built, refused = await self.call("build_terrain", terrain="island", size=[1500, 1500], cells=96, wait_s=WAIT_SECONDS)
        if refused:
            self.say(built["refused"])
            return False
        self.land = built
        self.say(f"land: {built['summary']}")
        return await self._shots()

    async def _shots(self) -> bool:
        """One view of the whole island, and one from the sea towards where the widest river comes out."""
        mouth = next(r["to"] for r in self.land["rivers"] if r["ends_in"] == "sea")
        out = [mouth[0] * 1.12, mouth[1] * 1.12]
        top = self.land["height_range"][1]
        shots = {
            "air": {"frames": [0, 0], "subjects": ["ground"],
                    "keys": {"a": {"frame": 0, "position": [5600, -4900, 3100], "target": [100, 0, 200], "fov_deg": 38}}},
            "coast": {"frames": [1, 1], "subjects": ["ground"],
                      "keys": {"a": {"frame": 1, "position": [*out, 25], "target": [0, 0, 0.6 * top], "fov_deg": 50}}},
        }  # fmt: skip
        data, refused = await self.call("edit_spec", patch=[{"op": "add", "path": "/shots", "value": shots}])
        if refused:
            self.say(data["refused"])
        return not refused

    async def rain_more(self, row: dict[str, Any]) -> bool:
        """The river is too narrow: its width goes with the root of its discharge, and that with the rain."""
        spec = await self.spec()
        now = spec["terrains"]["island"]["climate"]["rain"]
        more = round(now * RAIN_STEP, 2)
        hypothesis = f"{row['id']}: too little water; width grows with the root of the rain, so {now:g} -> {more:g} m a year"
        self.say(f"  {hypothesis}")
        patch = [{"op": "replace", "path": "/terrains/island/climate/rain", "value": more}]
        data, refused = await self.call("edit_spec", patch=patch, hypothesis=hypothesis)
        if not refused:
            data, refused = await self.call(
                "build_terrain", terrain="island", size=[1500, 1500], cells=96, wait_s=WAIT_SECONDS, hypothesis=hypothesis
            )
        if refused:
            self.say(data["refused"])
            return False
        self.land = data
        self.repairs.append({"row": row["id"], "hypothesis": hypothesis})
        return True

    async def work_on_land(self, cells: int) -> bool:
        """The whole loop up to acceptance."""
        if not await self.settle(cells):
            return False
        for tool, key in (("place_object", "static_passed"), ("probe_sim", "passed"), ("bake_sim", "passed")):
            data = await self._step(tool, key)
            if data is None:
                return False
        data, refused = await self.call("run_checks", scope="acceptance", wait_s=WAIT_SECONDS)
        self.say(f"acceptance: {data.get('refused') or data['summary']}")
        return not refused and data["verdict"] == "accepted"

    async def _step(self, tool: str, key: str) -> dict[str, Any] | None:
        while True:
            waiting = {} if tool == "place_object" else {"wait_s": WAIT_SECONDS}
            data, refused = await self.call(tool, detail="full", **waiting)
            if refused:
                self.say(f"{tool} refused: {data['refused'][:600]}")
                return None
            self.say(f"{tool}: {data['summary']}")
            short = [r for r in data["open_rows"] if r["id"].endswith(":river") and r["status"] == "fail"]
            if not short and data[key]:
                return data
            if not short or len(self.repairs) >= 4 or not await self.rain_more(short[0]):
                self.say(json.dumps(data["open_rows"])[:800])
                return None


async def _session(options: argparse.Namespace, workspace: Path) -> dict[str, Any]:
    from mcp import Client, StdioServerParameters

    started = time.monotonic()
    command = StdioServerParameters(
        command=sys.executable,
        args=["-P", "-m", "worldagent.server", "serve", "--workspace", str(workspace)],
        env=dict(os.environ),
    )
    async with Client(command) as client:
        agent = Islander(client, "volcanic_island", started)
        agent.say(f"prompt: {PROMPT}")
        accepted = await agent.work_on_land(options.cells)
        found: dict[str, Any] = {"accepted": accepted, "repairs": agent.repairs, "pictures": []}
        for field in ("hillshade", "tree_density", "accumulation") if accepted else ():
            data, refused = await agent.call("render_shot", kind="field", field=field)
            found["pictures"] += [] if refused else [data["file"]]
        if accepted and not options.no_render:
            agent.say("rendering the final pictures")
            data, refused = await agent.call("render_shot", kind="final", wait_s=WAIT_SECONDS, samples=options.samples)
            found["final"] = data
            agent.say(data["refused"] if refused else f"pictures: {data.get('frames')}")
        return found | {
            "calls": agent.calls,
            "seconds": round(time.monotonic() - started, 1),
            "world": str(workspace / agent.world),
        }


def run(options: argparse.Namespace) -> dict[str, Any]:
    """One run in a fresh world folder; returns what happened."""
    workspace = Path(options.out).resolve()
    shutil.rmtree(workspace / "volcanic_island", ignore_errors=True)
    workspace.mkdir(parents=True, exist_ok=True)
    return asyncio.run(_session(options, workspace))


def main(argv: Sequence[str] | None = None) -> int:
    """Exit code 0 when the world was accepted; the last line is one JSON object."""
    parser = argparse.ArgumentParser(prog="volcanic_island", description=PROMPT)
    parser.add_argument("--out", default="demo-out", help="workspace of the world")
    parser.add_argument("--cells", type=int, default=256, help="cells along each side of the landscape")
    parser.add_argument("--samples", type=int, default=32, help="samples per pixel of the final pictures")
    parser.add_argument("--no-render", action="store_true")
    found = run(parser.parse_args(argv))
    print(json.dumps(found))
    return 0 if found["accepted"] else 1


if __name__ == "__main__":
    sys.exit(main())
