"""Elastic members of a MuJoCo instance: flexes with quadratic cells whose nodes are bodies on three slides each (R62)."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.arrays import F64, I64, RigidPose, pose_of
from ...worlds.built import BuiltPart
from ...worlds.errors import InputError
from ...worlds.simulation_mesh import volumes
from ...worlds.spec import ElasticPhysics, Pin, WorldSpec
from ..boundaries import MovingSurface
from ..elastic import Lattice
from .contact_law import IMPEDANCE
from .flex_contacts import AMONG
from .records import velocities

if TYPE_CHECKING:
    from ...worlds.built import BuiltEntity
    from .flex_fields import FlexFields

__all__ = [
    "SOLIMP",
    "FlexBody",
    "Flexes",
    "add_flex",
    "hear",
    "is_soft",
    "node_count",
    "pinned_nodes",
]

SOLIMP = (IMPEDANCE, IMPEDANCE, 0.001, 0.5, 2.0)
"""MuJoCo `solimp`: constant, so that a contact is the linear law of `contact_law`."""
NODE_INERTIA = 1e-9
"""[kg m^2] Nodes do not turn; the engine asks for an inertia all the same."""
LAYERS_FOR_SELF = 3
"""Cells along an axis from which on parts of one body can meet: the engine leaves out neighbouring cells."""
EIGEN_STEPS, EIGEN_MARGIN = 30, 1.05
"""Steps of a power iteration, which comes within some per cent from below, and the factor that covers the rest."""
TRAVEL_SHARE = 0.5
"""Own choice: a surface that moves farther per step than this share of its shortest edge may jump over another."""


@dataclass
class FlexBody:
    """One elastic entity of a model."""

    entity: str
    part: str
    physics: ElasticPhysics
    lattice: Lattice
    pose: RigidPose
    """Pose of the body's frame in the world, at rest."""
    masses: F64
    """At the nodes [kg], shape (n,)."""
    carriers: list[str]
    """Name of the MuJoCo body of each node; `world` of fixed ones and of those that carry nothing."""
    offsets: F64
    """Place of each node in its carrier's frame [m], shape (n, 3)."""
    body_ids: I64 = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    free: Any = None
    """Which nodes move by themselves, shape (n,)."""

    @cached_property
    def lightness(self) -> F64:
        """Speed that an impulse at each simulation vertex alone gives it [1/kg], shape (v,)."""
        index, weight = self.lattice.vertex_weights
        ease = np.where(self.free, 1.0 / np.maximum(self.masses, 1e-300), 0.0)
        return np.asarray((weight**2 * ease[index]).sum(axis=1))

    @cached_property
    def give(self) -> F64:
        """The same where all vertices get impulses: `lightness` times the largest eigenvalue of what they answer together in units of it."""
        index, weight = self.lattice.vertex_weights
        ease = np.where(self.free, 1.0 / np.maximum(self.masses, 1e-300), 0.0)
        scale = 1.0 / np.sqrt(np.where(self.lightness > 0.0, self.lightness, np.inf))
        way = np.ones(len(index))
        most = 1.0
        for _ in range(EIGEN_STEPS):
            nodes = np.zeros(len(ease))
            np.add.at(nodes, index, weight * (scale * way)[:, None])
            image = scale * (weight * (ease * nodes)[index]).sum(axis=1)
            most = float(np.linalg.norm(image))
            way = image / max(most, 1e-300)
        return np.asarray(self.lightness * max(1.0, EIGEN_MARGIN * most))

    @cached_property
    def swing(self) -> float:
        """Time in which waves of compression between neighbouring nodes turn by a radian [s]."""
        young, poisson = self.physics.young_modulus, self.physics.poisson_ratio
        stiff = young * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson))
        mesh = self.lattice.mesh
        density = float(self.masses.sum()) / max(float(np.abs(volumes(mesh.vertices, mesh.tets)).sum()), 1e-300)
        return float(0.25 * self.lattice.edge.min() / np.sqrt(stiff / density))

    @property
    def own(self) -> list[str]:
        """MuJoCo bodies of the nodes that move by themselves."""
        return [n for n in self.carriers if n.startswith(f"{self.entity}/node")]


def node_count(built: BuiltEntity) -> int:
    """Nodes of an elastic entity; 0 of others."""
    meshes = [p.simulation for p in built.parts if p.simulation is not None]
    return sum(int(np.prod(2 * m.cells + 1)) for m in meshes if m.cells.all())


def pinned_nodes(lattice: Lattice, pin: Pin) -> Any:
    """Nodes of the body in a pin's box, shape (n,)."""
    half = 0.5 * np.array(pin.size) * (1 + 1e-9)
    return (np.abs(lattice.nodes - np.array(pin.center)) <= half).all(axis=1) & lattice.used


