"""The demo: a scripted agent, as a real MCP client over stdio, takes one prompt to an accepted world and its film.

Its first specification carries three flaws drawn by seed (`flaws.py`); it finds and mends them from the server's rows
alone (`repair.py`).
"""

from __future__ import annotations

import argparse
import asyncio
import json
import os
import shutil
import sys
import time
from pathlib import Path
from typing import Any

from .domino_world import PROMPT, domino_spec
from .flaws import plant
from .repair import missed_carrier, propose

__all__ = ["run", "show"]

MAX_EDITS = 24
WAIT_SECONDS = 20.0


class Agent:
    """One MCP session and what the agent knows of the world."""

    def __init__(self, client: Any, world: str, started: float) -> None:
        self.client, self.world, self.started = client, world, started
        self.calls = 0
        self.tried: set[str] = set()
        self.repairs: list[dict[str, Any]] = []

    def say(self, text: str) -> None:
        """One line of progress."""
        print(f"[{time.monotonic() - self.started:6.1f} s] {text}", flush=True)

    async def call(self, name: str, **arguments: Any) -> tuple[dict[str, Any], bool]:
        """Call a tool; (data, whether it was refused). Waits for jobs, showing their progress."""
        self.calls += 1
        result = await self.client.call_tool(name, {"world": self.world, **arguments})
        text = next((b.text for b in result.content if b.type == "text"), "")
        if result.is_error:
            return {"refused": text}, True
        data: dict[str, Any] = result.structured_content or json.loads(text)
        while data.get("state") in ("queued", "running"):
            self.say(f"  {name}: {100 * (data.get('progress') or 0):3.0f} %  {data.get('message', '')}")
            self.calls += 1
            result = await self.client.call_tool("job", {"action": "wait", "job_id": data["job_id"], "wait_s": WAIT_SECONDS})
            if result.is_error:
                return {"refused": next(b.text for b in result.content if b.type == "text")}, True
            answer = result.structured_content
            data = answer["result"] if answer["state"] == "done" else answer
            if answer["state"] in ("failed", "cancelled", "lost"):
                return {"refused": json.dumps(answer.get("error") or answer["state"])}, True
        return data, False

    async def spec(self) -> dict[str, Any]:
        """The present specification: as a resource, since a tool's reply shows a large one in pages."""
        self.calls += 1
        found = await self.client.read_resource(f"worldagent://worlds/{self.world}/spec")
        value: dict[str, Any] = json.loads(found.contents[0].text)
        return value

    async def landing(self, body: str, ground: str) -> list[float] | None:
        """Where `body` first touched `ground`, as the server's contact events tell."""
        data, refused = await self.call("inspect_world", part="events", entities=[body])
        events = [] if refused else [e for e in data["events"] if {e["a"], e["b"]} == {body, ground}]
        point: list[float] | None = events[0]["point"] if events else None
        return point

    async def mend(self, rows: list[dict[str, Any]], stage: str) -> bool:
        """Propose one edit for the open rows and make it; False when there is none."""
        for row in rows[:4]:
            why = row.get("evidence", {})
            self.say(
                f"  {row['id']}: {row['status']}; {why.get('explanation') or why.get('problems') or '' if isinstance(why, dict) else why[:160]}"
            )
        spec = await self.spec()
        landings = {}
        for row in rows:
            missed = missed_carrier(spec, row)
            point = await self.landing(*missed) if missed is not None else None
            if point is not None:
                landings[row["id"]] = point
        edit = propose(spec, rows, self.tried, landings)
        if edit is None or len(self.repairs) >= MAX_EDITS:
            self.say("  no repair known for these rows")
            return False
        self.tried.add(json.dumps(edit.patch))
        self.say(f"  edit of {edit.group}: {edit.hypothesis}")
        data, refused = await self.call("edit_spec", patch=edit.patch, hypothesis=edit.hypothesis)
        if refused:
            self.say(f"  refused: {data['refused'][:300]}")
        self.repairs.append(
            {"stage": stage, "row": edit.row, "group": edit.group, "hypothesis": edit.hypothesis, "refused": refused}
        )
        return True

    async def specify(self, spec: dict[str, Any]) -> bool:
        """Create the world and mend it until its audit passes."""
        data, refused = await self.call("edit_spec", prompt=PROMPT, spec=spec)
        if refused:
            self.say(data["refused"])
            return False
        return await self._until(lambda: self.call("run_checks", scope="audit", detail="full"), "passed", "audit")

    async def _until(self, step: Any, key: str, stage: str) -> bool:
        """Repeat a step and mend what it finds until its `key` is true."""
        while True:
            data, refused = await step()
            if refused:
                self.say(f"{stage} refused: {data['refused'][:600]}")
                return False
            if data[key] is True or data[key] == "accepted":
                self.say(f"{stage}: {data['counts']['pass']} rows pass")
                return True
            # What only motion can tell is unverified at frame 0 and no reason to edit.
            rows = [
                r
                for r in data["open_rows"]
                if r.get("mandatory", True) and (stage != "static" or (r["status"] == "fail" and r["check"] != "shots"))
            ]
            self.say(f"{stage}: {data['counts']['fail']} rows fail, {data['counts']['unverified']} unverified")
            if not await self.mend(rows, stage):
                return False

    async def _probed(self) -> bool | None:
        """True if the probe passes, False once an edit answers what it finds, None where no edit does.

        The first failure ends a probe that would take long; where that tells too little for an edit, the other rows are looked at too.
        """
        stopped = False
        while True:
            more = {"stop_at": "never"} if stopped else {}
            data, refused = await self.call("probe_sim", wait_s=WAIT_SECONDS, detail="full", **more)
            if refused:
                self.say(f"probe refused: {data['refused'][:600]}")
                return None
            if data["passed"]:
                self.say(f"probe: {data['counts']['pass']} rows pass, settings frozen as {data['freeze']}")
                return True
            self.say(f"probe: {data['counts']['fail']} rows fail, {data['counts']['unverified']} unverified")
            if await self.mend([r for r in data["open_rows"] if r.get("mandatory", True)], "probe"):
                return False
            if stopped or not data.get("stopped_by"):
                return None
            stopped = True

    async def work(self, spec: dict[str, Any]) -> bool:
        """The whole loop up to acceptance."""
        if not await self.specify(spec):
            return False
        for _ in range(MAX_EDITS):
            if not await self._until(lambda: self.call("place_object", detail="full"), "static_passed", "static"):
                return False
            passed = await self._probed()
            if passed is None:
                return False
            if passed:
                break
        data, refused = await self.call("bake_sim", wait_s=WAIT_SECONDS)
        if refused or not data["passed"]:
            self.say(f"bake: {data.get('refused') or data['open_rows'][:3]}")
            return False
        self.say(f"bake: {data['frames']} frames, {data['counts']['pass']} rows pass")
        data, refused = await self.call("run_checks", scope="acceptance", wait_s=WAIT_SECONDS)
        if not refused and any("scope='full'" in row.get("why", "") for row in data["open_rows"]):
            # A busy machine: plates took longer than a tenth of the bake.
            await self.call("run_checks", scope="full", wait_s=WAIT_SECONDS)
            data, refused = await self.call("run_checks", scope="acceptance", wait_s=WAIT_SECONDS)
        if refused or data["verdict"] != "accepted":
            self.say(f"acceptance: {data.get('refused') or data['open_rows'][:3]}")
            return False
        same = sum(bool(r["identical"]) for r in data["replayed"])
        self.say(
            f"acceptance: {data['says']}, {data['counts']['pass']} rows pass, {same} of {len(data['replayed'])} replayed intervals identical"
        )
        return True


