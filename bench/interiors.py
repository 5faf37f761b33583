"""Benchmark `interiors`: flats of six furnished rooms, from their list to the static verdict, and 5 s of simulation of them.

    worldagent bench interiors
    python -P -m worldagent.bench.interiors --flats 20 --construct      # furnish alone: what finds no place, in a minute or two
    python -P -m worldagent.bench.interiors --first 40 --flats 10 --frames 121

Flats are fixed beforehand as data (`flats.json`): the kinds, areas and doors of six rooms each, a seed, and by kind of room the furniture that
has to be there and the generators whose things count, so that a cardboard box counts where the list says so. A flat passes where every static
row passes, every room has its least number of things and of generators, and nothing is without a place. Still is a room none of whose
things is further than 5 mm or 1 degree from its place at the last frame. SceneSmith (arXiv:2602.09153) has 71 objects a room, about 2 % of
them colliding, 96 % standing.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import statistics
import sys
import tempfile
import time
from collections import Counter
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

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

if TYPE_CHECKING:
    from ..construction.interiors.build import BuiltInterior

__all__ = ["flat_of", "judged", "run"]

NAME = "flat"
GAP = 1e-3
"""[m] Two collision skins at the default."""
FRAMES = 121
"""The initial state and 5 s at 24 frames a second."""
MOVED, TURNED = 5e-3, math.radians(1.0)
"""[m], [rad] How far a thing that stands may be from its place."""


@cache
def _lists() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(Path(__file__).with_name("flats.json").read_text(encoding="utf-8"))
    return found


def flat_of(number: int) -> Interior:
    """A flat of the list."""
    flat, things = _lists()["flats"][number], _lists()["least"]["things"]
    rooms = {k: {**room, "things": things} for k, room in flat["rooms"].items()}
    return Interior.model_validate({"rooms": rooms, "seed": flat["seed"]})


def judged(number: int, made: BuiltInterior) -> dict[str, Any]:
    """Things and generators of each room that its list counts, and what is without a place."""
    rooms, unplaced = {}, list(made.lacking)
    for room, asked in _lists()["flats"][number]["rooms"].items():
        own = _lists()["kinds"][asked["kind"]]
        names = Counter(
            e["asset"]["generator"] for k, e in made.entities.items() if "asset" in e and k.startswith(f"{NAME}_{room}_")
        )
        counted = {k: v for k, v in names.items() if k in own["counts"]}
        rooms[room] = {"things": sum(counted.values()), "generators": len(counted)}
        for wanted, count in own["furniture"].items():
            there = sum(names[k] for k in wanted.split(" or "))
            if there < count:
                unplaced.append(f"{room}: {there} of {count} {wanted}")
    return {"rooms": rooms, "unplaced": unplaced, "entities": len(made.entities), "left_out": len(made.left_out)}


def run(*, first: int = 0, flats: int | None = None, frames: int = FRAMES, construct: bool = False) -> dict[str, Any]:
    """Figures of flats of the list, see the module.

    Args:
        first: number of the first.
        flats: how many; default all.
        frames: of the simulation, 0: none.
        construct: furnish alone; nothing is checked or simulated.
    """
    last = len(_lists()["flats"]) if flats is None else first + flats
    found = []
    for number in range(first, last):
        found.append(_constructed(number) if construct else _flat(number, frames))
        print(json.dumps({"flat": number, **found[-1]}), file=sys.stderr, flush=True)
    return _figures(found, frames=0 if construct else frames)


def _figures(found: list[dict[str, Any]], *, frames: int) -> dict[str, Any]:
    least = _lists()["least"]
    rooms = [r for f in found for r in f["rooms"].values()]
    result = {
        "flats": len(found),
        "pass_rate": round(statistics.mean(_passes(f) for f in found), 4),
        "median_s": round(statistics.median(f["seconds"] for f in found), 1),
        "median_cpu_s": round(statistics.median(f["cpu_s"] for f in found), 1),
        "objects_per_room": statistics.median(r["things"] for r in rooms),
        "least_objects_in_a_room": min(r["things"] for r in rooms),
        "rooms_with_enough_rate": round(
            statistics.mean(r["things"] >= least["things"] and r["generators"] >= least["generators"] for r in rooms), 4
        ),
        "least_generators_in_a_room": min(r["generators"] for r in rooms),
        "unplaced": [len(f["unplaced"]) for f in found],
        "failing_rows": sorted({i for f in found for i in f.get("failing", ())})[:20],
        "entities": round(statistics.mean(f["entities"] for f in found)),
    }
    if frames:
        moved = [f["moved_rooms"] for f in found]
        result |= {
            "still_rate": round(1 - sum(len(m) for m in moved) / len(rooms), 4),
            "overlaps_at_the_end": sum(f["overlaps"] for f in found),
            "median_simulated_s": round(statistics.median(f["simulated_s"] for f in found)),
        }
    return result


def _passes(flat: dict[str, Any]) -> bool:
    least = _lists()["least"]
    enough = all(r["things"] >= least["things"] and r["generators"] >= least["generators"] for r in flat["rooms"].values())
    return enough and not flat["unplaced"] and not flat.get("failing")


def _constructed(number: int) -> dict[str, Any]:
    began, worked = time.perf_counter(), _worked()
    made = build_interior(NAME, flat_of(number), gap=GAP)
    took = {"seconds": round(time.perf_counter() - began, 2), "cpu_s": round(_worked() - worked, 2)}
    return {**judged(number, made), **took}


def _worked() -> float:
    """Processor time of this process and of its children that have ended [s]: other load of the machine hardly changes it."""
    return sum(os.times()[:4])


def _flat(number: int, frames: int) -> dict[str, Any]:
    with tempfile.TemporaryDirectory() as root:
        session, _ = create(Path(root), NAME, "A furnished flat.", {"simulation": {"frames": max(2, frames)}})
        began, worked = time.perf_counter(), _worked()
        asked = flat_of(number)
        made = build_interior(NAME, asked, gap=GAP)
        operations = interior_operations(session.spec, NAME, asked, made)
        session.commit(apply_patch(session.spec, operations), patch=operations)
        rows, _, _ = session.check_static()
        took = {"seconds": round(time.perf_counter() - began, 1), "cpu_s": round(_worked() - worked, 1)}
        failing = [r.id for r in rows if r.mandatory and r.status not in ("pass", "not_applicable")]
        told = {**judged(number, made), "failing": failing, **took}
        return told | (_simulated(session, frames) if frames else {})


def _simulated(session: Session, frames: int) -> dict[str, Any]:
    """Things that left their place, their rooms, and overlaps, after the last frame."""
    built, _ = build_world(session.folder, session.spec)
    began = time.perf_counter()
    caches = run_frames(session.spec, built, session.folder.root / "run", frames=frames)
    took, cached, last = time.perf_counter() - began, caches["rigid"], frames - 1
    moved = []
    for row, name in enumerate(cached.index.bodies):
        first, end = cached.pose(row, 0), cached.pose(row, last)
        turn = 2 * math.acos(min(1.0, abs(float(first.quaternion @ end.quaternion))))
        if math.dist(first.position, end.position) > MOVED or turn > TURNED:
            moved.append(name.split("/")[0])
    at_end = Candidate(session.folder.root, session.spec, built, "probe", caches).until(last)
    rows = run_checks(at_end, only=["contact"])
    overlaps = sum(r.status == "fail" for r in rows)
    rooms = sorted({name.split("_")[1] for name in moved})
    return {"simulated_s": round(took), "moved": moved, "moved_rooms": rooms, "overlaps": overlaps}


def main(argv: list[str] | None = None) -> None:
    """Measure some flats of the list and print the figures as JSON."""
    parser = argparse.ArgumentParser(description="Measure furnished flats.")
    parser.add_argument("--first", type=int, default=0, help="number of the first flat")
    parser.add_argument("--flats", type=int, default=None, help="how many; default all")
    parser.add_argument("--frames", type=int, default=FRAMES, help="of the simulation; 0: none")
    parser.add_argument("--construct", action="store_true", help="furnish alone, without checks")
    given = parser.parse_args(argv)
    print(json.dumps(run(first=given.first, flats=given.flats, frames=given.frames, construct=given.construct), indent=1))


if __name__ == "__main__":
    main()
