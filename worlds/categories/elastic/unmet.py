"""Matter that elastic bodies never touch in this build, though it stands in their way or the story asks for it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from ...extents import initial_box
from ...instances import soft_met
from ...predicate_base import atoms_of
from ...problems import Problem
from ..loose import domain_box, told_box
from .models import ElasticPhysics

if TYPE_CHECKING:
    from ...spec import WorldSpec

__all__ = ["unmet_warnings"]


def unmet_warnings(spec: WorldSpec) -> Iterator[Problem]:
    """Loose matter that passes through elastic bodies in its domain, and beats of contacts that no engine makes."""
    soft = [n for n, e in spec.entities.items() if isinstance(e.physics, ElasticPhysics)]
    if soft:
        yield from _passed_through(spec, soft)
        yield from _in_two_instances(spec, soft)


def _passed_through(spec: WorldSpec, soft: list[str]) -> Iterator[Problem]:
    plan = spec.simulation
    for name, instance in {**plan.liquid, **plan.particles}.items():
        low, high = domain_box(instance)
        for body in soft:
            box = initial_box(spec.entities[body])
            if body in soft_met(spec, name) or box is None or (box[0] > high).any() or (box[1] < low).any():
                continue
            engine, device = instance.engine, getattr(instance.settings, "device", "cpu")
            other = {"flip": "use engine dfsph", "dem": "use device cpu"}.get(engine, "keep its domain off the body")
            yield Problem(
                f"/simulation/solvers/{name}/{'settings/device' if engine == 'dem' else 'engine'}",
                f"{name!r} ({engine} on {device}) makes no contact with elastic {body!r} {told_box(*box)}, which lies in its domain "
                f"{told_box(low, high)}: they pass through each other. Allowed are dfsph, and dem on a cpu: {other}, or make {body!r} rigid",
            )


def _in_two_instances(spec: WorldSpec, soft: list[str]) -> Iterator[Problem]:
    rigid = spec.simulation.rigid
    for beat, told in spec.story.beats.items():
        for atom in atoms_of(told.predicate):
            one, two = getattr(atom, "a", ""), getattr(atom, "b", "")
            if getattr(atom, "kind", "") != "contact" or not {one, two} & set(soft):
                continue
            homes = [{k for k, i in rigid.items() if n in i.members} for n in (one, two)]
            if all(homes) and not homes[0] & homes[1]:
                places = [sorted(h)[0] for h in homes]
                yield Problem(
                    f"/story/beats/{beat}/predicate",
                    f"contact of {one!r} (in {places[0]!r}) and {two!r} (in {places[1]!r}): bodies of two rigid instances make no contact, 1 instance "
                    f"is allowed; move one of them into the members of the other's",
                )