def is_soft(spec: WorldSpec, name: str) -> bool:
    """True if an entity is an elastic body."""
    return isinstance(spec.entities[name].physics, ElasticPhysics)


def _bases(builder: Any, name: str, physics: ElasticPhysics) -> dict[str, tuple[str, RigidPose]]:
    """MuJoCo body and pose of the entities that carry pins, added first."""
    found: dict[str, tuple[str, RigidPose]] = {}
    for key, pin in physics.pins.items():
        if pin.to is None:
            continue
        if pin.to not in builder.members or is_soft(builder.spec, pin.to) or builder.spec.entities[pin.to].generator is not None:
            raise InputError(
                f"/entities/{name}/physics/pins/{key}/to: {pin.to!r} is no rigid body of the same solver instance; add it to members"
            )
        builder.entity(pin.to)
        found[pin.to] = (builder.made[pin.to].name, builder.world_pose[pin.to])
    return found


def add_flex(builder: Any, name: str) -> FlexBody:
    """Add an elastic entity to the model that a `builder.ModelBuilder` makes.

    Raises:
        InputError: it is not built as an elastic body, a pin holds no node, or no rigid body carries it.
    """
    import mujoco

    out, entity, built = builder.out, builder.spec.entities[name], builder.built[name]
    part: BuiltPart = built.parts[0]
    physics = entity.physics
    if part.simulation is None or not part.simulation.cells.all():
        raise InputError(f"entity {name!r} has no simulation mesh of an elastic body; call place_object again")
    bases = _bases(builder, name, physics)
    lattice, pose = Lattice(part.simulation), pose_of(entity.pose)
    places, masses = pose.apply(lattice.nodes), lattice.masses(sum(b.mass for b in built.bodies))
    carriers, offsets = np.full(len(places), "", dtype=object), np.zeros((len(places), 3))
    carriers[~lattice.used], offsets[~lattice.used] = "world", places[~lattice.used]
    for key, pin in physics.pins.items():
        held = pinned_nodes(lattice, pin)
        if not held.any():
            edge = ", ".join(f"{e / 2:.3g}" for e in lattice.edge)
            raise InputError(
                f"/entities/{name}/physics/pins/{key} holds no node of the body: nodes are ({edge}) m apart; "
                "make its box larger, or physics.resolution smaller"
            )
        base, frame = ("world", _ORIGIN) if pin.to is None else bases[pin.to]
        carriers[held], offsets[held] = base, frame.inverse().apply(places[held])
    for k in np.flatnonzero(carriers == "").tolist():
        carriers[k] = f"{name}/node{k}"
        body = out.worldbody.add_body(name=carriers[k], pos=places[k])
        body.explicitinertial, body.mass, body.inertia = True, masses[k], [NODE_INERTIA] * 3
        for axis in np.eye(3):
            body.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis)
    matter, flex = builder.spec.materials[part.material], out.add_flex(name=name)
    flex.dim, flex.radius, flex.order, flex.cellcount = 3, 0.0, 2, part.simulation.cells.tolist()
    flex.young, flex.poisson, flex.damping = physics.young_modulus, physics.poisson_ratio, physics.damping
    flex.stressyield = [physics.yield_strain, 0.0]
    flex.nodebody, flex.node = carriers.tolist(), offsets.ravel().tolist()
    flex.vertbody = ["world"] * len(part.simulation.vertices)
    flex.vert = pose.apply(part.simulation.vertices).ravel().tolist()
    flex.elem = part.simulation.tets.ravel().tolist()
    self_mode = mujoco.mjtFlexSelf
    flex.selfcollide = self_mode.mjFLEXSELF_AUTO if part.simulation.cells.max() >= LAYERS_FOR_SELF else self_mode.mjFLEXSELF_NONE
    flex.group, flex.contype, flex.conaffinity = len(builder.flexes), AMONG, AMONG
    flex.condim, flex.friction = 3, [matter.friction_at_rest, 1e-6, 1e-6]
    flex.margin, flex.solimp = builder.settings.skin, SOLIMP
    return FlexBody(name, part.part, physics, lattice, pose, masses, carriers.tolist(), offsets)


_ORIGIN = RigidPose(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))


_RESIDUAL = re.compile(r"relative residual of ([0-9.eE+-]+)")
_heard: list[str] = []
"""Messages of the engine since it was last asked; its own handler would write them to a file in the working directory."""


def hear(text: str) -> None:
    """Keep what the engine says."""
    del _heard[:-8]
    _heard.append(text)


