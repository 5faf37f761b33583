"""Channels of rigid instances with elastic members."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from ...channel import Channel, quantity, vector
from ...fields import fields_of
from ...instances import coupled_groups
from ..shared_channels import VERTICES

if TYPE_CHECKING:
    from ...spec import WorldSpec

__all__ = ["CHANNELS", "DIMENSIONS", "writers"]

DIMENSIONS: Mapping[str, str] = {
    "deformables": "`CacheIndex.deformables`",
}

CHANNELS: Mapping[str, tuple[Channel, ...]] = {
    "elastic": (
        *VERTICES,
        quantity("strain_energy", "J", "stored in the deformation of elastic bodies"),
        quantity("elastic_kinetic_energy", "J", "sum over the nodes of elastic bodies", sign="+"),
        quantity("elastic_potential_energy", "J", "gravity, against z = 0, of elastic bodies"),
        *vector("elastic_momentum", "kg m/s", "sum over the nodes of elastic bodies"),
        quantity("elastic_travel_per_step", "m", "farthest that a node of an elastic body went in one step of the frame", total="max", sign="+"),
        quantity("solve_residual", "1", "largest relative residual of the elastic solve that did not converge; 0 where all did", total="max", sign="+"),
    ),
    "elastic coupled": (
        Channel("exchange/soft", "f8", ("deformables", 6), "N s, N m s", "what the rigid engine integrated of others' forces on each elastic member, about its centre of mass", "sum"),
        quantity("soft_exchange_work", "J", "work of others' forces on elastic bodies in the frame"),
    ),
    "elastic blown": (
        Channel("field/soft", "f8", ("deformables", 3), "N s", "of force fields over the frame", "sum"),
        quantity("soft_field_work", "J", "work of force fields on elastic bodies in the frame"),
    ),
}  # fmt: skip
"""By kind of writer."""


def writers(spec: WorldSpec, name: str) -> Iterator[str]:
    """Kinds of writer that a rigid instance is by its elastic members: one that others push, one with some in force fields."""
    members = [m for m in spec.simulation.solvers[name].members if m in spec.entities]
    elastic = [m for m in members if spec.entities[m].physics.category == "elastic"]
    if name not in spec.simulation.rigid or not elastic:
        return
    yield "elastic"
    if any(name in group for group in coupled_groups(spec)):
        yield "elastic coupled"
    if any(fields_of(spec, m) for m in elastic):
        yield "elastic blown"
