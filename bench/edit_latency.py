"""Benchmark `edit-latency`: time of one `edit_spec` call on a world of 200 entities, through the protocol.

The call validates, audits, finds what became stale and appends a revision. It goes through the in-memory client, so
that pipes and process starts do not count.
"""

from __future__ import annotations

import asyncio
import statistics
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

__all__ = ["ENTITIES", "run", "specification"]

ENTITIES = 200
EDITS = 31
SIZE = (0.2, 0.3, 0.1)
"""Edge lengths of a box [m]."""
PITCH = 0.6


def specification(entities: int) -> dict[str, Any]:
    """A floor and a grid of boxes that rest on it, all members of one solver instance."""
    side = max(1, round(entities**0.5))
    boxes = {
        f"box{k:03d}": {
            "role": "box on the floor",
            "motion": "dynamic",
            "material": "wood",
            "dimensions": {"size": SIZE},
            "pose": {"position": (PITCH * (k % side), PITCH * (k // side), SIZE[2] / 2)},
            "parts": {"body": {"shape": {"kind": "box", "size": SIZE}}},
        }
        for k in range(entities - 1)
    }
    extent = PITCH * (side + 4)
    floor = {
        "role": "floor",
        "motion": "static",
        "material": "wood",
        "dimensions": {"size": (2 * extent, 2 * extent, 0.1)},
        "pose": {"position": (0, 0, -0.05)},
        "parts": {"slab": {"shape": {"kind": "box", "size": (2 * extent, 2 * extent, 0.1)}}},
    }
    rests = {"kind": "rests_on", "entity": "box000", "on": "floor"}
    return {
        "title": "Boxes on a floor",
        "spec_version": "2",
        "claims": {
            "boxes": {"quote": "Boxes", "type": "thing", "by": [f"/entities/{name}" for name in boxes]},
            "stand": {"quote": "stand", "type": "property", "by": ["/story/requirements/rest"]},
            "floor": {"quote": "floor", "type": "thing", "by": ["/entities/floor"]},
        },
        "story": {"requirements": {"rest": {"text": "a box stands on the floor", "predicate": rests}}},
        "materials": {"wood": {"density": 600.0, "friction": 0.5, "restitution": 0.2, "substance": "wood"}},
        "entities": {"floor": floor, **boxes},
        "graph": {"relations": {f"on_{name}": {"kind": "supports", "a": "floor", "b": name} for name in boxes}},
        "simulation": {"frames": 48, "solvers": {"rigid": {"engine": "mujoco", "members": ["floor", *boxes]}}},
    }


def run() -> dict[str, Any]:
    """Median over single-field edits of one pose, each a new revision."""
    with tempfile.TemporaryDirectory() as folder:
        return asyncio.run(_measure(Path(folder)))


async def _measure(workspace: Path) -> dict[str, Any]:
    from mcp import Client

    from ..server.app import create_server

    times: list[float] = []
    async with Client(create_server(workspace)) as client:

        async def edit(**arguments: Any) -> float:
            begin = time.perf_counter()
            result = await client.call_tool("edit_spec", {"world": "boxes", **arguments})
            seconds = time.perf_counter() - begin
            if result.is_error:
                raise RuntimeError(f"edit_spec failed: {result.content}")
            return seconds

        created = await edit(prompt="Boxes stand on a floor.", spec=specification(ENTITIES))
        print(f"created in {created * 1e3:.1f} ms", file=sys.stderr)
        for k in range(EDITS + 1):
            path = f"/entities/box{k % (ENTITIES - 1):03d}/pose/position/0"
            taken = await edit(patch=[{"op": "replace", "path": path, "value": -1.0 - PITCH * k}])
            print(f"edit {k}: {taken * 1e3:.1f} ms", file=sys.stderr)
            if k:
                times.append(taken)
    return {
        "median_ms": round(statistics.median(times) * 1e3, 1),
        "slowest_ms": round(max(times) * 1e3, 1),
        "create_ms": round(created * 1e3, 1),
        "entities": ENTITIES,
        "edits": EDITS,
    }
