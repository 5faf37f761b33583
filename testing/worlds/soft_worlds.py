"""Small worlds with deforming bodies whose motion is written by hand: for tests and seeded defects of what judges them."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...worlds.arrays import F64, I32, pose_of
from ...worlds.built import BuiltPart, TriangleMesh
from ...worlds.cache import Cache, write_container
from ...worlds.candidate import Candidate
from ...worlds.categories.deforming import lumped
from ...worlds.simulation_mesh import SimulationMesh, volumes
from ...worlds.spec import WorldSpec
from .small_worlds import build_all, make_candidate

__all__ = ["block_mesh", "deformed_candidate"]

Motion = Callable[[float, F64], F64]
"""World positions [m] at a time [s] of vertices that are at the given places at rest, shape (n, 3)."""


def block_mesh(size: tuple[float, float, float], cells: tuple[int, int, int]) -> SimulationMesh:
    """A block about the origin cut into six tetrahedra per cell; its visible vertices are those of its surface."""
    axes = [np.linspace(-s / 2, s / 2, c + 1) for s, c in zip(size, cells, strict=True)]
    vertices = np.array(np.meshgrid(*axes, indexing="ij")).reshape(3, -1).T.copy()
    index = np.arange(len(vertices)).reshape([c + 1 for c in cells])
    tets: list[list[int]] = []
    for corner in itertools.product(*(range(c) for c in cells)):
        for order in itertools.permutations(range(3)):
            at, own = list(corner), [int(index[corner])]
            for axis in order:
                at[axis] += 1
                own.append(int(index[tuple(at)]))
            tets.append(own)
    grown = np.array(tets, dtype=np.int32)
    inverted = volumes(vertices, grown) < 0
    grown[inverted] = grown[inverted][:, [0, 1, 3, 2]]
    faces = _outside(grown)
    used = np.unique(faces)
    indices = np.repeat(used[:, None], 4, axis=1).astype(np.int32)
    weights = np.repeat([[1.0, 0.0, 0.0, 0.0]], len(used), axis=0)
    return SimulationMesh(vertices, faces, grown, indices, weights)


def _outside(tets: I32) -> I32:
    """Faces that belong to one tetrahedron, outward."""
    faces = np.concatenate([tets[:, [1, 2, 3]], tets[:, [0, 3, 2]], tets[:, [0, 1, 3]], tets[:, [0, 2, 1]]])
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    outside: I32 = faces[np.sort(first[count == 1])]
    return outside


def softened(part: BuiltPart, mesh: SimulationMesh) -> BuiltPart:
    """The part with a simulation mesh, and its surface as the visible one."""
    used = np.unique(mesh.faces)
    place = np.full(len(mesh.vertices), -1, dtype=np.int32)
    place[used] = np.arange(len(used))
    return replace(part, render=TriangleMesh(mesh.vertices[used], place[mesh.faces]), simulation=mesh, smooth=False)


def deformed_candidate(
    folder: Path,
    spec: WorldSpec,
    meshes: Mapping[str, SimulationMesh],
    motions: Mapping[str, Motion],
    *,
    travel: float = 0.0,
    strain_energy: Any = 0.0,
    kinetic: float = 1.0,
    residual: float = 0.0,
    **more: Any,
) -> Candidate:
    """A baked world whose entities in `meshes` deform as `motions` say.

    Args:
        folder: where the caches go.
        spec: the specification.
        meshes: simulation mesh per deforming entity, in the frame of its one part.
        motions: world positions over time per deforming entity.
        travel: record of the farthest travel per step [m].
        strain_energy: record of the stored energy [J], one for all frames or one each; None: what keeps the sum of energies.
        kinetic: factor on the record of the kinetic energy.
        residual: record of the residual of the solve.
        more: goes to `make_candidate`.
    """
    built = dict(build_all(spec))
    for name, mesh in meshes.items():
        built[name] = replace(built[name], parts=tuple(softened(p, mesh) for p in built[name].parts))
    made = make_candidate(folder, spec, **{"tracks": {}, **more})
    cache = made.caches["rigid"]
    names = tuple(f"{n}/{built[n].parts[0].part}" for n in meshes)
    kept = [k for k, name in enumerate(cache.index.bodies) if name.split("/")[0] not in meshes]
    bodies = tuple(cache.index.bodies[k] for k in kept)
    index = replace(cache.index, bodies=bodies, deformables=names, vertices=tuple(len(m.vertices) for m in meshes.values()))
    digests, step = [], 1e-6
    left_out = set(more.get("without", ()))
    balanced = strain_energy is None
    stored = np.broadcast_to(np.asarray(0.0 if balanced else strain_energy, dtype=float), (cache.index.frames,))
    first: float | None = None
    weights = np.concatenate([built[n].bodies[0].mass * lumped(m) for n, m in meshes.items()])
    gravity = np.array(spec.simulation.gravity)
    for frame in range(cache.index.frames):
        time, channels = frame / spec.simulation.fps, cache.read(frame)
        for name in ("position", "quaternion", "velocity", "angular_velocity", "asleep"):
            if name in channels:
                channels[name] = channels[name][kept]
        placed = {n: (motions[n], pose_of(spec.entities[n].pose).apply(meshes[n].vertices)) for n in meshes}
        channels["vertex/position"] = np.concatenate([move(time, rest) for move, rest in placed.values()])
        speeds = [(move(time + step, rest) - move(time - step, rest)) / (2 * step) for move, rest in placed.values()]
        channels["vertex/velocity"] = np.concatenate(speeds).astype(np.float32)
        place, speed = channels["vertex/position"], channels["vertex/velocity"].astype(np.float64)
        records = {
            "elastic_kinetic_energy": kinetic * 0.5 * float(weights @ (speed**2).sum(1)),
            "elastic_potential_energy": -float(weights @ (place @ gravity)),
            "strain_energy": float(stored[frame]),
            "elastic_travel_per_step": travel,
            "solve_residual": residual,
            "kinetic_energy": 0.0,
            "potential_energy": 0.0,
            "driver_work": 0.0,
            **{f"elastic_momentum_{a}": float(weights @ speed[:, k]) for k, a in enumerate("xyz")},
        }
        if balanced:
            moving = records["elastic_kinetic_energy"] + records["elastic_potential_energy"]
            first = moving if first is None else first
            records["strain_energy"] = first - moving
        channels |= {f"record/{n}": np.float64(v) for n, v in records.items() if f"record/{n}" not in channels}
        digests.append(write_container(cache.path(frame), {n: v for n, v in channels.items() if n not in left_out}))
    fresh = Cache(cache.folder)
    fresh.write_index(index)
    fresh.begin_digests(digests)
    return replace(made, built=built, caches={"rigid": fresh})
