"""Rows of the audit about liquids: membership, resolution, domain, openings, couplings (R57, R58, R66)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from .arrays import F64, pose_of
from .gate import Problem
from .liquids import LEAST_MOUTH, LEAST_SPACINGS, domain_box, inflows_of, initial_box, spacing_of
from .wave_audit import wave_problems

if TYPE_CHECKING:
    from .spec import Coupling, LiquidInstance, WorldSpec

__all__ = ["coupled_groups", "coupling_problems", "liquid_problems"]


def liquid_problems(spec: WorldSpec) -> list[Problem]:
    """What is wrong with liquids, their instances and their drivers."""
    found = [*_memberships(spec)]
    for name, instance in spec.simulation.liquid.items():
        found += _instance(spec, name, instance)
        if np.isfinite(spacing_of(spec, name)):
            found += wave_problems(spec, name, instance)
    found += _drivers(spec)
    return found


def _memberships(spec: WorldSpec) -> Iterator[Problem]:
    plan = spec.simulation
    for name, instance in plan.solvers.items():
        wanted = "liquid" if name in plan.liquid else "rigid"
        for k, member in enumerate(instance.members):
            entity = spec.entities.get(member)
            if entity is not None and entity.physics.category != wanted:
                yield Problem(
                    f"/simulation/solvers/{name}/members/{k}",
                    f"{member!r} is {entity.physics.category}, which engine {instance.engine!r} does not move; take it out. Solids are "
                    "boundaries of a liquid without being its members",
                    {"op": "remove", "path": f"/simulation/solvers/{name}/members/{k}"},
                )
    for name, entity in spec.entities.items():
        if entity.physics.category != "liquid":
            continue
        if entity.motion != "dynamic":
            text = f"the liquid {name!r} is {entity.motion}; liquids are dynamic"
            place = f"/entities/{name}/motion"
            yield Problem(place, text, {"op": "replace", "path": place, "value": "dynamic"})
        if entity.generator is not None:
            yield Problem(
                f"/entities/{name}/generator", f"the liquid {name!r} has a generator; give it parts that hold its volume"
            )


def _instance(spec: WorldSpec, name: str, instance: LiquidInstance) -> Iterator[Problem]:
    place = f"/simulation/solvers/{name}/settings"
    low, high = domain_box(instance)
    spacing = spacing_of(spec, name)
    if not np.isfinite(spacing):
        return
    least = LEAST_SPACINGS * spacing
    if (high - low).min() < least:
        yield Problem(
            f"{place}/domain/size",
            f"the domain is {(high - low).min():g} m wide, less than {LEAST_SPACINGS:g} spacings of {spacing:g} m",
        )
    for member in instance.members:
        entity = spec.entities.get(member)
        if entity is None or entity.physics.category != "liquid":
            continue
        if entity.physics.resolution != spacing:
            where = f"/entities/{member}/physics/resolution"
            yield Problem(
                where,
                f"{member!r} has resolution {entity.physics.resolution:g} m, another member of {name!r} {spacing:g} m; an instance has one",
                {"op": "replace", "path": where, "value": spacing},
            )
        box = initial_box(entity)
        if box is None:
            continue
        thin = float((box[1] - box[0]).min())
        if thin < least:
            yield Problem(
                f"/entities/{member}/physics/resolution",
                f"{member!r} is {thin:g} m thin, less than {LEAST_SPACINGS:g} spacings of {spacing:g} m; use at most {thin / LEAST_SPACINGS:.3g} m",
            )
        if (box[0] < low - 1e-9).any() or (box[1] > high + 1e-9).any():
            yield Problem(
                f"{place}/domain",
                f"the domain {_box(low, high)} cuts the initial volume of {member!r} {_box(*box)}; it must hold all of it",
            )
    for key, inflow in inflows_of(spec, name).items():
        where = f"/simulation/drivers/{key}"
        pose, half = pose_of(inflow.pose), 0.5 * np.array(inflow.size)
        corners = pose.apply(np.array([[sx * half[0], sy * half[1], 0.0] for sx in (-1, 1) for sy in (-1, 1)]))
        if (corners < low - 1e-9).any() or (corners > high + 1e-9).any():
            yield Problem(
                f"{where}/pose",
                f"inflow {key!r} {_box(corners.min(0), corners.max(0))} reaches out of the domain {_box(low, high)}",
            )
        mouth = LEAST_MOUTH[instance.engine]
        if min(inflow.size) < mouth * spacing:
            yield Problem(
                f"{where}/size",
                f"inflow {key!r} is {min(inflow.size):g} m wide, less than {mouth:g} spacings of {spacing:g} m; "
                f"widen it or use a resolution of at most {min(inflow.size) / mouth:.3g} m",
            )
        if not inflow.start < (spec.simulation.frames - 1) / spec.simulation.fps:
            yield Problem(f"{where}/start", f"inflow {key!r} starts at {inflow.start:g} s, after the last frame")


def _drivers(spec: WorldSpec) -> Iterator[Problem]:
    for name, driver in spec.simulation.drivers.items():
        if driver.kind in ("inflow", "outflow", "waves"):
            entity = spec.entities.get(driver.entity)
            if entity is not None and entity.physics.category != "liquid":
                yield Problem(
                    f"/simulation/drivers/{name}/entity", f"{driver.kind} {name!r} acts on {driver.entity!r}, which is no liquid"
                )
        moved = spec.entities.get(getattr(driver, "entity", ""))
        if driver.kind not in ("inflow", "outflow", "waves") and moved is not None and moved.physics.category == "liquid":
            yield Problem(
                f"/simulation/drivers/{name}",
                f"driver {driver.kind!r} cannot act on a liquid; use inflow, outflow, waves, gravity, or a kinematic solid that moves it",
            )


def _box(low: F64, high: F64) -> str:
    return f"[{', '.join(f'{v:.4g}' for v in low)}] to [{', '.join(f'{v:.4g}' for v in high)}] m"


def coupling_problems(spec: WorldSpec) -> list[Problem]:
    """Couplings that no engine of this build carries out."""
    return [p for key, c in spec.simulation.couplings.items() for p in _coupling(spec, key, c)] + [*_orders(spec)]


def _coupling(spec: WorldSpec, key: str, coupling: Coupling) -> Iterator[Problem]:
    plan, place = spec.simulation, f"/simulation/couplings/{key}"
    kinds = {n: "rigid" if n in plan.rigid else "liquid" for n in plan.solvers}
    source, target = kinds.get(coupling.source), kinds.get(coupling.target)
    if source is None or target is None:
        return  # the references row says so
    if {source, target} != {"rigid", "liquid"}:
        yield Problem(place, f"coupling {key!r} joins two {source} instances; this build couples a rigid with a liquid one")
    elif coupling.direction == "one_way" and source != "rigid":
        text = f"coupling {key!r}: one_way goes from the rigid to the liquid instance; swap source and target, or make it two_way"
        yield Problem(f"{place}/direction", text, {"op": "replace", "path": f"{place}/direction", "value": "two_way"})
    wrong = sorted(set(coupling.variables) - {"motion", "wrench", "pressure"})
    if wrong:
        yield Problem(
            f"{place}/variables", f"coupling {key!r}: {', '.join(wrong)} is exchanged by no engine of this build; take it out"
        )
    wanted = {"motion"} | ({"wrench"} if coupling.direction == "two_way" else set())
    missing = sorted(wanted - {v.replace("pressure", "wrench") for v in coupling.variables})
    if missing:
        yield Problem(f"{place}/variables", f"coupling {key!r} is {coupling.direction}; it exchanges {', '.join(missing)} too")


def _orders(spec: WorldSpec) -> Iterator[Problem]:
    plan = spec.simulation
    first = [s for s in plan.order if s in plan.solvers]
    for k, name in enumerate(first):
        late = [r for r in first[k + 1 :] if r in plan.rigid and not _share_group(spec, r, name)] if name in plan.liquid else []
        if late:
            yield Problem(
                "/simulation/order", f"the liquid {name!r} comes before {late[0]!r}, whose motion it reads; put it after"
            )
    for group in coupled_groups(spec):
        if sum(n in plan.rigid for n in group) > 1:
            yield Problem(
                "/simulation/couplings",
                f"instances {sorted(group)} are coupled two-way; one rigid instance per group is possible",
            )


def _share_group(spec: WorldSpec, a: str, b: str) -> bool:
    return any({a, b} <= g for g in coupled_groups(spec))


def coupled_groups(spec: WorldSpec) -> list[frozenset[str]]:
    """Sets of instances that step together because of two-way couplings."""
    groups: list[frozenset[str]] = []
    for coupling in spec.simulation.couplings.values():
        pair = {coupling.source, coupling.target} & set(spec.simulation.solvers)
        if coupling.direction == "two_way" and len(pair) == 2:
            met = [g for g in groups if g & pair]
            groups = [g for g in groups if not g & pair] + [frozenset(pair).union(*met)]
    return groups
