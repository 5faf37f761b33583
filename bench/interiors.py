"""Benchmark `interiors`: flats of six furnished rooms, from their list to the static verdict.

    worldagent bench interiors
    python -P -m worldagent.bench.interiors 5        # the first five flats alone
    python -P -m worldagent.bench.interiors 1 121    # and 5 s of simulation of each

Flats are fixed as data: `ROOMS`, seeds 0, 1, 2 ... Counted: static rows that do not pass, things without a place, things and generators by
room, seconds. With a number of frames each is simulated: things that are further than 5 mm or 1 degree from their place, and overlaps, at
the last frame. SceneSmith (arXiv:2602.09153) has 71 objects a room, about 2 % of them colliding, 96 % standing.
"""

from __future__ import annotations

import json
import math
import statistics
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from ..construction import build_world
from ..construction.interiors.build import build_interior
from ..simulation.schedule import run_frames
from ..verifiers.checks import run_checks
from ..workflow.creation import create
from ..workflow.interiors import interior_operations
from ..workflow.session import Session
from ..worlds.candidate import Candidate
from ..worlds.patch import apply_patch
from ..worlds.spec import Interior

__all__ = ["ROOMS", "run"]

FLATS = 100
ROOMS: dict[str, dict[str, Any]] = {
    "hall": {"kind": "hall", "doors": ["outside"]},
    "living": {"kind": "living", "doors": ["hall"]},
    "kitchen": {"kind": "kitchen", "doors": ["hall", "living"]},
    "bedroom": {"kind": "bedroom", "doors": ["hall"]},
    "study": {"kind": "study", "doors": ["hall"]},
    "bath": {"kind": "bathroom", "doors": ["hall"]},
}
GAP = 1e-3
"""[m] Two collision skins at the default."""
MOVED, TURNED = 5e-3, math.radians(1.0)
"""[m], [rad] How far a thing that stands may be from its place."""


def run(*, flats: int = FLATS, frames: int = 0) -> dict[str, Any]:
    """Figures of the first flats, see the module."""
    found = [_flat(seed, frames) for seed in range(flats)]
    rooms = [r for f in found for r in f["rooms"].values()]
    result: dict[str, Any] = {
        "flats": flats,
        "flats_whose_static_rows_all_pass": sum(not f["failing"] for f in found),
        "failing_rows": sorted({i for f in found for i in f["failing"]})[:20],
        "things_without_a_place": sum(f["lacking"] for f in found),
        "median_s": round(statistics.median(f["seconds"] for f in found), 1),
        "median_things_a_room": statistics.median(r["things"] for r in rooms),
        "least_things_a_room": min(r["things"] for r in rooms),
        "rooms_of_60_things": sum(r["things"] >= 60 for r in rooms),
        "least_generators_a_room": min(r["generators"] for r in rooms),
        "entities": round(statistics.mean(f["entities"] for f in found)),
    }
    if frames:
        result |= {
            "simulated_s": [f["simulated_s"] for f in found],
            "things_moved": [f["moved"] for f in found],
            "overlaps_at_the_end": [f["overlaps"] for f in found],
        }
    return result


def _flat(seed: int, frames: int) -> dict[str, Any]:
    with tempfile.TemporaryDirectory() as root:
        session, _ = create(Path(root), "flat", "A furnished flat.", {"simulation": {"frames": max(2, frames)}})
        began = time.perf_counter()
        asked = Interior.model_validate({"rooms": ROOMS, "seed": seed, "density": 1.0})
        made = build_interior("flat", asked, gap=GAP)
        operations = interior_operations(session.spec, "flat", asked, made)
        session.commit(apply_patch(session.spec, operations), patch=operations)
        rows, _, _ = session.check_static()
        took = time.perf_counter() - began
        failing = [r.id for r in rows if r.mandatory and r.status not in ("pass", "not_applicable")]
        told = {
            "rooms": made.rooms,
            "entities": len(made.entities),
            "lacking": len(made.lacking),
            "failing": failing,
            "seconds": took,
        }
        print(
            f"flat {seed}: {took:.1f} s, {len(made.entities)} entities, {len(made.lacking)} without a place, fails {failing[:3]}",
            file=sys.stderr,
        )
        return told | (_simulated(session, frames) if frames else {})


def _simulated(session: Session, frames: int) -> dict[str, Any]:
    """Things that left their place, and overlaps, after the last frame."""
    built, _ = build_world(session.folder, session.spec)
    began = time.perf_counter()
    caches = run_frames(session.spec, built, session.folder.root / "run", frames=frames)
    took, cache, last = time.perf_counter() - began, caches["rigid"], frames - 1
    moved = []
    for row, name in enumerate(cache.index.bodies):
        first, end = cache.pose(row, 0), cache.pose(row, last)
        turn = 2 * math.acos(min(1.0, abs(float(first.quaternion @ end.quaternion))))
        if math.dist(first.position, end.position) > MOVED or turn > TURNED:
            moved.append(name.split("/")[0])
    at_end = Candidate(session.folder.root, session.spec, built, "probe", caches).until(last)
    rows = run_checks(at_end, only=["contact"])
    overlaps = sum(r.status == "fail" for r in rows)
    print(f"  simulated in {took:.0f} s; moved: {moved[:10]}", file=sys.stderr)
    return {"simulated_s": round(took), "moved": moved, "overlaps": overlaps}


if __name__ == "__main__":
    given = [int(v) for v in sys.argv[1:3]]
    print(json.dumps(run(flats=given[0] if given else FLATS, frames=given[1] if len(given) > 1 else 0), indent=1))
