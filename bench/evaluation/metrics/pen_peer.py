"""Depths of the same overlaps by Blender's bounding volume hierarchy (GPL), in a process of its own.

`blender` on the path or in `$WORLDAGENT_BLENDER`; without one there is no peer, and the answer says so. Blender's tree holds single precision: depths agree to about 1e-6 of the coordinates.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from .pen import Evaluated, Overlap

__all__ = ["peer_depths"]

ENV_BLENDER = "WORLDAGENT_BLENDER"
SECONDS = 300.0
"""Longest that the peer may take [s]."""
_SCRIPT = """
import json, sys
from mathutils import Vector
from mathutils.bvhtree import BVHTree

def directed(one, two, pairs, side):
    tree = two["tree"]
    corners = {c for p in pairs for c in one["faces"][p[side]]}
    deepest = 0.0
    for c in corners:
        v = Vector(one["vertices"][c])
        point, normal, _, _ = tree.find_nearest(v)
        deepest = max(deepest, -(v - point).dot(normal))
    return deepest

source, target = sys.argv[-2:]
answers = []
for one, two in json.load(open(source)):
    for o in (one, two):
        o["tree"] = BVHTree.FromPolygons([tuple(v) for v in o["vertices"]], [tuple(f) for f in o["faces"]], all_triangles=True, epsilon=0.0)
    pairs = one["tree"].overlap(two["tree"])
    depth = None
    if pairs:
        found = [directed(a, b, pairs, side) for a, b, side in ((one, two, 0), (two, one, 1)) if a["dynamic"] and b["closed"]]
        depth = max([1e-4, *found])
    answers.append(depth)
json.dump(answers, open(target, "w"))
"""


def peer_depths(overlaps: Sequence[tuple[Sequence[Evaluated], Overlap]]) -> dict[str, Any]:
    """Largest relative difference of depth over overlaps, Blender's to ours, or the reason why there is none.

    Args:
        overlaps: each with the objects among which it was found.
    """
    blender = os.environ.get(ENV_BLENDER) or shutil.which("blender")
    if blender is None:
        return {
            "max_relative_difference": None,
            "reason": f"blender is not installed; ${ENV_BLENDER} may name it (Debian package blender 3.4.1)",
        }
    with tempfile.TemporaryDirectory(prefix="worldagent-") as folder:
        script, source, target = (Path(folder) / name for name in ("peer.py", "meshes.json", "depths.json"))
        script.write_text(_SCRIPT)
        source.write_text(json.dumps([[_plain(objects, name) for name in (o.first, o.second)] for objects, o in overlaps]))
        try:
            ended = subprocess.run(
                [blender, "-b", "-P", str(script), "--", str(source), str(target)],
                capture_output=True,
                text=True,
                check=False,
                timeout=SECONDS,
            )
        except subprocess.TimeoutExpired:
            return {"max_relative_difference": None, "reason": f"{blender} took longer than {SECONDS:g} s"}
        if not target.is_file():
            return {
                "max_relative_difference": None,
                "reason": (ended.stderr.strip().splitlines() or ["blender ended without a word"])[-1],
            }
        theirs: list[float | None] = json.loads(target.read_text())
    differences = [1.0 if d is None else abs(d - o.depth) / o.depth for d, (_, o) in zip(theirs, overlaps, strict=True)]
    return {"max_relative_difference": max(differences), "depths_m": theirs, "ours_m": [o.depth for _, o in overlaps]}


def _plain(objects: Sequence[Evaluated], name: str) -> dict[str, Any]:
    found = next(o for o in objects if o.name == name)
    return {"vertices": found.vertices.tolist(), "faces": found.faces.tolist(), "dynamic": found.dynamic, "closed": found.closed}
