"""Benchmark `statics-scale`: the static checks of overlap and support over an interior of 2,000 objects.

    worldagent bench statics-scale

Three furnished flats side by side (`ROOMS`, seeds 0, 1, 2) in one world. Counted: reading what was built, and every row of the
checks `interpenetration` and `support`; not counted: making the things, and loading the kernels, which happens once per process. The peer
is the collision manager of trimesh (fcl), which gets the same meshes at the same places and says which of them touch; it measures no
distance, so that it has less to do.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from ..construction import build_world
from ..construction.interiors.build import build_interior
from ..geometry import Solid, self_crossings
from ..geometry.launch import chosen_device, load
from ..verifiers.checks import run_checks
from ..workflow.creation import create
from ..workflow.interiors import interior_operations
from ..workflow.session import Session
from ..worlds.arrays import pose_of
from ..worlds.built import BuiltEntity, TriangleMesh
from ..worlds.candidate import Candidate
from ..worlds.patch import apply_patch
from ..worlds.spec import Interior, WorldSpec
from .interiors import GAP

__all__ = ["run"]

FLATS = 3
ROOMS: dict[str, dict[str, Any]] = {
    "hall": {"kind": "hall", "doors": ["outside"]},
    "living": {"kind": "living", "doors": ["hall"]},
    "kitchen": {"kind": "kitchen", "doors": ["hall", "living"]},
    "bedroom": {"kind": "bedroom", "doors": ["hall"]},
    "study": {"kind": "study", "doors": ["hall"]},
    "bath": {"kind": "bathroom", "doors": ["hall"]},
}
APART = 25.0
"""[m] From the middle of a flat to that of the next."""
CHECKS = ("interpenetration", "support")
MOST_SECONDS = 10.0
"""[s] What the checks may take on two cores."""


def run(*, flats: int = FLATS) -> dict[str, Any]:
    """Measure; progress goes to stderr."""
    from ..geometry.clearance_kernels import nearest

    load(nearest, chosen_device())
    _load_loops()
    with tempfile.TemporaryDirectory() as root:
        session = _furnished(Path(root), flats)
        built, _ = build_world(session.folder, session.spec)
        spent: dict[str, float] = {}
        rows = []
        candidate = Candidate(session.folder.root, session.spec, build_world(session.folder, session.spec)[0], "static")
        processor = time.process_time()
        for check in CHECKS:
            began = time.perf_counter()
            rows += run_checks(candidate, only=[check])
            spent[check] = time.perf_counter() - began
        processor = time.process_time() - processor
        peer = _trimesh(session.spec, built)
    seconds = sum(spent.values())
    return {
        "objects": len(built),
        "parts": sum(len(b.parts) for b in built.values()),
        "seconds": seconds,
        "cpu_s": processor,
        "within_budget": seconds <= MOST_SECONDS,
        "rows": len(rows),
        "rows_that_do_not_pass": sum(r.status not in ("pass", "not_applicable") for r in rows),
        "seconds_of": spent,
        "trimesh_s": peer[0],
        "trimesh_touching_pairs": peer[1],
        "ratio_vs_trimesh": seconds / peer[0],
    }


def _load_loops() -> None:
    """Load the compiled loops of the checks: they are kept on disk, and each process loads them once."""
    from scipy.spatial import ConvexHull

    from ..geometry.convex_batch import convex_clearances, convex_of
    from ..geometry.point_kernels import to_triangles
    from ..geometry.polytopes import Relative
    from ..verifiers.support.touching_kernels import places, pushes

    corners = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
    faces = ConvexHull(corners).simplices.astype(np.int32)
    inward = np.linalg.det(corners[faces]) < 0.0
    faces[inward] = faces[inward, ::-1]
    box = Solid.from_mesh(TriangleMesh(corners, faces), closed=True)
    one, far = np.eye(3)[None], np.full(1, np.inf)
    convex_clearances(
        convex_of([box]), np.zeros((1, 2), dtype=np.int32), Relative(one, 2.0 * one[:, 0]), skip_above=far, enough=far
    )
    self_crossings(box, noise=1e-9, groups=np.array([len(box.faces)]))
    to_triangles(corners[0], box.triangles)
    span, sides, both = np.array([[-2.0] * 3, [2.0] * 3]), ((box.closed, 1.0), (box.closed, 1.0)), (box.faces, box.faces)
    points, _ = places(box.vertices, box.vertices, *both, box.edges, box.edges, *span, 1e-3, 1)
    pushes(points, box.vertices, box.vertices, *both, span, sides, (1e-3, 1e-3, 1e-3, 1.0), 1)


def _furnished(root: Path, flats: int) -> Session:
    session, _ = create(root, "flats", "Furnished flats.", {"simulation": {"frames": 2}})
    for number in range(flats):
        asked = Interior.model_validate({"rooms": ROOMS, "seed": number, "density": 1.0, "at": (APART * number, 0.0, 0.0)})
        made = build_interior(f"flat{number}", asked, gap=GAP)
        operations = interior_operations(session.spec, f"flat{number}", asked, made)
        session.commit(apply_patch(session.spec, operations), patch=operations)
        print(f"flat {number}: {len(made.entities)} entities", file=sys.stderr)
    return session


def _trimesh(spec: WorldSpec, built: dict[str, BuiltEntity]) -> tuple[float, int]:
    """Seconds that the collision manager takes from meshes to the pairs that touch, and the number of pairs of different entities."""
    import trimesh

    meshes = []
    for name, entity in built.items():
        pose = pose_of(spec.entities[name].pose)
        poses = {b.name: b.pose for b in entity.bodies}
        for part in entity.parts:
            held = poses[part.body]
            placed = pose.apply(held.apply(part.render.vertices))
            meshes.append((f"{name}\n{part.part}", trimesh.Trimesh(placed, np.asarray(part.render.faces), process=False)))
    began = time.perf_counter()
    manager = trimesh.collision.CollisionManager()
    for name, mesh in meshes:
        manager.add_object(name, mesh)
    _, names = manager.in_collision_internal(return_names=True)
    took = time.perf_counter() - began
    return took, len(
        {tuple(sorted((a.split("\n")[0], b.split("\n")[0]))) for a, b in names if a.split("\n")[0] != b.split("\n")[0]}
    )


if __name__ == "__main__":
    import json

    print(json.dumps(run(flats=int(sys.argv[1]) if len(sys.argv) > 1 else FLATS), indent=1))
