"""Seeded defects of scale: wrong sizes in all disguises, and right sizes that look wrong."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...verifiers.scene.bounds import FACETS, LARGEST, NOMINAL_FACTOR, SCENERY, SPECK
from ...verifiers.scene.ratios import RATIOS
from ...worlds.arrays import F64
from ...worlds.built import BuiltEntity, BuiltPart, TriangleMesh
from ...worlds.spec import (
    Adjacent,
    Box,
    BoxRegion,
    Capsule,
    Connects,
    Contains,
    Cylinder,
    Entity,
    Fastened,
    Interacts,
    Limits,
    Mesh,
    Part,
    Rope,
    Sphere,
    Supports,
    Wedge,
)
from ..worlds.small_worlds import ball, box, build, entity, ground, make_candidate, mesh_of, pose, world
from ._masses import (
    heavier_than_its_volume,
    hidden_core,
    hidden_dowel,
    lighter_than_its_volume,
    lump_in_a_box,
    lump_in_a_mesh,
    lump_in_an_open_box,
    of_its_volume,
    thin_shell,
    void_in_a_mesh,
    wood_in_a_box,
)
from .cases import Mechanism, Suite, World

__all__ = ["SUITE"]

TOLERANCE = 0.01
RNG = np.random.Generator


def _size(rng: RNG, low: float = 0.05, high: float = 3.0) -> F64:
    return np.exp(rng.uniform(np.log(low), np.log(high), 3))


def _place(rng: RNG) -> dict[str, Any]:
    """Near or far from the origin, turned at will."""
    reach = float(rng.choice([1.0, 100.0, 1e5]))
    return {"at": tuple(rng.uniform(-reach, reach, 3)), "euler": tuple(rng.uniform(-3, 3, 3))}


def _crowd(rng: RNG) -> dict[str, Entity]:
    """Sound things of other sizes."""
    return {f"other{k}": box(*_size(rng), at=(5.0 * k, 40.0, 0.0)) for k in range(int(rng.integers(0, 25)))}


def _judged(folder: Path, rng: RNG, thing: Entity, *, culprit: bool, built: BuiltEntity | None = None, **more: Any) -> World:
    """A world with `thing` somewhere among others."""
    crowd = list(_crowd(rng).items())
    crowd.insert(int(rng.integers(len(crowd) + 1)), ("thing", thing))
    spec = world(dict(crowd), **more)
    return World(make_candidate(folder, spec, built={"thing": built} if built else None), ("thing",) if culprit else ())


def _as_mesh(vertices: F64, faces: Any) -> Mesh:
    return Mesh(vertices=[tuple(v) for v in vertices.tolist()], faces=[tuple(f) for f in np.asarray(faces).tolist()])


def _remade(thing: Entity, part: str, change: Any) -> BuiltEntity:
    """The built entity with one part's visible mesh changed; None as the new mesh leaves the part out."""
    made = build(world({"thing": thing}), "thing")
    parts: list[BuiltPart] = []
    for p in made.parts:
        mesh = change(p.render) if p.part == part else p.render
        if mesh is not None:
            parts.append(replace(p, render=mesh))
    return replace(made, parts=tuple(parts))


# ---------------------------------------------------------------- broken


def _one_axis(folder: Path, m: float, rng: RNG) -> World:
    size, axis = _size(rng), int(rng.integers(3))
    wrong = size.copy()
    wrong[axis] *= 1.0 + m if m >= 1.0 or rng.random() < 0.5 else 1.0 - m
    return _judged(folder, rng, box(*wrong, size=size, **_place(rng)), culprit=True)


def _turned_part(folder: Path, m: float, rng: RNG) -> World:
    """The contract counts the part's rotation wrongly: a rod at an angle, measured along itself."""
    length, angle = float(rng.uniform(0.3, 3.0)), float(rng.uniform(0.2, 1.3))
    thick = 0.02 * length
    part = Part(shape=Box(size=(length, thick, thick)), pose=pose((0, 0, 0), euler=(0, 0, angle)))
    right = np.array([length * np.cos(angle) + thick * np.sin(angle), length * np.sin(angle) + thick * np.cos(angle), thick])
    wrong = right.copy()
    wrong[int(rng.integers(2))] *= 1.0 / (1.0 + m)
    return _judged(folder, rng, entity(part, size=wrong.tolist(), **_place(rng)), culprit=True)