class Flexes:
    """All elastic bodies of a compiled model: their state as others read it, and their ledger."""

    def __init__(self, model: Any, bodies: tuple[FlexBody, ...]) -> None:
        import mujoco

        self._inertia = int(mujoco.mjtWarning.mjWARN_INERTIA)
        self.model, self.bodies = model, bodies
        self.travel = 0.0
        """Farthest that a node went in one step of the frame [m]."""
        self.residual = 0.0
        """Largest relative residual with which the solve of a step of the frame ended before it converged; 0 where all did."""
        self.fields: FlexFields | None = None
        """Force fields on them, where any act."""
        for body in bodies:
            body.body_ids = np.array([model.body(n).id for n in body.carriers], dtype=np.int64)
            body.free = np.array([n.startswith(f"{body.entity}/node") for n in body.carriers])
        own = [b.body_ids[b.free] for b in bodies]
        self._free = np.concatenate(own) if own else np.zeros(0, dtype=np.int64)
        self._dofs = model.body_dofadr[self._free]

    @property
    def slow_enough(self) -> bool:
        """True if no surface may have jumped over another in a step of the frame."""
        shortest = min(float(b.lattice.edge.min()) / 2 for b in self.bodies)
        return self.travel <= TRAVEL_SHARE * shortest

    def start(self, data: Any) -> None:
        """Give nodes the declared velocities."""
        for body in self.bodies:
            rows = self.model.body_dofadr[body.body_ids[body.free]]
            for axis in range(3):
                data.qvel[rows + axis] = body.physics.linear_velocity[axis]

    def begin(self) -> None:
        """Start a frame."""
        self.travel, self.residual = 0.0, 0.0
        if self.fields is not None:
            self.fields.begin()

    def watch(self, data: Any, dt: float) -> None:
        """Note how far nodes go in a step, and how well it was solved."""
        if data.warning[self._inertia].number:
            found = [float(m.group(1)) for text in _heard if (m := _RESIDUAL.search(text))]
            if found:
                self.residual = max(self.residual, *found)
                data.warning[self._inertia].number = 0
            _heard.clear()
        speed = np.sqrt(sum(data.qvel[self._dofs + k] ** 2 for k in range(3)))
        self.travel = max(self.travel, float(speed.max(initial=0.0)) * dt)

    def places(self, data: Any, body: FlexBody) -> F64:
        """Places of a body's nodes [m], shape (n, 3)."""
        turn = data.xmat[body.body_ids].reshape(-1, 3, 3)
        return np.asarray(data.xpos[body.body_ids] + np.einsum("nij,nj->ni", turn, body.offsets))

    def nodes(self, data: Any, body: FlexBody) -> tuple[F64, F64]:
        """Places [m] and velocities [m/s] of a body's nodes, each (n, 3)."""
        places = self.places(data, body)
        linear, angular = velocities(self.model, data)
        speeds = linear[body.body_ids] + np.cross(angular[body.body_ids], places - data.xipos[body.body_ids])
        return places, speeds

    def surfaces(self, data: Any) -> dict[str, MovingSurface]:
        """Simulation vertices of every entity."""
        found = {}
        for body in self.bodies:
            places, speeds = (body.lattice.at_vertices(value) for value in self.nodes(data, body))
            # Steps damp what swings faster than they are long.
            pace = max(body.swing, float(self.model.opt.timestep))
            found[body.entity] = MovingSurface(places, speeds, body.lightness, body.give, pace)
        return found

    def channels(self, data: Any) -> dict[str, Any]:
        """Channels and records of the present state."""
        found = [self.nodes(data, b) for b in self.bodies]
        energy = {"kinetic": 0.0, "potential": 0.0, "strain": 0.0}
        momentum = np.zeros(3)
        for body, (places, speeds) in zip(self.bodies, found, strict=True):
            mass = np.where(body.free, body.masses, 0.0)
            energy["kinetic"] += 0.5 * float(mass @ (speeds**2).sum(1))
            energy["potential"] -= float(mass @ (places @ self.model.opt.gravity))
            energy["strain"] += body.lattice.energy(places, body.physics.young_modulus, body.physics.poisson_ratio)
            momentum += mass @ speeds
        vertices = [(b.lattice.at_vertices(p), b.lattice.at_vertices(v)) for b, (p, v) in zip(self.bodies, found, strict=True)]
        return {
            "vertex/position": np.concatenate([v[0] for v in vertices]),
            "vertex/velocity": np.concatenate([v[1] for v in vertices]).astype(np.float32),
            "record/elastic_kinetic_energy": np.float64(energy["kinetic"]),
            "record/elastic_potential_energy": np.float64(energy["potential"]),
            "record/strain_energy": np.float64(energy["strain"]),
            "record/elastic_travel_per_step": np.float64(self.travel),
            "record/solve_residual": np.float64(self.residual),
            **({} if self.fields is None else self.fields.channels()),
            **{f"record/elastic_momentum_{a}": np.float64(momentum[k]) for k, a in enumerate("xyz")},
        }
