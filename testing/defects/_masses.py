"""Bodies that weigh what their volume of their substance does not, and odd ones that do, for the seeded defects of scale."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...worlds.materials import DENSITY_RANGES
from ...worlds.spec import Box, Cylinder, Entity, Material, Mesh, Part, Pose, RigidPhysics, Shape, Sphere
from ...worlds.weights import LEAST_WALL
from ..worlds.small_worlds import entity, make_candidate, mesh_of, world
from .cases import World

__all__ = [
    "heavier_than_its_volume",
    "hidden_core",
    "hidden_dowel",
    "lighter_than_its_volume",
    "lump_in_a_box",
    "lump_in_a_mesh",
    "lump_in_an_open_box",
    "of_its_volume",
    "thin_shell",
    "void_in_a_mesh",
    "wood_in_a_box",
]

RNG = np.random.Generator
SUBSTANCES = ("steel", "wood", "stone", "rubber", "plastic", "ice", "aluminium")


def _body(rng: RNG) -> tuple[Entity, float]:
    """A free body and its volume [m^3]."""
    a, b, c = (float(x) for x in np.exp(rng.uniform(np.log(0.03), np.log(1.0), 3)))
    shapes: tuple[tuple[Shape, float], ...] = (
        (Box(size=(a, b, c)), a * b * c),
        (Sphere(radius=a), 4 / 3 * np.pi * a**3),
        (Cylinder(radius=a, height=b), np.pi * a * a * b),
    )
    shape, volume = shapes[int(rng.integers(3))]
    return entity(shape, motion="dynamic"), float(volume)


def _world(folder: Path, body: Entity, substance: str, mass: float, *culprits: str, hollow: bool = False) -> World:
    low, high = DENSITY_RANGES[substance]
    material = Material(density=0.5 * (low + high), substance=substance)
    own = body.model_copy(update={"physics": RigidPhysics(mass=mass, hollow=hollow), "material": "own"})
    spec = world({"body": own}, materials={"own": material, **world({"body": body}).materials})
    return World(make_candidate(folder, spec), culprits)


def lighter_than_its_volume(folder: Path, m: float, rng: RNG) -> World:
    """Steel of a milligram; with a mass so many times less than the lightest of its substance."""
    body, volume = _body(rng)
    substance = str(rng.choice(SUBSTANCES))
    return _world(folder, body, substance, volume * DENSITY_RANGES[substance][0] / m, "body")


def heavier_than_its_volume(folder: Path, m: float, rng: RNG) -> World:
    """A feather of tons."""
    body, volume = _body(rng)
    substance = str(rng.choice(SUBSTANCES))
    return _world(folder, body, substance, volume * DENSITY_RANGES[substance][1] * m, "body")


def of_its_volume(folder: Path, m: float, rng: RNG) -> World:
    """A mass somewhere in the range of its substance."""
    body, volume = _body(rng)
    substance = str(rng.choice(SUBSTANCES))
    low, high = DENSITY_RANGES[substance]
    return _world(folder, body, substance, volume * (low + m * (high - low)))


def thin_shell(folder: Path, m: float, rng: RNG) -> World:
    """A can or a ball around air that says so, with a wall so many times thicker than the thinnest."""
    radius = float(rng.uniform(0.02, 0.3))
    shell = 4 * np.pi * radius**2 * LEAST_WALL * m
    body = entity(Sphere(radius=radius), motion="dynamic")
    return _world(folder, body, "aluminium", shell * DENSITY_RANGES["aluminium"][1], hollow=True)


def _with_core(folder: Path, share: float, rng: RNG, *culprits: str) -> World:
    """A wooden block with a steel block in its middle that weighs a share of it."""
    side, wood, steel = float(rng.uniform(0.05, 0.5)), 600.0, 7850.0
    inner = side * (share * wood / steel) ** (1 / 3)
    parts = {"body": Part(shape=Box(size=(side,) * 3)), "core": Part(shape=Box(size=(inner,) * 3), material="core")}
    body = entity(Box(size=(side,) * 3), motion="dynamic").model_copy(update={"parts": parts, "material": "own"})
    materials = {"own": Material(density=wood, substance="wood"), "core": Material(density=steel, substance="steel")}
    spec = world({"body": body}, materials=materials)
    return World(make_candidate(folder, spec), culprits)


def hidden_core(folder: Path, m: float, rng: RNG) -> World:
    """A heavy core that no camera sees."""
    return _with_core(folder, m, rng, "body")


def hidden_dowel(folder: Path, m: float, rng: RNG) -> World:
    """A nail or dowel inside."""
    return _with_core(folder, m, rng)


def _boxed(folder: Path, m: float, rng: RNG, *culprits: str, lid: bool = True, content: str = "core") -> World:
    """A box of six boards, the lid whole or a half, with a lump on its floor that weighs m times what they do."""
    side, thick, wood, steel = float(rng.uniform(0.3, 0.6)), 0.02, 600.0, 7850.0
    inner = side - 2 * thick
    boards = {
        "floor": ((side, side, thick), (0, 0, (thick - side) / 2)),
        "lid": ((side, side, thick), (0, 0, (side - thick) / 2)),
        "left": ((thick, side, inner), ((thick - side) / 2, 0, 0)),
        "right": ((thick, side, inner), ((side - thick) / 2, 0, 0)),
        "front": ((inner, thick, inner), (0, (thick - side) / 2, 0)),
        "back": ((inner, thick, inner), (0, (side - thick) / 2, 0)),
    }
    if not lid:
        boards["lid"] = ((side / 2, side, thick), (-side / 4, 0, (side - thick) / 2))
    weight = m * sum(float(np.prod(size)) for size, _ in boards.values()) * wood
    edge = min((weight / (steel if content == "core" else wood)) ** (1 / 3), 0.95 * inner)
    parts = {name: Part(shape=Box(size=size), pose=Pose(position=at)) for name, (size, at) in boards.items()}
    lump = Pose(position=(0, 0, (edge - inner) / 2))
    parts = {"content": Part(shape=Box(size=(edge,) * 3), material=content, pose=lump), **parts}
    body = entity(Box(size=(side,) * 3), motion="dynamic").model_copy(update={"parts": parts, "material": "own"})
    materials = {"own": Material(density=wood, substance="wood"), "core": Material(density=steel, substance="steel")}
    return World(make_candidate(folder, world({"body": body}, materials=materials)), culprits)


def lump_in_a_box(folder: Path, m: float, rng: RNG) -> World:
    """A lump of steel shut into a box of boards."""
    return _boxed(folder, m, rng, "body")


def lump_in_an_open_box(folder: Path, m: float, rng: RNG) -> World:
    """A lump of steel in a box that is half open."""
    return _boxed(folder, m, rng, lid=False)


def wood_in_a_box(folder: Path, m: float, rng: RNG) -> World:
    """A lump of wood shut into a box of boards, which is no heavier than a block of wood."""
    return _boxed(folder, m, rng, content="own")


def _mesh_in_a_mesh(folder: Path, m: float, rng: RNG, *culprits: str, void: bool = False) -> World:
    """A block of one mesh with a second surface within it: a lump of m times its volume, or a void."""
    side = float(rng.uniform(0.05, 0.5))
    outer, inner = (mesh_of(Box(size=(s,) * 3)) for s in (side, side * m ** (1 / 3)))
    faces = inner.faces[:, ::-1] if void else inner.faces
    points, corners = np.concatenate([outer.vertices, inner.vertices]), np.concatenate([outer.faces, faces + len(outer.vertices)])
    shape = Mesh(vertices=[tuple(v) for v in points.tolist()], faces=[tuple(f) for f in corners.tolist()])
    body = entity(shape, motion="dynamic").model_copy(update={"material": "own"})
    spec = world({"body": body}, materials={"own": Material(density=600.0, substance="wood")})
    return World(make_candidate(folder, spec), culprits)


def lump_in_a_mesh(folder: Path, m: float, rng: RNG) -> World:
    """A lump inside the one mesh of a block, whose volume counts twice."""
    return _mesh_in_a_mesh(folder, m, rng, "body")


def void_in_a_mesh(folder: Path, m: float, rng: RNG) -> World:
    """A void inside the one mesh of a block, which makes it lighter."""
    return _mesh_in_a_mesh(folder, m, rng, void=True)
