"""Lines of the approximation register about what joints do that nothing drawn shows, and about loads that nothing breaks under (R68, R156)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from ...worlds.quoting import listed
from ...worlds.spec import HingeJoint, SlideJoint, SpringJoint

if TYPE_CHECKING:
    from ...worlds.spec import WorldSpec

__all__ = ["joint_lines"]

NAMED = 4
"""Joints that a line names, the strongest first."""


def joint_lines(spec: WorldSpec) -> list[dict[str, str]]:
    """Lines about welds, friction, springs, damping and stops of joints, and about strength."""
    joints = {n: j for n, j in spec.simulation.joints.items() if not isinstance(j, SpringJoint)}
    found = []
    for name, joint in joints.items():
        if joint.kind == "weld":
            held = f"{joint.child!r} and {joint.parent!r}" if joint.parent else f"{joint.child!r} and the world"
            found.append((f"weld {name!r}", f"{held} move as one body, however hard they are hit"))
    rubs = {n: j.friction for n, j in joints.items() if isinstance(j, HingeJoint | SlideJoint)}
    found += _group(
        spec, "dry friction in joints", rubs, "", "it holds any load still that is smaller, though nothing drawn shows what rubs"
    )
    stiff = {n: j.stiffness for n, j in joints.items()}
    found += _group(
        spec,
        "springs in joints",
        stiff,
        "per",
        "they push back to the pose of frame 0, and make it swing, though nothing drawn shows them",
    )
    slow = {n: j.damping for n, j in joints.items()}
    found += _group(
        spec, "damping in joints", slow, "speed", "it slows what turns or slides there, though nothing drawn shows what does"
    )
    stops = {n: j.range for n, j in joints.items() if isinstance(j, HingeJoint | SlideJoint) and j.range is not None}
    if stops:
        told = [
            f"{n!r} at {low:.3g} and {high:.3g} {'rad' if joints[n].kind == 'hinge' else 'm'}" for n, (low, high) in stops.items()
        ]
        found.append(
            (
                f"stops of joints: {listed(told, NAMED)}",
                "what turns or slides stops there, whether or not something drawn is in its way",
            )
        )
    return [{"what": what, "effect": effect} for what, effect in found] + list(_strength(spec))


def _group(spec: WorldSpec, noun: str, values: dict[str, float], per: str, effect: str) -> Iterator[tuple[str, str]]:
    """One line about a quantity of many joints, the largest first; none where all are zero."""
    found = sorted(((v, n) for n, v in values.items() if v > 0.0), reverse=True)
    if found:
        yield f"{noun}: {listed([f'{n!r} {v:.3g} {_unit(spec, n, per)}' for v, n in found], NAMED)}", effect


def _unit(spec: WorldSpec, name: str, per: str) -> str:
    slides = spec.simulation.joints[name].kind == "slide"
    unit, way = ("N", "m") if slides else ("N m", "rad")
    return {"": unit, "per": f"{unit}/{way}", "speed": f"{unit} s/{way}"}[per]


def _strength(spec: WorldSpec) -> Iterator[dict[str, str]]:
    """The line about what bears any load: everything but what may break or tear."""
    if not math.hypot(*spec.simulation.gravity) and not spec.simulation.drivers:
        return
    weak = [n for n, e in spec.entities.items() if e.breakable is not None or getattr(e.physics, "tear", None) is not None]
    if any(e.motion == "dynamic" for e in spec.entities.values()):
        but = f" but {listed([repr(n) for n in weak], NAMED)}" if weak else ""
        yield {
            "what": f"nothing breaks{but}",
            "effect": "supports, ropes, joints and bodies bear any load, however thin they are and whatever they are made of",
        }
