"""Facts that loose matter shares: the domain in which it is followed, and the caps on its numbers."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import F64
from ..fields import acting_on, field_drivers
from ..slices import MOTION_VERSION, geometry_slice, physical_materials

if TYPE_CHECKING:
    from ..spec import GasInstance, LiquidInstance, ParticleInstance, WorldSpec

__all__ = ["ROUNDED", "LooseEstimate", "counts", "domain_box", "loose_slice", "told_box"]

ROUNDED = 1e-3
"""Share that sizes may be short by: messages tell spacings with three digits, and corners are sums."""

CACHE_BYTES_PER_PARTICLE_FRAME = 48
"""Position, velocity, id, fluid, volume, density, pressure, temperature in 32 bits [bytes]."""


class LooseEstimate(NamedTuple):
    """Amounts that an instance will take."""

    particles: float
    """At most at one time."""
    steps: float
    """Steps of the whole run, preroll included."""
    cells: float = 0.0
    """Cells of its grid; 0 for particles."""


def domain_box(instance: GasInstance | LiquidInstance | ParticleInstance) -> tuple[F64, F64]:
    """Least and greatest corner of a domain [m]."""
    center, half = np.array(instance.settings.domain.center), 0.5 * np.array(instance.settings.domain.size)
    return center - half, center + half


def told_box(low: F64, high: F64) -> str:
    """Text for a box."""
    return f"[{', '.join(f'{v:.4g}' for v in low)}] to [{', '.join(f'{v:.4g}' for v in high)}] m"


def counts(spec: WorldSpec, estimates: Iterable[LooseEstimate]) -> dict[str, float]:
    """Sum of the amounts of instances, by name of the cap."""
    found = list(estimates)
    particles = sum(e.particles for e in found)
    return {
        "steps": sum(e.steps for e in found),
        "particles": particles,
        "particle_steps": sum(e.particles * e.steps for e in found),
        "cells": sum(e.cells for e in found),
        "cache_bytes": particles * spec.simulation.frames * CACHE_BYTES_PER_PARTICLE_FRAME,
    }


def loose_slice(spec: WorldSpec, name: str, meeting: Iterable[str], *, rough: bool = False) -> dict[str, Any]:
    """Everything that decides the motion of loose matter that is pushed by bodies and does not push them.

    Args:
        spec: the specification.
        name: the instance.
        meeting: solids that reach into its domain; the paths of moving ones are content, not specification.
        rough: whether the materials of these solids decide too: their friction, how they bounce and burn.
    """
    plan = spec.simulation
    instance, solids = plan.solvers[name], sorted(meeting)
    members = [m for m in instance.members if m in spec.entities]
    used = {spec.entities[m].material for m in members}
    rubbed = {}
    if rough:
        touching = [spec.entities[m] for m in (*members, *solids)]
        used |= {m for e in touching for m in (e.material, *(p.material for p in e.parts.values())) if m}
        rubbed = {"contacts": {k: c.model_dump(mode="json") for k, c in plan.contacts.items() if {c.a, c.b} & set(members)}}
    return {
        "spec_version": MOTION_VERSION,
        "instance": instance.model_dump(mode="json"),
        "members": {
            m: [geometry_slice(spec, m), spec.entities[m].model_dump(mode="json", include={"pose", "physics"})] for m in members
        },
        "materials": physical_materials({k: spec.materials[k] for k in sorted(used) if k in spec.materials}),
        "solids": {
            m: [geometry_slice(spec, m), spec.entities[m].pose.model_dump(mode="json"), spec.entities[m].motion] for m in solids
        },
        "drivers": {k: d.model_dump(mode="json") for k, d in plan.drivers.items() if getattr(d, "entity", None) in members}
        | {k: d.model_dump(mode="json") for k, d in field_drivers(spec).items() if set(members) & set(acting_on(spec, d))},
        "clock": [plan.fps, plan.preroll, list(plan.gravity), plan.seed],
        **rubbed,
    }
