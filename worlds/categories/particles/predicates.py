"""Predicates about grains and flying particles. Their evidence is the particles of an engine."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ...predicate_base import BAND, Band, PredicateInfo, Subject, When
from ...vocabulary import Finite, Positive, RegionRef, SpecModel

__all__ = ["PREDICATES", "ParticleCountIn", "ParticleVolumeIn", "ParticlesSettled", "PileHeight", "RunOut"]


class ParticleCountIn(Band):
    """Number of an entity's particles in a region."""

    kind: Literal["particle_count_in"] = "particle_count_in"
    entity: Subject = Field(description="the particles")
    region: RegionRef | None = Field(default=None, description="default: everywhere")
    when: When = "eventually"


class ParticleVolumeIn(Band):
    """Volume of an entity's particles whose middles are in a region [m^3]: of the grains, without the air between them."""

    kind: Literal["particle_volume_in"] = "particle_volume_in"
    entity: Subject = Field(description="the particles")
    region: RegionRef
    when: When = "eventually"


class PileHeight(Band):
    """Height of a heap [m]: over `base`, below which 99 % of its particles' volume lies."""

    kind: Literal["pile_height"] = "pile_height"
    entity: Subject = Field(description="the particles")
    base: Finite = Field(default=0.0, description="height z that counts as 0 [m]")
    when: When = "end"


class RunOut(Band):
    """Distance from an upright axis within which 99 % of the particles' volume lies, seen from above [m]."""

    kind: Literal["run_out"] = "run_out"
    entity: Subject = Field(description="the particles")
    center: tuple[Finite, Finite] = Field(description="x, y of the axis [m]")
    when: When = "end"


class ParticlesSettled(SpecModel):
    """The particles are at rest: their mean speed is at most `max_speed`."""

    kind: Literal["particles_settled"] = "particles_settled"
    entity: Subject = Field(description="the particles")
    max_speed: Positive = Field(default=0.01, description="[m/s]")
    when: When = "end"


_GRAINS = ("origin", "particle/position", "particle/member", "particle/radius")
PREDICATES = (
    PredicateInfo("particle_count_in", "1", _GRAINS, BAND),
    PredicateInfo("particle_volume_in", "m^3", _GRAINS, BAND),
    PredicateInfo("pile_height", "m", _GRAINS, BAND),
    PredicateInfo("run_out", "m", _GRAINS, BAND),
    PredicateInfo("particles_settled", "m/s", (*_GRAINS, "particle/velocity"), {"max_speed": "down"}),
)
