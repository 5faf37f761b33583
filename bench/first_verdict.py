"""Benchmark `first-verdict`: how long after the start of its probe a wrong edit is known to be wrong, and what judging a right world takes.

Thirty-two wrong edits of nine recorded worlds (`wrong_edits.py`) go through the tools; the time counts from the start of the probe's job to the first row that fails for
good, as its progress tells it, or to the end of the probe. An edit that the audit or a static row refuses, or that the probe passes, is left out and named.
"""

from __future__ import annotations

import json
import statistics
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from ..execution import Job, JobStore
from ..server.skill_files import SKILLS
from ..tools.edit_spec import edit_spec
from ..tools.place_object import place_object
from ..tools.probe_sim import probe_sim
from ..workflow.context import ToolContext
from ..workflow.session import Session
from ..worlds.errors import WorldAgentError
from ..worlds.folder import WorldFolder
from .wrong_edits import EDITS, WORLDS, WrongEdit

__all__ = ["run"]

TELLS = "fails already"
LOOK_S = 0.1
LONGEST_S = 900.0


def run() -> dict[str, Any]:
    """Times of wrong edits [s], and judging over simulating of right worlds."""
    with tempfile.TemporaryDirectory() as folder:
        right = [_right(Path(folder) / "right", name) for name in WORLDS]
        wrong, left_out = [], []
        for k, edit in enumerate(EDITS):
            found = _wrong(Path(folder) / "wrong", f"w{k}", edit)
            if isinstance(found, str):
                left_out.append(f"{edit.world}, {edit.wrong}: {found}")
            else:
                wrong.append(found)
            print(f"{edit.world}, {edit.wrong}: {found}", file=sys.stderr)
    return {
        "worlds": len(wrong),
        "median_wrong_s": _median([w["seconds"] for w in wrong]),
        "slowest_wrong_s": max((w["seconds"] for w in wrong), default=None),
        "first_false_frame_share": sorted(round(w["frame"] / w["of"], 2) for w in wrong),
        "median_right_over_simulation": _median([r["rows"] for r in right]),
        "median_right_with_reruns": _median([r["whole"] for r in right]),
        "right": {r["world"]: {k: r[k] for k in ("simulated_s", "rows", "whole")} for r in right},
        "left_out": left_out,
    }


def _median(values: list[float]) -> float | None:
    return round(statistics.median(values), 2) if values else None


def _context(workspace: Path) -> ToolContext:
    workspace.mkdir(exist_ok=True)
    return ToolContext(workspace, JobStore(workspace), progress=lambda *_: None, cancelled=lambda: False)


def _made(context: ToolContext, world: str, name: str, values: dict[str, Any]) -> str:
    """Make a recorded world with other values and build it; what refuses it, or nothing."""
    spec = json.loads((SKILLS / f"{name}.json").read_text())
    prompt = spec.pop("prompt")
    edit_spec(context, world=world, prompt=prompt, spec=spec)
    if values:
        patch = [{"op": "replace" if p.rpartition("/")[2].isdigit() else "add", "path": p, "value": v} for p, v in values.items()]
        try:
            found = edit_spec(context, world=world, patch=patch).data
        except WorldAgentError as error:
            return f"refused: {error}"
        if not found["audit"]["passed"]:
            return f"the audit fails: {[r['id'] for r in found['audit']['open_rows']]}"
    found = place_object(context, world=world).data
    return "" if found["static_passed"] else f"static rows fail: {[r['id'] for r in found['open_rows']][:3]}"


def _probed(context: ToolContext, world: str) -> tuple[Job, float | None]:
    """The ended job of a probe, and when its progress told the first failure [s after its start]."""
    job = context.jobs.get(probe_sim(context, world=world, wait_s=0.0).data["job_id"])
    told, deadline = None, time.monotonic() + LONGEST_S
    while not job.ended and time.monotonic() < deadline:
        time.sleep(LOOK_S)
        job = context.jobs.get(job.id)
        if told is None and TELLS in (job.message or "") and job.started:
            told = time.time() - job.started
    return job, told


def _wrong(workspace: Path, world: str, edit: WrongEdit) -> dict[str, Any] | str:
    """Time and frame of the decisive row of a wrong edit; why there is none."""
    context = _context(workspace)
    if refused := _made(context, world, edit.world, edit.values):
        return refused
    job, told = _probed(context, world)
    if job.state != "done" or job.result is None:
        return f"the probe ended as {job.state}: {job.error}"
    if job.result["passed"]:
        return "the probe passes"
    rows = [r for r in Session.at(WorldFolder.of(workspace, world)).ledger.rows() if r.status == "fail" and r.mandatory]
    frames = [r.first_failing_frame for r in rows if r.first_failing_frame is not None]
    whole = (job.finished or time.time()) - (job.started or 0.0)
    spec = Session.at(WorldFolder.of(workspace, world)).spec
    return {
        "seconds": round(whole if told is None else told, 1),
        "whole_s": round(whole, 1),
        "frame": min(frames, default=spec.simulation.frames - 1),
        "of": spec.simulation.frames - 1,
        "row": rows[0].id,
    }


def _right(workspace: Path, name: str) -> dict[str, Any]:
    """Judging of a right world, without and with reruns, over its simulation alone."""
    context, world = _context(workspace), name.replace("/", "_").replace("-", "_")
    refused = _made(context, world, name, {})
    job, _ = _probed(context, world)
    if refused or job.state != "done" or job.result is None or not job.result["passed"]:
        raise RuntimeError(f"{name}: {refused or job.error or 'the probe of a recorded world fails'}")
    (probed,) = Session.at(WorldFolder.of(workspace, world)).ledger.freezes()
    simulated, judged = float(probed["detail"]["simulated_s"]), float(probed["detail"]["judged_s"])
    whole = (job.finished or 0.0) - (job.started or 0.0)
    print(f"{name}: simulated {simulated} s, judged {judged} s, {whole:.1f} s in all", file=sys.stderr)
    rows = {"rows": round((simulated + judged) / simulated, 2), "whole": round(whole / simulated, 2)}
    return {"world": name, "simulated_s": simulated, **rows}
