"""Surfaces, spray and foam of a baked liquid, frame by frame beside its cache (`worlds/categories/liquid/surface.py` has the channels)."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.launch import cores
from ...worlds.arrays import F64, I32
from ...worlds.built import TriangleMesh
from ...worlds.cache import Cache, digest_arrays
from ...worlds.canonical import digest_of, source_digest
from ...worlds.categories.liquid.surface import LiquidSurface
from ...worlds.errors import EvidenceError, InputError
from . import foam, surface_mesh
from .derived_frames import make_frames
from .surround import Surroundings, clumps, surroundings
from .wall_fit import fit_to_sides, fit_to_walls, off_sides, off_walls

__all__ = ["SurfaceSettings", "default_settings", "mesh_surfaces", "surface_frame"]

SMALLEST = 8.0
"""Separate pieces of surface and cavities of fewer particle volumes are left out: particles do not resolve them."""
ROUGH = 0.15
"""Spacings by which a surface of particles at rest may lie off where their volume has it: a lattice's face is flat, that of flowed
liquid is not, and the colour field sees the difference (measured 0.11 in still water, whose centre of mass stays within 0.2 %)."""
THICK = 0.5
"""Spacings by which it is drawn further in where it holds more than its particles: sheets a particle or two thick, and what is swung off
the wall of a vessel that it is still laid onto. Never further out: what was pressed together is shown as it is."""
NEARLY = 1e-3
"""Share of the volume that one step may miss."""
AHEAD = 3
"""Frames in hand at once: while some are drawn, spray and foam of the next are followed."""
BARE = 0.4
"""Distance from walls within which there is no foam."""
Walls = Callable[[int], Sequence[TriangleMesh]]
"""World meshes of what holds the liquid, at a frame."""


@dataclass(frozen=True)
class SurfaceSettings:
    """Settings of surface reconstruction; lengths in spacings unless said."""

    spacing: float
    """Distance of particles at rest [m]: the cube root of their volume."""
    support: float = surface_mesh.SUPPORT
    """Smoothing length of the colour field in particle radii."""
    threshold: float = surface_mesh.THRESHOLD
    cell: float = surface_mesh.CELL
    """Side of a marching cube."""
    lower: tuple[float, float, float] | None = None
    """Domain [m], for its closed sides."""
    upper: tuple[float, float, float] | None = None
    closed: tuple[bool, ...] = (False,) * 6
    """Sides in the order -x, +x, -y, +y, -z, +z that hold the liquid."""


def default_settings(
    cache: Cache,
    *,
    lower: Sequence[float] | None = None,
    upper: Sequence[float] | None = None,
    closed: Sequence[bool] = (False,) * 6,
) -> SurfaceSettings:
    """Settings for a cache: markers of a grid (`flip`) lie less evenly than particles, so they get a kernel and cubes half as wide again.

    Args:
        cache: of a liquid instance.
        lower: corner of the domain [m].
        upper: the other corner.
        closed: which sides hold the liquid.

    Raises:
        InputError: no frame holds a particle.
    """
    volume = next(
        (v for v in (cache.read(k, ("particle/volume",)) for k in range(cache.index.frames)) if v["particle/volume"].size), None
    )
    if volume is None:
        raise InputError(f"liquid {cache.index.solver!r} has no particle in any frame; give it a volume or an inflow")
    spacing = float(np.cbrt(np.median(volume["particle/volume"])))
    wide = {"support": 3.0, "threshold": 0.64, "cell": 1.5 * surface_mesh.CELL} if cache.index.engine == "flip" else {}
    corners = {k: tuple(float(x) for x in v) for k, v in (("lower", lower), ("upper", upper)) if v is not None}
    return SurfaceSettings(spacing, **wide, **corners, closed=tuple(bool(c) for c in closed))  # type: ignore[arg-type]


@dataclass(frozen=True)
class _State:
    """State that a frame takes over from the one before."""

    spray: I32
    foam: foam.FoamState


def _pieces(mesh: surface_mesh.SurfaceMesh, least: float) -> tuple[surface_mesh.SurfaceMesh, int]:
    """The mesh without pieces and cavities smaller than `least` [m^3], and the number of pieces that are not cavities."""
    from .mesh_kernels import components

    if not len(mesh.faces):
        return mesh, 0
    root = np.arange(len(mesh.vertices))
    components(mesh.faces, root)
    own = root[mesh.faces[:, 0]]
    volume = np.bincount(own, surface_mesh.face_volumes(mesh.vertices, mesh.faces), minlength=len(root))
    kept = np.abs(volume) >= least
    faces = mesh.faces[kept[own]]
    number = int((volume[kept] > 0).sum())
    if len(faces) == len(mesh.faces):
        return mesh, number
    used = np.flatnonzero(kept[root])
    place = np.zeros(len(root), np.int32)
    place[used] = np.arange(len(used), dtype=np.int32)
    return surface_mesh.SurfaceMesh(mesh.vertices[used], place[faces], mesh.velocity[used], mesh.temperature[used]), number


def _filled(
    mesh: surface_mesh.SurfaceMesh, held: float, settings: SurfaceSettings, walls: Sequence[TriangleMesh], origin: F64
) -> F64:
    """Vertices of a surface laid onto walls, whose free part is moved out by up to `ROUGH`, or in by up to `THICK`, to hold `held` [m^3]."""
    normals, share = surface_mesh.vertex_normals(mesh.vertices, mesh.faces)
    laid = _laid(mesh.vertices, normals, settings, walls, origin)
    open_air = (laid == mesh.vertices).all(axis=1)
    free = float(share[open_air].sum())
    volume = surface_mesh.closed_volume(laid, mesh.faces)
    lacking, inmost, outmost = held - volume, -THICK * settings.spacing, ROUGH * settings.spacing
    known = bool(walls) or any(settings.closed)
    if not known or free <= 0.0 or lacking == 0.0:
        return laid
    # What lies on walls stays there, or a gap of air would show below the liquid.
    out = open_air[:, None] * normals
    way = float(np.clip(lacking / free, inmost, outmost))
    gained = surface_mesh.closed_volume(laid + way * out, mesh.faces) - volume
    if abs(gained - lacking) >= NEARLY * held and gained * lacking > 0.0:
        way = float(np.clip(way * lacking / gained, inmost, outmost))
    return np.asarray(laid + way * out)


def _laid(vertices: F64, normals: F64, settings: SurfaceSettings, walls: Sequence[TriangleMesh], origin: F64) -> F64:
    """Vertices laid onto closed sides of the domain and walls, all relative to `origin`."""
    if settings.lower is not None and settings.upper is not None:
        lower, upper = np.array(settings.lower) - origin, np.array(settings.upper) - origin
        vertices = fit_to_sides(vertices, normals, lower, upper, settings.closed, settings.spacing)
    return fit_to_walls(vertices, normals, walls, settings.spacing) if walls else vertices


def _meshes(
    data: dict[str, Any], position: F64, liquid: NDArray[np.bool_], settings: SurfaceSettings, walls: Sequence[TriangleMesh]
) -> tuple[dict[str, Any], dict[str, float]]:
    """Surface channels of all liquids, relative to the origin, and what is recorded of them."""
    spacing, origin = settings.spacing, np.asarray(data["origin"], dtype=np.float64)
    heat = data.get("particle/temperature")
    parts: list[tuple[int, surface_mesh.SurfaceMesh]] = []
    records = {"surface_volume": 0.0, "surface_area": 0.0, "surface_components": 0.0}
    for fluid in np.unique(data["particle/fluid"]):
        own = liquid & (data["particle/fluid"] == fluid)
        mesh = surface_mesh.reconstruct(
            position[own], data["particle/velocity"][own], None if heat is None else heat[own], spacing,
            support=settings.support, threshold=settings.threshold, cell=settings.cell,
        )  # fmt: skip
        mesh, pieces = _pieces(mesh, SMALLEST * spacing**3)
        if not len(mesh.faces):
            continue
        held = float(data["particle/volume"][own].sum(dtype=np.float64))
        vertices = _filled(mesh, held, settings, [TriangleMesh(w.vertices - origin, w.faces) for w in walls], origin)
        parts.append((int(fluid), surface_mesh.SurfaceMesh(vertices, mesh.faces, mesh.velocity, mesh.temperature)))
        records["surface_volume"] += surface_mesh.closed_volume(vertices, mesh.faces)
        records["surface_area"] += surface_mesh.area(vertices, mesh.faces)
        records["surface_components"] += pieces
    starts = np.cumsum([0, *(len(m.vertices) for _, m in parts)])
    none = np.empty((0, 3))
    channels = {
        "surface/vertices": np.concatenate([none, *(m.vertices for _, m in parts)]).astype(np.float32),
        "surface/velocity": np.concatenate([none, *(m.velocity for _, m in parts)]).astype(np.float32),
        "surface/faces": np.concatenate([none, *(m.faces + s for (_, m), s in zip(parts, starts, strict=False))]).astype(
            np.int32
        ),
        "surface/fluid": np.concatenate([none[:, 0], *(np.full(len(m.faces), k) for k, m in parts)]).astype(np.int32),
    }
    if "particle/temperature" in data:
        channels["surface/temperature"] = np.concatenate([none[:, 0], *(m.temperature for _, m in parts)]).astype(np.float32)
    return channels, records


def _bubbles(
    data: dict[str, Any], position: F64, normal: F64, amount: F64, settings: SurfaceSettings, walls: Sequence[TriangleMesh]
) -> NDArray[np.float32]:
    """Bubbles on the free surface: none where the liquid only leans on a wall."""
    origin, spacing = np.asarray(data["origin"], dtype=np.float64), settings.spacing
    found = foam.bubbles(data["particle/id"], position, normal, amount, spacing)
    if settings.lower is not None and settings.upper is not None:
        lower, upper = np.array(settings.lower) - origin, np.array(settings.upper) - origin
        found = found[off_sides(found, lower, upper, settings.closed, BARE * spacing)]
    if walls:
        found = found[off_walls(found, [TriangleMesh(w.vertices - origin, w.faces) for w in walls], BARE * spacing, 2 * spacing)]
    return found.astype(np.float32)


def surface_frame(
    data: dict[str, Any],
    settings: SurfaceSettings,
    *,
    dt: float,
    before: _State | None = None,
    walls: Sequence[TriangleMesh] = (),
) -> tuple[dict[str, Any], _State]:
    """Channels of one frame's surface without its `source`, and what the next frame takes over.

    Args:
        data: channels of the particles.
        settings: how.
        dt: time between frames [s].
        before: what the frame before left.
        walls: world meshes of what holds the liquid.
    """
    draw, state = _follow(data, settings, dt, before)
    return draw(walls), state


def _follow(
    data: dict[str, Any], settings: SurfaceSettings, dt: float, before: _State | None
) -> tuple[Callable[[Sequence[TriangleMesh]], dict[str, Any]], _State]:
    """Spray and foam of a frame, which follow from the frame before: what the next takes over, and what draws this one between walls."""
    position, velocity = data["particle/position"].astype(np.float64), data["particle/velocity"].astype(np.float64)
    identity, spacing = data["particle/id"], settings.spacing
    around: Surroundings = surroundings(position, velocity, spacing)
    was = np.isin(identity, before.spray) if before is not None else np.zeros(len(identity), dtype=bool)
    spray = foam.spray_of(around.count, clumps(position, spacing), was)
    state, amount = foam.grow_foam(identity, velocity, around, ~spray, before.foam if before is not None else None, dt)

    def draw(walls: Sequence[TriangleMesh]) -> dict[str, Any]:
        channels, records = _meshes(data, position, ~spray, settings, walls)
        records["spray_volume"] = float(data["particle/volume"][spray].sum(dtype=np.float64))
        channels |= {
            "origin": np.asarray(data["origin"], dtype=np.float64),
            "spray/position": data["particle/position"][spray],
            "spray/velocity": data["particle/velocity"][spray],
            "spray/volume": data["particle/volume"][spray],
            "spray/fluid": data["particle/fluid"][spray],
            "spray/id": identity[spray],
            "foam/position": _bubbles(data, position, around.normal, amount, settings, walls),
            "foam/id": state.identity,
            "foam/amount": state.amount,
        }
        if "particle/temperature" in data:
            channels["spray/temperature"] = data["particle/temperature"][spray]
        return channels | {f"record/{k}": np.float64(v) for k, v in records.items()}

    return draw, _State(identity[spray], state)


def _recipe(settings: SurfaceSettings) -> dict[str, Any]:
    versions = {"pysplashsurf": version("pysplashsurf")}
    recipe = digest_of(asdict(settings), versions, source_digest(Path(__file__).parent))
    return {"recipe": recipe, "settings": asdict(settings), "versions": versions, "spacing": settings.spacing}


def _trusted(reader: LiquidSurface, recipe: str, frames: int) -> tuple[int, _State | None]:
    """Frames at the start that are there, whole and of these particles, and what the last of them left."""
    state = None
    try:
        if reader.about()["recipe"] != recipe:
            return 0, None
    except (EvidenceError, KeyError):
        return 0, None
    for frame in range(min(reader.count(), frames)):
        try:
            found = reader.read(frame)
        except EvidenceError:
            return frame, state
        state = _State(found["spray/id"], foam.FoamState(found["foam/id"], found["foam/amount"]))
    return min(reader.count(), frames), state


def mesh_surfaces(
    cache: Cache,
    *,
    settings: SurfaceSettings | None = None,
    progress: Callable[[int, int, str], None] | None = None,
    check: Callable[[], None] | None = None,
    walls: Walls | None = None,
) -> LiquidSurface:
    """Make the surface, spray and foam of every frame of a complete cache, resuming what is there.

    Args:
        cache: of a liquid instance.
        settings: how; default `default_settings(cache)`.
        progress: called with (done, total, message).
        check: called between frames; raises to stop.
        walls: world meshes of what holds the liquid, at a frame; its surface is laid onto them.

    Raises:
        EvidenceError: particles are missing or altered.
        InputError: no frame holds a particle.
    """
    settings = settings or default_settings(cache)
    made, about = LiquidSurface(cache), _recipe(settings)
    digests = cache.digests()
    start, state = _trusted(made, about["recipe"], cache.index.frames)

    drawn: deque[Future[dict[str, Any]]] = deque()

    def follow(frame: int) -> Future[dict[str, Any]]:
        nonlocal state
        data = cache.read(frame)
        if digest_arrays(data) != digests[frame]:
            raise EvidenceError(f"particles of {cache.folder.name!r} at frame {frame} were altered; bake again")
        draw, state = _follow(data, settings, 1.0 / cache.index.fps, state)
        return pool.submit(draw, walls(frame) if walls is not None else ())

    def make(frame: int) -> tuple[dict[str, Any], frozenset[str]]:
        for ahead in range(frame + len(drawn), min(frame + AHEAD, cache.index.frames)):
            drawn.append(follow(ahead))
        channels = drawn.popleft().result()
        return channels, frozenset({"surface", "surface heat"} if "surface/temperature" in channels else {"surface"})

    with ThreadPoolExecutor(min(AHEAD, cores())) as pool:
        make_frames(made, start, make, about, progress=progress, check=check)
    return LiquidSurface(cache)
