"""Drag against tabulated coefficients and closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from worldagent.physics.drag import Medium, area_vectors, drag_force, face_drag, projected_area, sphere_drag_rate

DENSE, THICK = 1.2, 1.8e-5
STANDARD = {0.1: 244.0, 1.0: 27.2, 10.0: 4.26, 100.0: 1.09, 1000.0: 0.471, 10000.0: 0.405}
"""Standard drag curve of spheres: Clift, Grace and Weber (1978), table 5.2."""


def medium(*flows: tuple[float, float, float], coefficient: float = 1.0) -> Medium:
    one = np.ones(len(flows))
    return Medium(np.array(flows, dtype=float), DENSE * one, THICK * one, coefficient * one)


def coefficient_of_a_sphere(reynolds: float, radius: float = 1e-3) -> float:
    """Drag coefficient from the rate that is found at a Reynolds number."""
    speed = reynolds * THICK / (2.0 * DENSE * radius)
    rate = sphere_drag_rate(medium((speed, 0, 0)), np.array([radius]), np.array([1.0]), np.zeros((1, 3)))[0]
    return float(rate * speed / (0.5 * DENSE * speed**2 * np.pi * radius**2))


@pytest.mark.parametrize("reynolds", STANDARD)
def test_a_sphere_has_the_coefficients_of_the_standard_drag_curve(reynolds: float) -> None:
    """Law: Schiller and Naumann lie within 5 % of the curve below 800, Newton's 0.44 within 10 % up to 10000."""
    within = 0.05 if reynolds < 800 else 0.1
    assert coefficient_of_a_sphere(reynolds) == pytest.approx(STANDARD[reynolds], rel=within)


def test_a_slow_sphere_is_dragged_by_stokes_law() -> None:
    """Limit: C = 24 / Re."""
    assert coefficient_of_a_sphere(1e-4) == pytest.approx(24.0 / 1e-4, rel=1e-3)


def test_millikans_oil_drop_falls_at_the_speed_of_stokes() -> None:
    """Worked example: a drop of 2 um radius of 880 kg/m^3 in air falls at 2 r^2 g rho / 9 mu."""
    radius, mass = 2e-6, 880.0 * 4.0 / 3.0 * np.pi * 8e-18
    speed = 2.0 * radius**2 * 9.81 * 880.0 / (9.0 * THICK)
    rate = sphere_drag_rate(medium((0, 0, 0)), np.array([radius]), np.array([mass]), np.array([[0.0, 0.0, -speed]]))[0]
    assert rate * speed == pytest.approx(9.81, rel=0.01)


def test_the_drag_of_a_sphere_is_nearly_continuous_where_newtons_law_begins() -> None:
    assert coefficient_of_a_sphere(1000.1) == pytest.approx(coefficient_of_a_sphere(1000.0), rel=0.004)


def test_no_medium_drags_no_sphere() -> None:
    nothing = Medium(np.ones((1, 3)), np.zeros(1), np.zeros(1), np.zeros(1))
    assert sphere_drag_rate(nothing, np.array([0.1]), np.array([1.0]), np.zeros((1, 3)))[0] == 0.0


def test_a_plate_across_a_wind_feels_its_stagnation_pressure_times_the_coefficient() -> None:
    """Worked example: 10 m/s of air of 1.2 kg/m^3 on 2 m^2 with C = 1.17 (a square plate): 140.4 N; against the flow when it flees."""
    air = medium((10, 0, 0), (10, 0, 0), (0, 0, 0), coefficient=1.17)
    still = np.array([[0.0, 0, 0], [10, 0, 0], [10, 0, 0]])
    found = drag_force(air, np.full(3, 2.0), still)
    assert found == pytest.approx(np.array([[140.4, 0, 0], [0, 0, 0], [-140.4, 0, 0]]))


def _hull(corners: Any) -> tuple[Any, Any]:
    vectors = area_vectors(corners)
    return vectors, np.zeros(len(vectors), dtype=np.int64)


def test_a_box_shows_the_sum_of_its_faces_shadows() -> None:
    vectors, owner = _hull(np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-1, 1) for z in (-1.5, 1.5)]))
    for flow, area in (((1, 0, 0), 6.0), ((0, 0, -2), 2.0), ((1, 1, 0), 9 / np.sqrt(2))):
        assert projected_area(vectors, owner, np.eye(3)[None], np.array([flow], dtype=float))[0] == pytest.approx(area)


def test_the_mean_shadow_of_a_convex_body_is_a_quarter_of_its_surface() -> None:
    """Law: Cauchy's theorem, here for a box of 1 x 2 x 3 m with 22 m^2."""
    vectors, owner = _hull(np.array([[x, y, z] for x in (0, 1) for y in (0, 2) for z in (0, 3)]))
    flows = np.random.default_rng(0).normal(size=(4000, 3))
    shadows = [projected_area(vectors, owner, np.eye(3)[None], flow[None])[0] for flow in flows]
    assert float(np.mean(shadows)) == pytest.approx(22.0 / 4.0, rel=0.01)


def test_many_facets_are_gathered_and_still_show_a_circle() -> None:
    sphere = np.random.default_rng(1).normal(size=(3000, 3))
    sphere /= np.linalg.norm(sphere, axis=1)[:, None]
    vectors, owner = _hull(sphere)
    seen = projected_area(vectors, owner, np.eye(3)[None], np.array([[0.3, 0.2, -0.7]]))
    assert len(vectors) == 128
    assert seen[0] == pytest.approx(np.pi, rel=0.01)


def test_a_turned_body_shows_what_it_would_show_to_the_turned_flow() -> None:
    vectors, owner = _hull(np.array([[x, y, z] for x in (0, 1) for y in (0, 2) for z in (0, 3)]))
    quarter = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    assert projected_area(vectors, owner, quarter[None], np.array([[1.0, 0, 0]]))[0] == pytest.approx(3.0)


def test_flat_points_have_no_hull_and_show_nothing() -> None:
    vectors, owner = _hull(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]))
    assert projected_area(vectors, owner, np.eye(3)[None], np.array([[0.0, 0, 1]]))[0] == 0.0


def test_the_faces_that_face_the_flow_are_pushed_with_their_shadow_alone() -> None:
    """The windward faces of a closed surface show its cross-section together, here sqrt(2) m^2 of a unit cube on edge."""
    import trimesh

    cube = trimesh.creation.box()
    corners = np.asarray(cube.triangles)
    found = face_drag(medium(*[(6.0, 6.0, 0.0)] * len(corners)), corners, np.zeros((len(corners), 3)))
    speed = 6.0 * np.sqrt(2.0)
    assert np.linalg.norm(found.force.sum(axis=0)) == pytest.approx(0.5 * DENSE * np.sqrt(2.0) * speed**2)
    assert (found.force[cube.face_normals @ np.array([1.0, 1.0, 0.0]) >= -1e-9] == 0).all()
    assert found.rate * speed == pytest.approx(np.linalg.norm(found.force, axis=1))
