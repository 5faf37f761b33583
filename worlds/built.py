"""Built entities: the geometry that construction makes and everybody else reads (R54).

A built entity lies in its own frame. `bodies` are what a solver moves: an ordinary entity has one, named
`body`; a rope has one per segment. Each part belongs to one body; part geometry is in the *body's* frame, and a
body's frame at frame 0 is `entity pose o body.pose`. A breakable entity has one body per piece, and bonds.
"""

from __future__ import annotations

import hashlib
import io
import json
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from pathlib import Path
from typing import Any

import numpy as np

from .arrays import F64, I32, RigidPose
from .bonds import Bonds, bond_arrays, bonds_from
from .cache import DAMAGE, array_of, read_array
from .errors import EvidenceError
from .folder import write_atomically
from .simulation_mesh import SimulationMesh, mesh_arrays, mesh_from
from .stored_zip import stored_members, stored_zip

__all__ = ["BuiltBody", "BuiltEntity", "BuiltPart", "Convex", "TriangleMesh", "load_built", "save_built"]


KEPT_BYTES = 200_000
"""Own choice: parts of more bytes are written anew each time, so that no landscape is held twice."""
READ_AT_ONCE = 20_000_000
"""[bytes] Own choice: larger files are read array by array, so that no landscape is held twice."""


@dataclass(frozen=True)
class TriangleMesh:
    """Triangle mesh: vertices [m], shape (n, 3); faces, shape (m, 3), counter-clockwise seen from outside."""

    vertices: F64
    faces: I32


@dataclass(frozen=True)
class Convex:
    """One convex collision piece in the body's frame.

    `kind` is `box` (params: half extents), `sphere` (radius), `cylinder` (radius, half height), `capsule`
    (radius, half length), `hull` (vertices in `points`), or `heightfield` (params: half extents x, y; `points` is
    the height grid, shape (rows, cols), row 0 at -y, above the body's z = 0; base thickness is params[2]).
    """

    kind: str
    params: tuple[float, ...]
    pose: RigidPose
    points: F64


@dataclass(frozen=True)
class BuiltPart:
    """One part: visible surface, collision pieces and how far they differ."""

    part: str
    body: str
    material: str
    render: TriangleMesh
    """Visible surface, in the body's frame. This is the surface that the checks inspect."""
    collision: tuple[Convex, ...]
    closed: bool
    deviation: tuple[float, float]
    """[m] (largest distance of the collision surface outside the visible one, and of the visible outside it)."""
    smooth: bool
    """True if the renderer should interpolate normals."""
    simulation: SimulationMesh | None = None
    """Mesh that the solver of a deforming part moves; None for other parts."""

    @cached_property
    def _raw(self) -> dict[str, bytes]:
        return {name: _npy(array) for name, array in self._arrays().items()}

    def _arrays(self) -> dict[str, Any]:
        own = {"v": self.render.vertices, "f": self.render.faces, **{f"c{j}": c.points for j, c in enumerate(self.collision)}}
        return own if self.simulation is None else own | dict(mesh_arrays(self.simulation, "s"))

    def files(self) -> dict[str, bytes]:
        """Its arrays as files, by name; those of small parts are kept, which entities of one recipe share."""
        arrays = self._arrays()
        if sum(np.asarray(a).nbytes for a in arrays.values()) <= KEPT_BYTES:
            return self._raw
        return {name: _npy(array) for name, array in arrays.items()}


@dataclass(frozen=True)
class BuiltBody:
    """One rigid body of an entity, mass properties included."""

    name: str
    pose: RigidPose
    """In the entity's frame."""
    mass: float
    """[kg]"""
    center: F64
    """Centre of mass in the body's frame [m], shape (3,)."""
    inertia: F64
    """About the centre of mass, body axes [kg m^2], shape (3, 3)."""
    volume: float
    """[m^3]"""


@dataclass(frozen=True)
class BuiltEntity:
    """Everything geometric about one entity, independent of where it stands."""

    entity: str
    bodies: tuple[BuiltBody, ...]
    parts: tuple[BuiltPart, ...]
    recipe: str
    """Hash of what it was built from."""
    bonds: Bonds | None = None
    """Bonds between the bodies of a breakable entity; their order is that of the pieces."""

    def parts_of(self, body: str) -> tuple[BuiltPart, ...]:
        """Parts that belong to `body`."""
        return tuple(p for p in self.parts if p.body == body)

    def digest(self) -> str:
        """SHA-256 over the content (not the recipe), hex."""
        return self._digest

    @cached_property
    def _digest(self) -> str:
        return hashlib.sha256(stored_zip(_files_of(self))).hexdigest()

    def known(self, digest: str) -> BuiltEntity:
        """This entity, whose content has a digest that was worked out before, where it was saved or read."""
        self.__dict__["_digest"] = digest
        return self


def _pose_list(pose: RigidPose) -> list[float]:
    return [*map(float, pose.position), *map(float, pose.quaternion)]


def _pose_from(values: list[float]) -> RigidPose:
    return RigidPose(np.array(values[:3]), np.array(values[3:]))


def _npy(array: Any) -> bytes:
    held = np.ascontiguousarray(array)
    return _npy_header(held.dtype.str, held.shape) + held.tobytes()


@lru_cache(maxsize=4096)
def _npy_header(dtype: str, shape: tuple[int, ...]) -> bytes:
    """The header that `numpy.save` writes before the elements."""
    raw = io.BytesIO()
    np.lib.format.write_array_header_1_0(raw, {"descr": dtype, "fortran_order": False, "shape": shape})
    return raw.getvalue()


