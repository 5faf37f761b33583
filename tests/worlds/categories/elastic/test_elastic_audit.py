"""Audit of elastic bodies: each problem with its place, and the edit that mends it."""

from __future__ import annotations

import pytest
from worldagent.testing.worlds.small_worlds import box, ground, world
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.patch import weakenings
from worldagent.worlds.spec import ContactPair, ElasticPhysics, ForceDriver, Pin, ReleaseDriver, RigidSettings, SpringJoint

SOFT = ElasticPhysics(young_modulus=1e5)


def things(physics=SOFT, **more):
    return {
        "floor": ground(),
        "soft": box(0.2, 0.2, 0.2, motion=more.pop("motion", "dynamic"), at=(0, 0, 0.2), physics=physics),
        "block": box(0.1, 0.1, 0.1, motion="dynamic", at=(1, 0, 0.05)),
        **more,
    }


def problems(spec):
    row = next(r for r in audit(spec).rows if r.id == "audit:elastic")
    return row, {p.split(": ")[0] for p in row.evidence["problems"]} if row.status == "fail" else set()


def test_a_sound_elastic_body_passes():
    drivers = {"go": ReleaseDriver(entity="soft", time=0.1)}
    assert problems(world(things(), drivers=drivers))[0].status == "pass"


@pytest.mark.parametrize(
    ("changes", "place"),
    [
        ({"motion": "static"}, "/entities/soft/motion"),
        ({"physics": ElasticPhysics(young_modulus=1e5, resolution=0.5)}, "/entities/soft/physics/resolution"),
    ],
)
def test_bodies_that_no_engine_moves_are_named(changes, place):
    row, places = problems(world(things(**changes)))
    assert place in places
    assert row.corrections[0].patch


@pytest.mark.parametrize(
    ("plan", "place"),
    [
        ({"settings": RigidSettings(step=2e-3)}, "/simulation/solvers/rigid/settings/step"),
        ({"settings": RigidSettings(skin=0.015)}, "/simulation/solvers/rigid/settings/skin"),
        ({"drivers": {"d": ForceDriver(entity="soft", force=(1, 0, 0), end=1.0)}}, "/simulation/drivers/d/entity"),
        (
            {"joints": {"j": SpringJoint(child="soft", parent_point=(0, 0, 1), child_point=(0, 0, 0.3), stiffness=10)}},
            "/simulation/joints/j/child",
        ),
    ],
)
def test_plans_that_the_engine_cannot_carry_out_are_named(plan, place):
    assert place in problems(world(things(), **plan))[1]


def test_special_contacts_and_pins_on_soft_bodies_are_named():
    spec = world(things())
    plan = spec.simulation.model_copy(update={"contacts": {"c": ContactPair(a="soft", b="floor", friction=0.1)}})
    assert "/simulation/contacts/c" in problems(spec.model_copy(update={"simulation": plan}))[1]
    pinned = ElasticPhysics(young_modulus=1e5, pins={"p": Pin(center=(0, 0, 0), size=(1, 1, 1), to="other")})
    other = box(0.1, 0.1, 0.1, motion="dynamic", at=(2, 0, 0.05), physics=SOFT)
    assert "/entities/soft/physics/pins/p/to" in problems(world(things(pinned, other=other)))[1]


def test_wider_bounds_are_weakenings():
    wide = ElasticPhysics(young_modulus=1e5, max_strain=0.9, recovery=0.1)
    found = weakenings(world(things()), world(things(wide)))
    assert [f.split(" ")[0] for f in found] == ["/entities/soft/physics/max_strain", "/entities/soft/physics/recovery"]
    assert weakenings(world(things(wide)), world(things())) == []
