"""Specification and built entities -> MuJoCo model.

Every entity becomes bodies; static ones are welded to the world, kinematic and held ones are free bodies that `holds`
makes immovable.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...worlds.arrays import F64
from ...worlds.built import BuiltEntity
from ...worlds.errors import InputError
from ...worlds.spec import RigidSettings, WorldSpec
from .builder import ModelBuilder, free_count
from .contact_law import ContactLaw, set_contact_law
from .crumbling import make_crumbling
from .flex import FlexBody, add_flex, is_soft, node_count
from .flex_contacts import add_surfaces, part_flexes
from .links import add_links, add_pairs
from .stiction import Stiction

__all__ = ["RigidModel", "build_model"]

SOFTEST = 200.0
"""Contacts are as soft as those of a body this many times lighter than the heaviest one, at most."""


@dataclass
class RigidModel:
    """A compiled model and the maps between the specification's names and its indices."""

    model: Any
    colliders: tuple[str, ...]
    bodies: tuple[str, ...]
    """`entity/body` of every moving body, in cache order."""
    body_ids: Any
    """MuJoCo body id per entry of `bodies`; pieces that are bonded to one another share theirs."""
    offsets: F64
    """Origin of MuJoCo's frame in the body's own frame [m], shape (n, 3)."""
    centers: F64
    """Centre of mass in the body's own frame [m], shape (n, 3)."""
    geom_collider: Any
    """Collider index per side of a contact (geoms, then elastic bodies), shape (sides,)."""
    joints: tuple[str, ...]
    joint_qpos: Any
    """qpos address per entry of `joints`."""
    law: ContactLaw
    excess: F64
    """Distance by which the visible surface reaches outside the collision shape, per side of a contact [m], shape (sides,)."""
    flexes: tuple[FlexBody, ...] = ()
    """Elastic members, in the order of the engine."""
    parted: tuple[frozenset[str], ...] = ()
    """Pairs, one of them elastic, that pass through each other."""
    exclude_of: dict[str, int] = field(default_factory=dict)
    """Exclusion per weld that a driver can open."""
    eq_of: dict[str, int] = field(default_factory=dict)
    tendon_of: dict[str, int] = field(default_factory=dict)
    kin: Any = None
    """True where a collider is a breakable entity, whose pieces meet each other, shape (colliders,)."""
    kin_rows: Any = None
    """True where an entry of `bodies` is a piece of one, shape (n,)."""
    masses: Any = None
    """Mass of each entry of `bodies` alone [kg], shape (n,)."""
    actuator_of: dict[str, int] = field(default_factory=dict)


def build_model(
    spec: WorldSpec,
    built: Mapping[str, BuiltEntity],
    members: tuple[str, ...],
    settings: RigidSettings,
    *,
    apart: Iterable[tuple[str, str]] = (),
    whole: Mapping[str, Any] | None = None,
) -> RigidModel:
    """Compile the model of one solver instance.

    Args:
        spec: the specification.
        built: built entities.
        members: of the instance.
        settings: of the instance.
        apart: pairs that pass through each other.
        whole: which bonds of breakable entities hold; default all.

    Raises:
        InputError: joints that form loops, share a child or name non-members; too many special pairs.
    """
    builder = ModelBuilder(spec, built, members, settings, frozenset(frozenset(pair) for pair in apart), whole or {})
    bounces = _filled(builder)
    model = _compiled(builder)
    result = _mapped(builder, model, bounces)
    part_flexes(result)
    _find_links(result, spec)
    for name, damping in builder.dragged.items():
        start = int(model.joint(name).dofadr[0])
        model.dof_damping[start : start + 3] = damping
    # The softness of a contact follows its lighter body; under a far heavier one it would sink through the skin.
    moving = [b for b in result.body_ids.tolist() if model.body_dofnum[b]]
    heaviest = float(model.body_mass[moving].max(initial=1e-9)) if moving else 1.0
    model.body_invweight0[:, 0] = np.minimum(model.body_invweight0[:, 0], SOFTEST / heaviest)
    set_contact_law(result, settings.contact_steps, settings.step)
    return result


def _filled(builder: ModelBuilder) -> dict[tuple[str, str], float]:
    """Add all members and their links; restitution of the pairs that have one of their own."""
    spec, built = builder.spec, builder.built
    dynamic = [m for m in builder.members if spec.entities[m].motion != "static"]
    bodies = sum(free_count(built[m], builder.whole.get(m)) for m in dynamic)
    builder.options(6 * bodies + 3 * sum(node_count(built[m]) for m in builder.members))
    for name in builder.members:
        if is_soft(spec, name):
            builder.flexes.append(add_flex(builder, name))
        else:
            builder.entity(name)
    add_surfaces(builder.out, builder.flexes, builder.settings.skin)
    add_links(builder)
    builder.drag()
    builder.room()
    return add_pairs(builder)


