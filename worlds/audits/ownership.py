"""Audit of who moves what: every entity has one solver or driver, and drivers act on what they can (R27)."""

from __future__ import annotations

from ..instances import instance_for, membership_problems
from ..problems import Problem, removed, replaced
from ..spec import DetachDriver, MotorDriver, PathDriver, WorldSpec
from .reach import held_at_points

__all__ = ["ownership_problems"]


def ownership_problems(spec: WorldSpec) -> list[Problem]:
    """R27: every motion has a declared owner; every collider is in a solver."""
    plan, problems = spec.simulation, membership_problems(spec)
    member_of: dict[str, list[str]] = {}
    for name, instance in plan.solvers.items():
        for member in instance.members:
            member_of.setdefault(member, []).append(name)
    driven = {d.entity for d in plan.drivers.values() if isinstance(d, PathDriver)}
    for name, entity in spec.entities.items():
        place = f"/entities/{name}"
        owners = member_of.get(name, [])
        if not owners:
            where = instance_for(spec, entity.physics.category)
            problems.append(
                Problem(
                    f"/simulation/solvers/{where}/members",
                    f"{name!r} ({entity.motion}) is in no solver; add it to members",
                    {"op": "add", "path": f"/simulation/solvers/{where}/members/-", "value": name},
                )
            )
        elif entity.motion != "static" and len(owners) > 1:
            problems.append(Problem(f"/simulation/solvers/{owners[1]}/members", f"{name!r} is moved by {owners}; keep one"))
        if entity.active is not None:
            text = f"{name!r} has an active interval, but no engine of this build makes bodies appear or vanish; leave it out"
            problems.append(Problem(f"{place}/active", text, removed(f"{place}/active")))
        if entity.afloat is not None and entity.motion == "dynamic" and name not in held_at_points(spec):
            text = (
                f"{name!r} is dynamic, and afloat ({entity.afloat!r}) is allowed for static and kinematic things, and for what a joint, rope end, "
                "pin or bonded side holds at points of space: it says why one hangs in the air with nothing that holds it; what else is dynamic falls, or a contact, "
                "joint, rope or liquid carries it: leave afloat out, or make it static"
            )
            problems.append(Problem(f"{place}/afloat", text, removed(f"{place}/afloat")))
        if entity.motion == "kinematic" and name not in driven:
            problems.append(
                Problem(
                    f"{place}/motion",
                    f"{name!r} is kinematic but no path driver moves it; add one or make it dynamic/static",
                    replaced(f"{place}/motion", "dynamic"),
                )
            )
        if entity.motion == "static" and name in driven:
            problems.append(
                Problem(
                    f"{place}/motion",
                    f"{name!r} is static but a path driver moves it; make it kinematic",
                    replaced(f"{place}/motion", "kinematic"),
                )
            )
    return problems + _driver_problems(spec)


def _driver_problems(spec: WorldSpec) -> list[Problem]:
    """Drivers act on what they can."""
    plan, problems = spec.simulation, []
    for name, driver in plan.drivers.items():
        target = getattr(driver, "entity", None)
        if target in spec.entities and not isinstance(driver, PathDriver) and spec.entities[target].motion != "dynamic":
            problems.append(
                Problem(f"/simulation/drivers/{name}", f"{driver.kind} driver acts on {target!r}, which is not dynamic")
            )
        if (
            isinstance(driver, DetachDriver)
            and driver.joint in plan.joints
            and plan.joints[driver.joint].kind not in ("weld", "spring")
        ):
            problems.append(Problem(f"/simulation/drivers/{name}", "only welds and springs can be detached"))
        if (
            isinstance(driver, MotorDriver)
            and driver.joint in plan.joints
            and plan.joints[driver.joint].kind not in ("hinge", "slide")
        ):
            problems.append(Problem(f"/simulation/drivers/{name}", "only hinges and slides can have a motor"))
    return problems
