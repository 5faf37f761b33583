"""The register tells of what joints do that no picture shows, the strongest first, and that nothing breaks but what may."""

from __future__ import annotations

from typing import Any

from worldagent.testing.worlds.small_worlds import box, ground, world
from worldagent.verifiers.register.joints import joint_lines
from worldagent.worlds.spec import HingeJoint, SlideJoint, WeldJoint


def _told(**joints: Any) -> dict[str, str]:
    bodies = {f"b{k}": box(0.1, 0.1, 0.1, at=(k, 0, 1), motion="dynamic") for k in range(7)}
    return {line["what"]: line["effect"] for line in joint_lines(world({"floor": ground(), **bodies}, joints=joints))}


def _hinge(k: int, **more: Any) -> HingeJoint:
    return HingeJoint(parent="floor", child=f"b{k}", anchor=(k, 0, 1), axis=(0, 0, 1), **more)


def test_friction_springs_damping_and_stops_are_told_with_their_values() -> None:
    told = _told(
        h=_hinge(1, friction=0.4, stiffness=1.5, damping=0.01, range=(-0.3, 0.3)),
        s=SlideJoint(parent="floor", child="b2", anchor=(2, 0, 1), axis=(0, 0, 1), friction=1e5),
    )
    assert [what for what in told if what.startswith("dry friction")] == ["dry friction in joints: 's' 1e+05 N, 'h' 0.4 N m"]
    assert "springs in joints: 'h' 1.5 N m/rad" in told
    assert "damping in joints: 'h' 0.01 N m s/rad" in told
    assert "stops of joints: 'h' at -0.3 and 0.3 rad" in told


def test_a_free_joint_is_no_line_and_many_are_one() -> None:
    assert list(_told(h=_hinge(1))) == ["nothing breaks"]
    many = [what for what in _told(**{f"h{k}": _hinge(k, friction=float(k)) for k in range(1, 7)}) if what.startswith("dry")]
    assert len(many) == 1
    assert many[0].startswith("dry friction in joints: 'h6' 6 N m, 'h5' 5 N m")
    assert "weld 'w'" in _told(w=WeldJoint(parent="floor", child="b1", anchor=(1, 0, 1)))