def _compiled(builder: ModelBuilder) -> Any:
    """The MuJoCo model.

    Raises:
        InputError: MuJoCo refuses it.
    """
    try:
        with warnings.catch_warnings():
            # Of an elastic body without damping, whose elasticity MuJoCo 4.0.0 does not count as a force.
            warnings.filterwarnings("ignore", message="flex '.*' is not rigid and has no equality constraints")
            return builder.out.compile()
    except ValueError as error:
        raise InputError(f"MuJoCo refuses the model: {error}") from error


def _mapped(builder: ModelBuilder, model: Any, bounces: Mapping[tuple[str, str], float]) -> RigidModel:
    """The compiled model with the maps to the specification's names; `bounces`: restitution of pairs that have one of their own."""
    import mujoco

    spec, built, colliders = builder.spec, builder.built, builder.members
    rank = {name: i for i, name in enumerate(colliders)}
    geom_names = [mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_GEOM, g) for g in range(model.ngeom)]
    body_ids = [model.body(builder.body_of.get(n, n.removesuffix("/body"))).id for n in builder.body_names]
    soft = [f.entity for f in builder.flexes]
    geom_collider = np.array([rank[n] for n in (*(builder.geom_entity[g] for g in geom_names), *soft)], dtype=np.int64)
    matter = [builder.geom_material[g] for g in geom_names] + [built[n].parts[0].material for n in soft]
    return RigidModel(
        model=model,
        colliders=colliders,
        bodies=tuple(builder.body_names),
        body_ids=np.array(body_ids, dtype=np.int64),
        offsets=np.array(builder.offsets).reshape(-1, 3),
        centers=np.array(builder.centers).reshape(-1, 3),
        kin=np.array([built[c].bonds is not None for c in colliders], dtype=bool),
        kin_rows=np.array([n in builder.body_of for n in builder.body_names], dtype=bool),
        masses=_row_masses(built, builder.body_names),
        geom_collider=geom_collider,
        joints=tuple(builder.joint_names),
        joint_qpos=np.array([model.joint(n).qposadr[0] for n in builder.joint_names], dtype=np.int64),
        law=ContactLaw(
            model,
            np.array([spec.materials[m].restitution for m in matter]),
            geom_collider,
            {(rank[a], rank[b]): value for (a, b), value in bounces.items()},
            make_crumbling(spec, built, colliders, geom_names, builder.geom_entity),
            _stiction(spec, matter, geom_collider, rank),
        ),
        excess=np.array([*(builder.geom_excess[g] for g in geom_names), *(0.0 for _ in soft)]),
        flexes=tuple(builder.flexes),
        parted=tuple(p for p in builder.apart if p <= set(colliders) and any(is_soft(spec, n) for n in p)),
    )


def _stiction(spec: WorldSpec, matter: Sequence[str], colliders: Any, rank: Mapping[str, int]) -> Stiction | None:
    """Coefficients of contacts that slip, by the material of every side; None where rest has no other ones."""
    pairs = [c for c in spec.simulation.contacts.values() if c.friction is not None and c.a in rank and c.b in rank]
    if all(spec.materials[m].static_friction is None for m in matter) and all(c.static_friction is None for c in pairs):
        return None
    kinetic = np.array([spec.materials[m].friction for m in matter])
    return Stiction(kinetic, colliders, {(rank[c.a], rank[c.b]): c.friction or 0.0 for c in pairs})


def _find_links(rigid: RigidModel, spec: WorldSpec) -> None:
    """Find the model's equalities, exclusions, tendons and actuators by the names of joints and drivers."""
    import mujoco

    def place(kind: Any, name: str) -> int:
        return int(mujoco.mj_name2id(rigid.model, kind, name))

    objects = mujoco.mjtObj
    for name in spec.simulation.joints:
        equality, tendon = place(objects.mjOBJ_EQUALITY, name), place(objects.mjOBJ_TENDON, name)
        exclude = place(objects.mjOBJ_EXCLUDE, name)
        if equality >= 0:
            rigid.eq_of[name] = equality
        if equality >= 0 and exclude >= 0:
            rigid.exclude_of[name] = exclude
        if tendon >= 0:
            rigid.tendon_of[name] = tendon
    for name in spec.simulation.drivers:
        actuator = place(objects.mjOBJ_ACTUATOR, name)
        if actuator >= 0:
            rigid.actuator_of[name] = actuator


def _row_masses(built: Mapping[str, BuiltEntity], names: Sequence[str]) -> F64:
    owners = [n.split("/", 1) for n in names]
    mass = {e: {b.name: b.mass for b in built[e].bodies} for e in {e for e, _ in owners}}
    return np.array([mass[e][n] for e, n in owners])
