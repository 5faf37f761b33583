"""Balloons, the category that the tests add."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from ...channel import Channel, vector
from ...parameters import PHYSICS, SETTINGS, GroupInfo, parameters
from ...problems import Problem, replaced
from ..caps import LOOSE_CAPS
from ..category import Audit, CategorySpec
from ..loose import LooseEstimate, counts
from ..shared_channels import MOTION, POINTS
from .models import PREDICATES, BalloonInstance, BalloonPhysics

if TYPE_CHECKING:
    from ...spec import WorldSpec

__all__ = ["BALLOONS"]


def _problems(spec: WorldSpec) -> Iterator[Problem]:
    """Balloons that do not move, or are no spheres."""
    for name, entity in spec.entities.items():
        if not isinstance(entity.physics, BalloonPhysics):
            continue
        place = f"/entities/{name}"
        if entity.motion != "dynamic":
            yield Problem(
                f"{place}/motion",
                f"balloons {name!r} are {entity.motion}; make them dynamic",
                replaced(f"{place}/motion", "dynamic"),
            )
        if entity.generator is not None or any(part.shape.kind != "sphere" for part in entity.parts.values()):
            yield Problem(f"{place}/parts", f"balloons {name!r} are not all spheres; give each a part of kind sphere")


def _estimates(spec: WorldSpec) -> Iterator[LooseEstimate]:
    for instance in spec.simulation.solvers.values():
        if isinstance(instance, BalloonInstance):
            count = sum(len(spec.entities[m].parts) for m in instance.members if m in spec.entities)
            yield LooseEstimate(count, spec.simulation.frames)


BALLOONS = CategorySpec(
    name="balloons",
    shape=BalloonPhysics.shape,
    covers="balloons that rise through still air",
    physics=BalloonPhysics,
    instances=(BalloonInstance,),
    predicates=PREDICATES,
    asked="ascends, reaches or speed of them",
    groups=(GroupInfo("balloons", "solver", "drag and lift of balloons"),),
    parameters=(
        *parameters(PHYSICS, "air_drag", "balloons", "repair", "rows hold the motion against laws"),
        *parameters(SETTINGS, "air_density", "balloons", "repair", "rows hold the motion against laws"),
    ),
    channels={
        "balloons": (
            *POINTS,
            *MOTION,
            Channel("balloon/member", "i4", ("particles",), "1", "index into `CacheIndex.bodies`", sign="+"),
            Channel("balloon/radius", "f4", ("particles",), "m", "radius", sign="+"),
            *vector("lift_impulse", "N s", "weight and buoyancy of balloons since frame 0"),
            *vector("drag_impulse", "N s", "drag of air on balloons since frame 0"),
        )
    },
    caps=LOOSE_CAPS,
    estimate=lambda spec: counts(spec, _estimates(spec)),
    audit=Audit("balloons", "balloons are dynamic, and each is a sphere", lambda spec: list(_problems(spec))),
    starts_alone=True,
)