def _files_of(built: BuiltEntity) -> dict[str, bytes]:
    """Files of its archive by name, without the recipe."""
    files: dict[str, bytes] = {}
    parts = []
    for i, part in enumerate(built.parts):
        files |= {f"p{i}/{name}": raw for name, raw in part.files().items()}
        pieces = [{"kind": c.kind, "params": list(c.params), "pose": _pose_list(c.pose)} for c in part.collision]
        parts.append(
            {
                "part": part.part,
                "body": part.body,
                "material": part.material,
                "collision": pieces,
                "closed": part.closed,
                "deviation": list(part.deviation),
                "smooth": part.smooth,
            }
        )
        if part.simulation is not None:
            parts[-1]["deforms"] = True
    bodies = [
        {
            "name": b.name,
            "pose": _pose_list(b.pose),
            "mass": b.mass,
            "center": b.center.tolist(),
            "inertia": b.inertia.tolist(),
            "volume": b.volume,
        }
        for b in built.bodies
    ]
    bonds = {} if built.bonds is None else bond_arrays(built.bonds)
    files |= {f"bonds/{key}": _npy(value) for key, value in bonds.items()}
    meta = {"entity": built.entity, "bodies": bodies, "parts": parts, "recipe": ""}
    return {"meta.json": json.dumps(meta, sort_keys=True).encode(), **{name: files[name] for name in sorted(files)}}


_NO_RECIPE = b'"recipe": ""}'
"""End of `meta.json`, whose keys are sorted."""


def save_built(built: BuiltEntity, path: Path) -> None:
    """Write to `path` through a temporary name."""
    files = _files_of(built)
    built.known(hashlib.sha256(stored_zip(files)).hexdigest())
    files["meta.json"] = files["meta.json"].removesuffix(_NO_RECIPE) + f'"recipe": {json.dumps(built.recipe)}}}'.encode()
    write_atomically(path, stored_zip(files))


def load_built(path: Path, *, kept: dict[bytes, Any] | None = None, digest: str | None = None) -> BuiltEntity:
    """Read what `save_built` wrote.

    Args:
        path: of the file.
        kept: small arrays of entities read before, by content, which equal ones share; those of this one are added.
        digest: of its content, as whoever asks knows it; else it is worked out.

    Raises:
        EvidenceError: the file is missing or damaged.
    """
    try:
        if path.stat().st_size <= READ_AT_ONCE:
            members = stored_members(path.read_bytes())
            if members is not None:
                return _read_at_once(members, {} if kept is None else kept, digest)
        with zipfile.ZipFile(path) as archive:
            if archive.getinfo("meta.json").compress_type != zipfile.ZIP_STORED:
                raise ValueError("it is compressed, which no built entity is")
            meta = json.loads(archive.read("meta.json"))
            found = _entity_from(meta, archive.namelist(), partial(read_array, archive))
            return found if digest is None else found.known(digest)
    except DAMAGE as error:
        raise EvidenceError(
            f"built entity {path.name!r} is missing or damaged ({error}); run build_terrain or place_object again"
        ) from error


def _read_at_once(members: dict[str, bytes], kept: dict[bytes, Any], digest: str | None) -> BuiltEntity:
    """The entity of an archive whose files are all at hand, its digest worked out from them where they lie as `save_built` lays them."""

    def array(name: str) -> Any:
        raw = members[name]
        if len(raw) > KEPT_BYTES:
            return array_of(raw, name)
        if raw not in kept:
            kept[raw] = array_of(raw, name)
        return kept[raw]

    raw = members["meta.json"]
    meta = json.loads(raw)
    found = _entity_from(meta, list(members), array)
    if digest is not None:
        return found.known(digest)
    told = f'"recipe": {json.dumps(found.recipe)}}}'.encode()
    names = list(members)
    if raw.endswith(told) and names == ["meta.json", *sorted(names[1:])]:
        blank = {**members, "meta.json": raw.removesuffix(told) + _NO_RECIPE}
        found.known(hashlib.sha256(stored_zip(blank)).hexdigest())
    return found


def _entity_from(meta: dict[str, Any], names: list[str], array: Callable[[str], Any]) -> BuiltEntity:
    """An entity of its description, the names of its files, and what reads one of them."""
    parts = tuple(
        BuiltPart(
            part=p["part"],
            body=p["body"],
            material=p["material"],
            render=TriangleMesh(array(f"p{i}/v"), array(f"p{i}/f")),
            collision=tuple(
                Convex(c["kind"], tuple(c["params"]), _pose_from(c["pose"]), array(f"p{i}/c{j}"))
                for j, c in enumerate(p["collision"])
            ),
            closed=p["closed"],
            deviation=(p["deviation"][0], p["deviation"][1]),
            smooth=p["smooth"],
            simulation=mesh_from(array, f"p{i}/s") if p.get("deforms") else None,
        )
        for i, p in enumerate(meta["parts"])
    )
    bodies = tuple(
        BuiltBody(b["name"], _pose_from(b["pose"]), b["mass"], np.array(b["center"]), np.array(b["inertia"]), b["volume"])
        for b in meta["bodies"]
    )
    own = [n for n in names if n.startswith("bonds/")]
    bonds = bonds_from({n.removeprefix("bonds/"): array(n) for n in own}) if own else None
    return BuiltEntity(meta["entity"], bodies, parts, meta["recipe"], bonds)
