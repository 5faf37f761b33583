"""Force fields as functions of point and time, and what the audit says of their drivers."""

from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError
from worldagent.tests.physics.rigid_world import ball, floor, world
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.drivers import acts_from
from worldagent.worlds.fields import Fields
from worldagent.worlds.spec import FieldDriver


def fields(**driver: Any) -> Fields:
    return Fields({"f": FieldDriver.model_validate({"kind": "field", **driver})})


def points(count: int, reach: float = 5.0) -> Any:
    return np.random.default_rng(0).uniform(-reach, reach, (count, 3))


def test_turbulence_has_its_declared_speed_and_no_divergence():
    flow = fields(field={"kind": "turbulence", "speed": 3.0, "length": 1.0})
    at, step = points(4000), 1e-4
    velocity = flow.medium(at, 0.3).velocity
    assert np.sqrt((velocity**2).sum(axis=1).mean()) == pytest.approx(3.0, rel=0.05)
    slopes = [
        (flow.medium(at + step * e, 0.3).velocity - flow.medium(at - step * e, 0.3).velocity) / (2 * step) for e in np.eye(3)
    ]
    divergence = sum(slopes[i][:, i] for i in range(3))
    assert np.abs(divergence).max() < 1e-4 * np.abs(slopes).max()


def test_the_seed_alone_decides_the_eddies():
    law = {"kind": "turbulence", "speed": 1.0, "length": 2.0}
    at = points(10)
    first, again, other = (fields(field=law, seed=s).medium(at, 1.7).velocity for s in (4, 4, 5))
    assert (first == again).all()
    assert np.abs(first - other).max() > 0.1


def test_gusts_stay_within_their_share_and_keep_the_direction():
    wind = fields(field={"kind": "wind", "velocity": (10, 0, 0), "gust": 0.4})
    speeds = np.array([wind.medium(np.zeros((1, 3)), t).velocity[0] for t in np.linspace(0, 60, 600)])
    assert (speeds[:, 1:] == 0).all()
    assert speeds[:, 0].min() >= 6.0
    assert speeds[:, 0].max() <= 14.0
    assert np.ptp(speeds[:, 0]) > 2.0


def test_a_vortex_is_fastest_at_its_core_and_turns_by_the_right_hand():
    vortex = fields(field={"kind": "vortex", "center": (1, 0, 0), "speed": 8.0, "core": 0.5, "updraft": 3.0})
    at = np.array([[1.5, 0, 7.0], [1.0, 0, -2.0], [1.25, 0, 0], [3.0, 0, 0]])
    found = vortex.medium(at, 0.0).velocity
    assert found[0] == pytest.approx([0, 8.0, 0.75])
    assert found[1] == pytest.approx([0, 0, 3.0])
    assert found[2, 1] < 8.0
    assert found[3, 1] < 8.0


def test_attraction_is_as_declared_at_its_distance_and_zero_at_the_centre():
    pull = fields(field={"kind": "attraction", "center": (0, 0, 1), "acceleration": 6.0, "distance": 2.0})
    found = pull.acceleration(np.array([[2.0, 0, 1], [4.0, 0, 1], [1.0, 0, 1], [0, 0, 1.0]]), 0.0)
    assert found == pytest.approx(np.array([[-6.0, 0, 0], [-1.5, 0, 0], [-3.0, 0, 0], [0, 0, 0]]))
    line = fields(field={"kind": "attraction", "center": (0, 0, 0), "axis": (0, 0, 1), "acceleration": 6.0, "distance": 2.0})
    assert line.acceleration(np.array([[0, 2.0, 9.0]]), 0.0)[0] == pytest.approx([0, -6.0, 0])


def test_a_field_acts_within_its_region_and_time():
    driver = {"field": {"kind": "wind", "velocity": (4, 0, 0)}, "start": 1.0, "rise": 2.0, "end": 5.0}
    box = {"kind": "box", "pose": {"position": (0, 0, 1), "euler": (0, 0, np.pi / 2)}, "size": (4, 2, 2)}
    wind = fields(**driver, region=box, fade=0.5)
    at = np.array([[0, 0, 1.0], [0, 1.9, 1.0], [1.9, 0, 1.0], [0, 1.75, 1.0]])
    assert wind.medium(at, 0.99).density.max() == 0
    assert wind.medium(at, 2.0).velocity[0] == pytest.approx([2, 0, 0])
    late = wind.medium(at, 4.0)
    assert late.velocity[:, 0] == pytest.approx([4.0, 4 * 0.04 * 2.6, 0.0, 2.0])
    assert wind.medium(at, 5.0).density.max() == 0
    assert [wind.acts(*t) for t in ((0, 1), (0, 1.1), (5, 6))] == [False, True, False]


def test_velocities_add_up_and_the_densest_medium_holds():
    drivers = {
        "a": {"kind": "field", "field": {"kind": "wind", "velocity": (3, 0, 0)}},
        "b": {"kind": "field", "field": {"kind": "wind", "velocity": (0, 1, 0), "density": 1000.0, "viscosity": 1e-3}},
    }
    both = Fields({k: FieldDriver.model_validate(d) for k, d in drivers.items()}).medium(np.zeros((1, 3)), 0.0)
    assert both.velocity[0] == pytest.approx([3, 1, 0])
    assert (both.density[0], both.viscosity[0]) == (1000.0, 1e-3)


@pytest.mark.parametrize(
    ("driver", "said"),
    [
        ({"entities": ["ground"]}, "static"),
        ({"start": 50.0}, "after the last frame"),
    ],
)
def test_the_audit_tells_fields_that_do_nothing(driver: dict[str, Any], said: str):
    field = {"kind": "field", "field": {"kind": "wind", "velocity": (1, 0, 0)}, **driver}
    spec = world({"ground": floor(), "b": ball(0.1, at=(0, 0, 1))}, drivers={"w": field})
    row = next(r for r in audit(spec).rows if r.id == "audit:fields")
    assert row.status == "fail"
    assert any(said in c.action for c in row.corrections)


def test_a_field_on_a_body_that_is_not_there_is_told():
    field = {"kind": "field", "field": {"kind": "drag"}, "entities": ["b", "nobody"]}
    spec = world({"ground": floor(), "b": ball(0.1, at=(0, 0, 1))}, drivers={"w": field})
    told = [c.action for r in audit(spec).rows if r.status == "fail" for c in r.corrections]
    assert any("unknown entity 'nobody'" in text for text in told), told


def test_a_field_on_a_body_passes_the_audit_and_a_wrong_one_is_no_field():
    field = {"kind": "field", "field": {"kind": "drag"}, "entities": ["b"]}
    spec = world({"ground": floor(), "b": ball(0.1, at=(0, 0, 1))}, drivers={"w": field})
    assert next(r for r in audit(spec).rows if r.id == "audit:fields").status == "pass"
    with pytest.raises(ValidationError, match="end must be > start"):
        fields(field={"kind": "drag"}, start=2.0, end=1.0)


def test_a_field_that_starts_below_zero_acts_within_the_preroll():
    still = fields(field={"kind": "drag"}, start=-2.0)
    at = np.zeros((1, 3))
    assert still.medium(at, -2.1).density.max() == 0
    assert still.medium(at, -1.9).density.max() == still.medium(at, 1.0).density.max() > 0
    assert fields(field={"kind": "drag"}).medium(at, -1.9).density.max() == 0
    spec = world(
        {"ground": floor(), "b": ball(0.1, at=(0, 0, 1))},
        drivers={"w": {"kind": "field", "field": {"kind": "drag"}, "start": -2.0}},
    )
    assert acts_from(spec, "w")[0] == 0.0