def _swapped(folder: Path, m: float, rng: RNG) -> World:
    a, c = (float(s) for s in _size(rng)[:2])
    size = np.array([a, a * (1.0 + m), c])
    order = rng.permutation(3)
    swap = np.argsort(order)[:2]  # where the two unlike edges went
    wanted = size[order]
    wrong = wanted.copy()
    wrong[swap[0]], wrong[swap[1]] = wanted[swap[1]], wanted[swap[0]]
    return _judged(folder, rng, box(*wrong, size=wanted.tolist(), **_place(rng)), culprit=True)


def _wrong_unit(folder: Path, m: float, rng: RNG) -> World:
    """An imported mesh in millimetres, inches or the like: open, inside out or sound."""
    size = _size(rng)
    source = mesh_of(Wedge(size=tuple(size)))
    factor = m if rng.random() < 0.5 else 1.0 / m
    faces = source.faces
    kind = int(rng.integers(3))
    if kind == 0:
        faces = faces[:, ::-1]
    elif kind == 1:
        faces = faces[:-1]
    return _judged(
        folder, rng, entity(_as_mesh(source.vertices * factor, faces), size=size.tolist(), **_place(rng)), culprit=True
    )


def _with_dust(mesh: TriangleMesh, corner: F64, kind: int) -> TriangleMesh:
    """The mesh and dust that reaches out to `corner`: a vertex, a sliver without area, or a loose speck."""
    n, size = len(mesh.vertices), float(np.ptp(mesh.vertices, axis=0).max())
    if kind == 0:
        return TriangleMesh(np.vstack([mesh.vertices, corner]), mesh.faces)
    if kind == 1:
        extra, face = np.array([corner, corner]), [[0, n, n + 1]]
    else:
        speck = 1e-2 * np.sqrt(SPECK) * size
        extra, face = corner + speck * np.array([[0, 0, 0], [-1, 0, 0], [0, -1, 0]]), [[n, n + 1, n + 2]]
    return TriangleMesh(np.vstack([mesh.vertices, extra]), np.vstack([mesh.faces, np.array(face, dtype=np.int32)]))


def _stray_vertex(folder: Path, m: float, rng: RNG) -> World:
    """Too small, but a stray vertex, sliver or speck gives the box the size of the contract."""
    wanted = _size(rng)
    axis = int(rng.integers(3))
    small = wanted.copy()
    small[axis] *= 1.0 - m
    mesh = mesh_of(Box(size=tuple(small)))
    mesh = replace(mesh, vertices=mesh.vertices - 0.5 * (wanted - small))
    dusty = _with_dust(mesh, 0.5 * wanted, int(rng.integers(3)))
    thing = entity(_as_mesh(dusty.vertices, dusty.faces), size=wanted.tolist(), **_place(rng))
    return _judged(folder, rng, thing, culprit=True)


