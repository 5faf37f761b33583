"""How a check of elastic bodies states its verdict."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ....worlds.requirements import RowId
from ....worlds.spec import ElasticPhysics
from ...rows.findings import Finding
from ...rows.verdicts import answered

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Row

__all__ = ["PREDICATES", "elastic_row", "physics_of"]

PREDICATES = {
    "shape": "every vertex is finite and no tetrahedron is inverted",
    "strain": "largest principal strain <= max_strain of the contract",
    "self": "the visible surface passes nowhere through itself",
    "volume": "the volume changes by no more than max_strain allows at the Poisson's ratio",
    "step": "no node travels farther in a step than half an edge of the surface that collides",
    "recovery": "at rest, the body is back in its shape: within `recovery` of its size, and what its load explains",
    "pins": "what pins hold stays where they hold it",
    "flight": "where nothing touches or pins the body, its centre of mass falls freely",
    "energy": "energy of the instance less the work of drivers, coupled partners and fields never grows by more than limits.energy_growth of the energy in play",
    "solve": "the elastic solve of every step converges, or ends within a relative residual of 1e-3",
    "exchange": "what elastic members received is what cloth, grains and liquids gave them",
    "together": "energy of elastic bodies and the cloth coupled with them, less work from outside, never grows by more than "
    "limits.energy_growth of the energy in play",
    "fields": "impulses of force fields are those of the declared fields within a tenth of the largest",
    "records": "recorded energies and momentum of elastic members are those of their vertices",
    "mass": "simulation meshes hold the volume that was built",
}


def physics_of(candidate: Candidate, entity: str) -> ElasticPhysics:
    """The contract's physics."""
    physics = candidate.spec.entities[entity].physics
    assert isinstance(physics, ElasticPhysics)
    return physics


def elastic_row(candidate: Candidate, name: str, owner: str, found: Finding) -> Row:
    """Row `category:elastic:<name>:<owner>` about an entity, or an instance and the entities that the answer names."""
    entities = () if found.entities else (owner,)
    growth = candidate.spec.simulation.limits.energy_growth
    return answered(
        candidate, RowId(f"category:elastic:{name}", owner), PREDICATES[name], found, entities=entities, extra=[growth]
    )
