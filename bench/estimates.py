"""Benchmark `estimates`: what a probe and a bake took over what their replies said beforehand.

The worlds of the short evaluation set go through the tools in one new workspace, in the order of their names. None of the rates was
measured on them. A factor is the larger of told over taken and taken over told; those of probes are told by usual rates and the pace of
the probes before, those of bakes by their own probe.
"""

from __future__ import annotations

import json
import statistics
import sys
import tempfile
import time
from importlib.resources import files
from pathlib import Path
from typing import Any

from ..execution import Job, JobStore
from ..tools.bake_sim import bake_sim
from ..tools.edit_spec import edit_spec
from ..tools.place_object import place_object
from ..tools.probe_sim import probe_sim
from ..workflow.context import ToolContext

__all__ = ["run"]

LOOK_S = 0.2
LONGEST_S = 1800.0
GATE = 1.5
"""Largest median factor that is asked for."""


def run() -> dict[str, Any]:
    """Median factors of probes and bakes, and the seconds that were told and taken by world."""
    folder = files("worldagent.bench.evaluation") / "solutions" / "small"
    documents = {
        p.name.removesuffix(".json"): json.loads(p.read_text(encoding="utf-8"))
        for p in folder.iterdir()
        if p.name.endswith(".json")
    }
    with tempfile.TemporaryDirectory() as place:
        workspace = Path(place)
        context = ToolContext(workspace, JobStore(workspace), progress=lambda *_: None, cancelled=lambda: False)
        found = {name: _world(context, name, documents[name]["spec"]) for name in sorted(documents) if "spec" in documents[name]}
    probes, bakes = ([w[kind] for w in found.values() if kind in w] for kind in ("probe", "bake"))
    return {
        "gate": GATE,
        "probes": len(probes),
        "median_factor_probe": _median(probes),
        "bakes": len(bakes),
        "median_factor_bake": _median(bakes),
        "worlds": found,
    }


def _median(pairs: list[tuple[float, float]]) -> float | None:
    """Median of the larger ratio of each pair."""
    return round(statistics.median(max(a / b, b / a) for a, b in pairs), 2) if pairs else None


def _world(context: ToolContext, name: str, spec: dict[str, Any]) -> dict[str, Any]:
    """Told and taken seconds of the probe and of the bake; why there are none."""
    edit_spec(context, world=name, prompt=spec["prompt"], spec={k: v for k, v in spec.items() if k != "prompt"})
    if not place_object(context, world=name).data["static_passed"]:
        return {"left_out": "static rows fail"}
    found: dict[str, Any] = {}
    for kind, start in (("probe", probe_sim), ("bake", bake_sim)):
        told = start(context, world=name, wait_s=0.0).data
        job = _ended(context.jobs, told["job_id"])
        if job.state != "done" or job.result is None or not job.result["passed"] or not told.get("estimate_s"):
            found["left_out"] = f"{kind}: {job.state} {job.error or ''} passed {(job.result or {}).get('passed')}"
            break
        found[kind] = (round(float(told["estimate_s"]), 1), round((job.finished or 0.0) - (job.started or 0.0), 1))
    print(f"{name}: {found}", file=sys.stderr, flush=True)
    return found


def _ended(jobs: JobStore, name: str) -> Job:
    """The job once it has ended, or as it is after `LONGEST_S`."""
    deadline = time.monotonic() + LONGEST_S
    while not (job := jobs.get(name)).ended and time.monotonic() < deadline:
        time.sleep(LOOK_S)
    return job