def _table(rng: RNG, leg: float) -> Entity:
    """A board on four legs of width `leg`, with a drawer between them."""
    x, y, z = _size(rng, 0.4, 2.0)
    legs = [
        Part(shape=Box(size=(leg, leg, z)), pose=pose((sx * (x - leg) / 2, sy * (y - leg) / 2, -z / 2)))
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    board = Part(shape=Box(size=(x, y, 0.1 * z)), pose=pose((0, 0, 0.05 * z)))
    drawer = Part(shape=Box(size=(0.4 * x, 0.3 * y, 0.2 * z)), pose=pose((0.1 * x, 0, -0.11 * z), euler=(0, 0, 0.3)))
    return entity(board, drawer, *legs, **_place(rng))


def _missing_part(folder: Path, m: float, rng: RNG) -> World:
    """A part was not constructed; those left often give the right box."""
    table = _table(rng, m * 0.2)
    lost = f"p{rng.integers(0, 6)}"
    return _judged(folder, rng, table, culprit=True, built=_remade(table, lost, lambda _: None))


def _inner_part(folder: Path, m: float, rng: RNG) -> World:
    """The drawer inside the table is larger or smaller than its shape says."""
    table = _table(rng, 0.05)
    # Its corners move by half of what the edge grows.
    factor = 1.0 - 2.0 * m if m < 0.45 and rng.random() < 0.5 else 1.0 + 2.0 * m

    def change(mesh: TriangleMesh) -> TriangleMesh:
        middle = 0.5 * (mesh.vertices.min(axis=0) + mesh.vertices.max(axis=0))
        return replace(mesh, vertices=middle + factor * (mesh.vertices - middle))

    return _judged(folder, rng, table, culprit=True, built=_remade(table, "p1", change))


def _displaced_part(folder: Path, m: float, rng: RNG) -> World:
    """The drawer lies elsewhere within the box of the table."""
    table = _table(rng, 0.05)
    axis = int(rng.integers(2))

    def change(mesh: TriangleMesh) -> TriangleMesh:
        shift = np.zeros(3)
        shift[axis] = -m * np.ptp(mesh.vertices[:, axis])
        return replace(mesh, vertices=mesh.vertices + shift)

    return _judged(folder, rng, table, culprit=True, built=_remade(table, "p1", change))


def _flattened(folder: Path, m: float, rng: RNG) -> World:
    """Construction lost height: the mesh is flatter than its shape, down to nothing."""
    thing = entity(Sphere(radius=float(rng.uniform(0.05, 2.0))), tolerance=TOLERANCE, **_place(rng))
    axis = int(rng.integers(3))

    def change(mesh: TriangleMesh) -> TriangleMesh:
        scale = np.ones(3)
        scale[axis] = 1.0 - m
        return replace(mesh, vertices=mesh.vertices * scale)

    return _judged(folder, rng, thing, culprit=True, built=_remade(thing, "p0", change))


def _not_a_number(folder: Path, m: float, rng: RNG) -> World:
    thing = box(*_size(rng), **_place(rng))

    def change(mesh: TriangleMesh) -> TriangleMesh:
        vertices = mesh.vertices.copy()
        vertices[int(rng.integers(len(vertices))), int(rng.integers(3))] = np.nan if m < 2 else np.inf
        return replace(mesh, vertices=vertices)

    return _judged(folder, rng, thing, culprit=True, built=_remade(thing, "p0", change))


RELATIONS: dict[str, Any] = {"supports": Supports, "contains": Contains, "adjacent": Adjacent, "interacts": Interacts}


def _related(folder: Path, rng: RNG, kind: str, of: float, *, culprit: bool, **fields: Any) -> World:
    """Two dynamic cubes whose diagonals stand in the ratio `of` a / b."""
    b = float(10.0 ** rng.uniform(-2.5, 0.5))
    b = min(max(b, 3e-4 / of), 3e3 / of)
    a = of * b
    things = {**_crowd(rng), "a": box(a, a, a, motion="dynamic"), "b": box(b, b, b, motion="dynamic", at=(5e3, 0, 0))}
    if kind == "fastened":
        relation: Any = Fastened(a="a", b="b", max_depth=0.01, reason="glued for this test", **fields)
    elif kind == "connects":
        regions = {n: BoxRegion(min=(-s / 2, -s / 2, 0), max=(s / 2, s / 2, s)) for n, s in (("ra", a), ("rb", b))}
        relation = Connects(a="ra", b="rb", **fields)
        spec = world(things, regions=regions, relations={"rel": relation})
        return World(make_candidate(folder, spec), ("rel",) if culprit else ())
    else:
        relation = RELATIONS[kind](a="a", b="b", **fields)
    return World(make_candidate(folder, world(things, relations={"rel": relation})), ("rel",) if culprit else ())


def _bounds(kind: str) -> tuple[float, float]:
    low, high = Limits().scale_ratio
    return max(low, RATIOS[kind].low or low), min(high, RATIOS[kind].high or high)


def _out_of_proportion(folder: Path, m: float, rng: RNG) -> World:
    kind = str(rng.choice(sorted(RATIOS)))
    low, high = _bounds(kind)
    return _related(folder, rng, kind, low / (1.0 + m) if rng.random() < 0.5 else high * (1.0 + m), culprit=True)


def _against_the_contract(folder: Path, m: float, rng: RNG) -> World:
    """The relation itself states the proportion, tighter than any default."""
    kind = str(rng.choice(sorted(RATIOS)))
    middle = float(10.0 ** rng.uniform(-0.5, 1.5))
    span = float(rng.uniform(1.05, 3.0))
    ratio = middle * span * (1.0 + m) if rng.random() < 0.5 else middle / span / (1.0 + m)
    return _related(folder, rng, kind, ratio, culprit=True, ratio=(middle / span, middle * span))


def _not_its_role(folder: Path, m: float, rng: RNG) -> World:
    """Contract and geometry agree, both in the wrong unit; only the role tells."""
    size = _size(rng)
    factor = m if rng.random() < 0.5 else 1.0 / m
    thing = box(*size, nominal_diagonal=float(np.linalg.norm(size)) / factor, **_place(rng))
    return _judged(folder, rng, thing, culprit=True)


def _absurd(folder: Path, m: float, rng: RNG) -> World:
    shape = np.array([1.0, *rng.uniform(0.2, 1.0, 2)])
    shape *= m / np.linalg.norm(shape)
    return _judged(folder, rng, box(*shape), culprit=True)


# ---------------------------------------------------------------- clean


def _nearly_off(folder: Path, m: float, rng: RNG) -> World:
    size = _size(rng)
    tolerance = float(rng.choice([TOLERANCE, 0.05, 0.002]))
    thing = box(*(size * (1.0 + tolerance * m * rng.uniform(-1, 1, 3))), size=size, tolerance=tolerance, **_place(rng))
    return _judged(folder, rng, thing, culprit=False)


def _turned_parts(folder: Path, m: float, rng: RNG) -> World:
    """Round and square parts at angles; the contract comes from their support functions."""
    parts, low, high = [], np.full(3, np.inf), np.full(3, -np.inf)
    for _ in range(int(rng.integers(1, 6))):
        angles, at = rng.uniform(-3, 3, 3), rng.uniform(-m, m, 3)
        part = Part(shape=Box(size=tuple(_size(rng, 0.05 * m, m))), pose=pose(at.tolist(), euler=angles.tolist()))
        cx, cy, cz, sx, sy, sz = *np.cos(angles), *np.sin(angles)
        turn = (
            np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
            @ np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
            @ np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
        )
        half = np.abs(turn) @ (0.5 * np.array(part.shape.size))  # type: ignore[union-attr]
        low, high = np.minimum(low, at - half), np.maximum(high, at + half)
        parts.append(part)
    return _judged(folder, rng, entity(*parts, size=(high - low).tolist(), tolerance=1e-6, **_place(rng)), culprit=False)


def _facetted(folder: Path, m: float, rng: RNG) -> World:
    """Round parts drawn by facets fall short of their radius by up to 1.9 %, within a contract that allows for it."""
    turned = pose((0, 0, 0), euler=(float(rng.uniform(0, 3)), 0, 0))
    shapes = [Sphere(radius=m), Cylinder(radius=m, height=0.5 * m), Capsule(radius=m, length=2 * m)]
    part = Part(shape=shapes[int(rng.integers(3))], pose=turned)
    return _judged(folder, rng, entity(part, tolerance=0.02, **_place(rng)), culprit=False)


def _harmless_dust(folder: Path, m: float, rng: RNG) -> World:
    """Right in size; a stray vertex, sliver or speck lies far outside. Inside out or open as well."""
    wanted = _size(rng)
    mesh = mesh_of(Box(size=tuple(wanted)))
    mesh = replace(mesh, faces=mesh.faces[:, ::-1] if rng.random() < 0.5 else mesh.faces[:-1])
    dusty = _with_dust(mesh, (0.5 + m) * wanted, int(rng.integers(3)))
    thing = entity(_as_mesh(dusty.vertices, dusty.faces), size=wanted.tolist(), **_place(rng))
    return _judged(folder, rng, thing, culprit=False)


def _nearly_out_of_proportion(folder: Path, m: float, rng: RNG) -> World:
    kind = str(rng.choice(sorted(RATIOS)))
    low, high = _bounds(kind)
    return _related(folder, rng, kind, low / m if rng.random() < 0.5 else high * m, culprit=False)


def _excused(folder: Path, m: float, rng: RNG) -> World:
    """Far outside the defaults, but the relation says so."""
    kind = str(rng.choice(sorted(RATIOS)))
    low, high = _bounds(kind)
    ratio = low / m if rng.random() < 0.5 else high * m
    return _related(folder, rng, kind, ratio, culprit=False, ratio=(0.9 * ratio, 1.1 * ratio))


def _pebble_on_terrain(folder: Path, m: float, rng: RNG) -> World:
    extent = float(10.0 ** rng.uniform(1.0, 2.3))
    floor = ground(extent)
    big = float(np.linalg.norm(floor.dimensions.size))
    radius = max(big / (m * SCENERY) / (2.0 * np.sqrt(3.0)), 1e-4)
    things = {"floor": floor, "pebble": ball(radius, motion="dynamic", at=(0, 0, radius))}
    relations: dict[str, Any] = {"on": Supports(a="floor", b="pebble"), "hit": Interacts(a="pebble", b="floor")}
    return World(make_candidate(folder, world(things, relations=relations)))


def _usual_for_its_role(folder: Path, m: float, rng: RNG) -> World:
    size = _size(rng)
    factor = m if rng.random() < 0.5 else 1.0 / m
    thing = box(*size, nominal_diagonal=float(np.linalg.norm(size)) / factor, **_place(rng))
    return _judged(folder, rng, thing, culprit=False)


def _extremes(folder: Path, m: float, rng: RNG) -> World:
    """A rope of many bodies, a sheet as thin as foil, and a thing as small as a grain."""
    rope = Rope(points=[(0, 0, 0), (0, 0, -100 * m)], radius=m, segments=12)
    things = {
        "rope": entity(rope=rope, motion="dynamic", size=(2 * m, 2 * m, 102 * m), tolerance=0.02, at=(3, 0, 0)),
        "foil": box(100 * m, 50 * m, 0.01 * m, **_place(rng)),
        "grain": ball(0.2 * m, motion="dynamic", at=(1, 1, 1)),
    }
    return World(make_candidate(folder, world(things)))


def _many_parts(folder: Path, m: float, rng: RNG) -> World:
    table = _table(rng, m)
    return _judged(folder, rng, table, culprit=False)


SUITE = Suite(
    "scale",
    (
        Mechanism("one axis", "one edge differs from the contract", True, _one_axis, 0.0101, 100.0, "1", bound=TOLERANCE),
        Mechanism("turned part", "the contract misjudges a turned part", True, _turned_part, 0.0102, 2.0, "1", bound=TOLERANCE),
        Mechanism("exchanged axes", "right lengths along wrong axes", True, _swapped, 0.0101, 50.0, "1", bound=TOLERANCE),
        Mechanism("wrong unit", "an import in millimetres, inches or feet", True, _wrong_unit, 1.02, 1000.0, "1"),
        Mechanism(
            "stray vertex", "dust gives a small thing the right box", True, _stray_vertex, 0.0101, 0.95, "1", bound=TOLERANCE
        ),
        Mechanism("missing part", "a part was not constructed", True, _missing_part, 0.01, 1.0, "1"),
        Mechanism("inner part", "a part inside the box has a wrong size", True, _inner_part, 0.0202, 5.0, "1", bound=FACETS),
        Mechanism("displaced part", "a part inside lies elsewhere", True, _displaced_part, 0.0202, 0.4, "1", bound=FACETS),
        Mechanism("flattened", "the mesh is flatter than its shape", True, _flattened, 0.0101, 1.0, "1", bound=TOLERANCE),
        Mechanism("not a number", "a vertex is not finite", True, _not_a_number, 1.0, 3.0, "1"),
        Mechanism(
            "out of proportion", "related things beyond the default ratio", True, _out_of_proportion, 0.001, 100.0, "1", bound=0.0
        ),
        Mechanism(
            "against its contract",
            "related things beyond the declared ratio",
            True,
            _against_the_contract,
            0.001,
            30.0,
            "1",
            bound=0.0,
        ),
        Mechanism(
            "not its role",
            "consistent, but unlike its role",
            True,
            _not_its_role,
            1.001 * NOMINAL_FACTOR,
            1000.0,
            "1",
            bound=NOMINAL_FACTOR,
        ),
        Mechanism("too light", "steel of a milligram", True, lighter_than_its_volume, 1.03, 1e8, "1", bound=1.0),
        Mechanism("too heavy", "more than its volume holds", True, heavier_than_its_volume, 1.03, 1e3, "1", bound=1.0),
        Mechanism("hidden core", "a heavy core that no camera sees", True, hidden_core, 0.11, 5.0, "1", bound=0.1),
        Mechanism("lump in a box", "steel shut into a box of boards", True, lump_in_a_box, 0.11, 3.0, "1", bound=0.1),
        Mechanism("lump in a mesh", "a lump inside the mesh of a block", True, lump_in_a_mesh, 0.12, 0.9, "1", bound=0.1),
        Mechanism("lump in an open box", "steel in a box that is half open", False, lump_in_an_open_box, 0.11, 3.0, "1"),
        Mechanism("wood in a box", "wood shut into a box of boards", False, wood_in_a_box, 0.11, 3.0, "1"),
        Mechanism("void in a mesh", "a void inside the mesh of a block", False, void_in_a_mesh, 0.12, 0.9, "1"),
        Mechanism("hidden dowel", "a nail or dowel inside", False, hidden_dowel, 0.001, 0.09, "1"),
        Mechanism("of its volume", "a mass of its own, in the range", False, of_its_volume, 0.001, 1.0, "1"),
        Mechanism("thin shell", "hollow, and says so", False, thin_shell, 1.05, 10.0, "1"),
        Mechanism("absurd", "larger than a mountain", True, _absurd, 1.001 * LARGEST, 100.0 * LARGEST, "m", bound=LARGEST),
        Mechanism("nearly off", "just within its tolerance", False, _nearly_off, 0.5, 0.999, "1"),
        Mechanism("turned parts", "many parts at angles, exactly right", False, _turned_parts, 0.05, 5.0, "m"),
        Mechanism("facets", "round parts drawn by facets", False, _facetted, 0.01, 5.0, "m"),
        Mechanism("harmless dust", "a stray vertex far outside a sound mesh", False, _harmless_dust, 0.01, 100.0, "1"),
        Mechanism("in proportion", "just within the default ratio", False, _nearly_out_of_proportion, 0.5, 0.999, "1"),
        Mechanism("excused", "extreme, as its contract says", False, _excused, 1.1, 100.0, "1"),
        Mechanism("pebble on terrain", "scenery of 200 m carries a pebble", False, _pebble_on_terrain, 0.1, 0.999, "1"),
        Mechanism(
            "usual for its role", "just within a factor of 3", False, _usual_for_its_role, 1.0, 0.999 * NOMINAL_FACTOR, "1"
        ),
        Mechanism("extremes", "rope, foil and grain", False, _extremes, 0.002, 0.2, "m"),
        Mechanism("many parts", "legs thin as wires, or touching", False, _many_parts, 0.002, 0.19, "m"),
    ),
)
"""Worlds of the check `scale`."""