async def _session(options: argparse.Namespace, workspace: Path) -> dict[str, Any]:
    from mcp import Client, StdioServerParameters

    spec = domino_spec()
    planted = plant(spec, options.seed, options.flaws)
    started = time.monotonic()
    command = StdioServerParameters(
        command=sys.executable,
        args=["-P", "-m", "worldagent.server", "serve", "--workspace", str(workspace)],
        env=dict(os.environ),
    )
    async with Client(command) as client:
        agent = Agent(client, "domino_run", started)
        agent.say(f"prompt: {PROMPT}")
        accepted = await agent.work(spec)
        found: dict[str, Any] = {"accepted": accepted, "seed": options.seed, "planted": planted, "repairs": agent.repairs}
        if accepted and not options.no_render:
            size = {"width": 1920, "height": 1080, "samples": 64} if options.final else {}
            agent.say("rendering the final sequence")
            data, refused = await agent.call("render_shot", kind="final", wait_s=WAIT_SECONDS, **size)
            found["final"] = data
            if refused:
                agent.say(data["refused"])
            else:
                agent.say(f"film: {data['frames']} frames of {data['width']} x {data['height']}, {data['codec']}")
            for kind in ("contact_sheet", "ledger"):
                result = await client.call_tool("render_shot", {"world": agent.world, "kind": kind})
                text = json.loads(next(b.text for b in result.content if b.type == "text"))
                found[kind] = text["file"]
        found |= {"calls": agent.calls, "seconds": round(time.monotonic() - started, 1), "world": str(workspace / agent.world)}
        return found


def run(options: argparse.Namespace) -> dict[str, Any]:
    """One demo run in a fresh workspace; returns what happened."""
    workspace = Path(options.out).resolve()
    if (workspace / "domino_run").exists():
        shutil.rmtree(workspace / "domino_run")
    workspace.mkdir(parents=True, exist_ok=True)
    return asyncio.run(_session(options, workspace))


def show(options: argparse.Namespace) -> int:
    """Run the demo and print where everything is; 0 when the world was accepted and filmed."""
    found = run(options)
    root = Path(found["world"])
    (root.parent / "demo.json").write_text(json.dumps(found, indent=1))
    print()
    print(f"flaws planted (seed {options.seed}):")
    for name, text in found["planted"].items():
        print(f"  {name}: {text}")
    print("repairs, from the rows alone:")
    for repair in found["repairs"]:
        print(f"  {repair['row']}: {repair['hypothesis']}{' (refused)' if repair['refused'] else ''}")
    print(f"accepted: {found['accepted']}   calls: {found['calls']}   seconds: {found['seconds']}")
    print(f"world folder         {root}")
    print(f"requirements matrix  {root / 'ledger.sqlite'}  (worldagent://worlds/domino_run/report)")
    if "final" in found and "video" in found["final"]:
        print(f"video                {root / found['final']['video']}")
        print(f"contact sheet        {root / found['contact_sheet']}")
        print(f"ledger plots         {root / found['ledger']}")
    return 0 if found["accepted"] and (options.no_render or "video" in found["final"]) else 1
