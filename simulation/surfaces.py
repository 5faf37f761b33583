"""Surfaces of all liquids of a run, laid onto the solids that hold them, and what they wet, as the last step of a probe or bake (R70)."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from ..worlds.arrays import F64, RigidPose, compose, pose_of
from ..worlds.built import BuiltEntity, TriangleMesh
from ..worlds.cache import Cache
from ..worlds.categories.liquid.facts import spacing_of
from ..worlds.categories.liquid.surface import LiquidSurface
from ..worlds.categories.liquid.wet import WetMap
from ..worlds.categories.loose import domain_box
from ..worlds.errors import EvidenceError, InputError
from ..worlds.spec import WorldSpec
from .boundaries import meets_domain
from .liquid.derived_frames import take_frames
from .liquid.scene import MARGIN
from .liquid.surface import default_settings, mesh_surfaces
from .liquid.wet import WetPart, map_wet
from .origins import Origins

__all__ = ["map_wet_solids", "mesh_liquids", "take_made", "take_surfaces", "walls_of"]


def walls_of(
    spec: WorldSpec, built: Mapping[str, BuiltEntity], name: str, caches: Mapping[str, Cache]
) -> Callable[[int], list[TriangleMesh]]:
    """World meshes of the closed parts that meet a liquid's domain, by frame.

    Args:
        spec: the specification.
        built: its geometry.
        name: the liquid instance.
        caches: of all instances, for what moves.
    """
    box, margin = domain_box(spec.simulation.liquid[name]), MARGIN * spacing_of(spec, name)
    rigid = [c for n, c in caches.items() if n in spec.simulation.rigid]
    still: list[TriangleMesh] = []
    moving: list[tuple[TriangleMesh, Cache, int, str]] = []
    for entity in sorted(n for n, e in spec.entities.items() if e.physics.shape == "solid"):
        if not meets_domain(spec.entities[entity], built[entity], box, margin):
            continue
        starts = {b.name: compose(pose_of(spec.entities[entity].pose), b.pose) for b in built[entity].bodies}
        for part in (p for p in built[entity].parts if p.closed):
            place = next(((c, row) for c in rigid if (row := c.body_row(entity, part.body)) is not None), None)
            if place is None:
                still.append(TriangleMesh(starts[part.body].apply(part.render.vertices), part.render.faces))
            else:
                moving.append((part.render, *place, entity))

    def at(frame: int) -> list[TriangleMesh]:
        found = list(still)
        poses: dict[int, tuple[np.ndarray, np.ndarray]] = {}
        for mesh, cache, row, entity in moving:
            interval = spec.entities[entity].active
            if interval is not None and not interval[0] <= frame <= interval[1]:
                continue
            if id(cache) not in poses:
                data = cache.read(frame, ("position", "quaternion"))
                poses[id(cache)] = (data["position"], data["quaternion"])
            position, quaternion = poses[id(cache)]
            found.append(TriangleMesh(RigidPose(position[row], quaternion[row]).apply(mesh.vertices), mesh.faces))
        return found

    return at


def take_made(spec: WorldSpec, caches: Mapping[str, Cache], earlier: Mapping[str, Cache]) -> None:
    """Take surfaces and wet maps from an earlier run of the same specification and geometry that came to the same frames.

    Solids hold a surface and carry what is wet, so that the frames of all instances have to be the same. `mesh_liquids` and
    `map_wet_solids` then test and keep what was taken, and make what is missing.

    Args:
        spec: the specification.
        caches: complete, of all instances.
        earlier: those of the earlier run, which may be shorter.
    """
    try:
        known = {name: earlier[name].digests() for name in caches if name in earlier}
        if len(known) < len(caches) or any(caches[n].digests()[: len(d)] != d for n, d in known.items()):
            return
    except EvidenceError:
        return
    for name in spec.simulation.liquid:
        for made in (LiquidSurface, WetMap):
            take_frames(made(caches[name]), made(earlier[name]))


def take_surfaces(spec: WorldSpec, caches: Mapping[str, Cache], origins: Origins) -> None:
    """Take the surfaces of the frames that were taken over, as far as all solids have moved as here."""
    for name in spec.simulation.liquid:
        found = origins.surfaces_of(name, caches)
        if found is not None:
            take_frames(LiquidSurface(caches[name]), LiquidSurface(Cache(found[0])), frames=found[1])


def mesh_liquids(
    spec: WorldSpec,
    built: Mapping[str, BuiltEntity],
    caches: Mapping[str, Cache],
    *,
    progress: Callable[[int, int, str], None] | None = None,
    check: Callable[[], None] | None = None,
) -> dict[str, LiquidSurface]:
    """Make or resume the surfaces of every liquid instance; one in which no particle ever is gets none.

    Args:
        spec: the specification.
        built: its geometry.
        caches: complete, of all instances.
        progress: called with (done, total, message).
        check: called between frames; raises to stop.
    """
    made = {}
    for name in spec.simulation.liquid:
        low, high = domain_box(spec.simulation.liquid[name])
        closed = [side == "closed" for side in spec.simulation.liquid[name].settings.domain.sides]
        try:
            settings = default_settings(caches[name], lower=low.tolist(), upper=high.tolist(), closed=closed)
        except InputError:
            continue
        walls = walls_of(spec, built, name, caches)
        made[name] = mesh_surfaces(caches[name], settings=settings, progress=progress, check=check, walls=walls)
    return made


def map_wet_solids(
    spec: WorldSpec,
    built: Mapping[str, BuiltEntity],
    caches: Mapping[str, Cache],
    *,
    progress: Callable[[int, int, str], None] | None = None,
    check: Callable[[], None] | None = None,
) -> dict[str, WetMap]:
    """Make or resume the wet maps of every liquid instance; one that meets no solid gets none.

    Args:
        spec: the specification.
        built: its geometry.
        caches: complete, of all instances.
        progress: called with (done, total, message).
        check: called between frames; raises to stop.
    """
    gravity = np.array(spec.simulation.gravity, dtype=np.float64)
    strength = float(np.linalg.norm(gravity))
    up = -gravity / strength if strength > 0.0 else np.array([0.0, 0.0, 1.0])
    made = {}
    for name in spec.simulation.liquid:
        parts = _wet_parts(spec, built, name, caches)
        if parts:
            looks = [spec.materials[spec.entities[m].material].appearance for m in spec.simulation.liquid[name].members]
            made[name] = map_wet(
                caches[name], parts, spacing=spacing_of(spec, name), up=up, drying=[a.drying for a in looks],
                gap=spec.simulation.limits.contact_gap, progress=progress, check=check,
            )  # fmt: skip
    return made


def _wet_parts(spec: WorldSpec, built: Mapping[str, BuiltEntity], name: str, caches: Mapping[str, Cache]) -> list[WetPart]:
    """Visible surfaces of the solids that meet a liquid's domain."""
    box, margin = domain_box(spec.simulation.liquid[name]), MARGIN * spacing_of(spec, name)
    tracks = {n: (c.series("position"), c.series("quaternion")) for n, c in caches.items() if n in spec.simulation.rigid}
    found = []
    for entity in sorted(n for n, e in spec.entities.items() if e.physics.shape == "solid"):
        contract = spec.entities[entity]
        if not meets_domain(contract, built[entity], box, margin):
            continue
        starts = {b.name: compose(pose_of(contract.pose), b.pose) for b in built[entity].bodies}
        for part in built[entity].parts:
            held = next(((tracks[n], row) for n in tracks if (row := caches[n].body_row(entity, part.body)) is not None), None)

            def place(
                frame: int,
                start: RigidPose = starts[part.body],
                held: tuple[tuple[F64, F64], int] | None = held,
                interval: tuple[int, int] | None = contract.active,
            ) -> RigidPose | None:
                if interval is not None and not interval[0] <= frame <= interval[1]:
                    return None
                if held is None:
                    return start
                (position, quaternion), row = held
                return RigidPose(position[frame, row], quaternion[frame, row])

            still = held is None and contract.active is None
            found.append(WetPart((entity, part.body, part.part), part.render, place, still))
    return found
