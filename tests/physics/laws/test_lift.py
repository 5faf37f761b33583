"""The law of lift: coefficients of plates by the formulas that are cited, another published law, symmetries, and energy that it never gives."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.physics.drag import Medium, area_vectors, drag_force, projected_area
from worldagent.physics.lift import Hull, Wrench, hull_of, normal_share, pressure_point, stacked, wrenches
from worldagent.worlds.arrays import F64, rotation_matrix

ACROSS = 1.15
BY_FORMULA = {10.0: 0.425, 20.0: 0.85, 30.0: 1.275, 40.0: 1.7, 60.0: 1.15, 90.0: 1.15}
"""C_N of square plates by angle of attack [degrees]: Richards et al. (2008), Kordi and Kopp (2009)."""
CENTRES = {0.0: 0.3, 19.0: 0.19, 38.0: 0.08, 60.0: 0.08 * np.cos(np.radians(44.0)), 90.0: 0.0}
"""Centre of pressure ahead of the middle over the length, from the same."""
POLHAMUS = 1.48, np.pi
"""K_p and K_v of a plate as long as wide: E. C. Polhamus, NASA TN D-3767 (1966), with K_p by R. T. Jones's 2 pi A / (2 + sqrt(A^2 + 4))."""


def corners(*size: float) -> F64:
    return np.asarray(np.array([[i, j, k] for i in (-0.5, 0.5) for j in (-0.5, 0.5) for k in (-0.5, 0.5)]) * np.array(size))


def hull(points: F64, center: tuple[float, float, float] = (0, 0, 0)) -> Hull:
    found = hull_of(points, np.array(center))
    assert found is not None
    return found


def ball(count: int) -> F64:
    k = np.arange(count) + 0.5
    z, turn = 1.0 - 2.0 * k / count, k * np.pi * (1.0 + np.sqrt(5.0))
    return np.stack([np.sqrt(1.0 - z**2) * np.cos(turn), np.sqrt(1.0 - z**2) * np.sin(turn), z], axis=1)


def pushed(body: Hull, flow: F64, spin: F64 | None = None, turn: F64 | None = None, pressure: float = 1.0) -> Wrench:
    """Push of a flow, or of several, on a body; `pressure`: 1/2 rho C."""
    flows = np.atleast_2d(np.asarray(flow, dtype=float))
    n = len(flows)
    turns = np.repeat(np.eye(3)[None], n, axis=0) if turn is None else np.broadcast_to(turn, (n, 3, 3))
    spins = np.zeros((n, 3)) if spin is None else np.broadcast_to(spin, (n, 3))
    return wrenches(stacked([body] * n), turns, flows, spins, np.full(n, pressure))


def at(degrees: float) -> F64:
    """Flow of 1 m/s along +x and up that meets a plate across z at an angle of attack."""
    return np.array([np.cos(np.radians(degrees)), 0.0, np.sin(np.radians(degrees))])


CARD = hull(corners(1.0, 1.0, 1e-4))


@pytest.mark.parametrize("degrees", BY_FORMULA)
def test_a_thin_plate_has_the_coefficients_of_the_formula(degrees: float) -> None:
    """Law: C_L = C_N cos a, C_D = C_N sin a, with the declared coefficient as C_N across the flow."""
    found, along = pushed(CARD, at(degrees), pressure=ACROSS), at(degrees)
    across = np.array([-along[2], 0.0, along[0]])
    drag, lift = float(found.force[0] @ along), float(found.force[0] @ across)
    assert drag == pytest.approx(BY_FORMULA[degrees] * np.sin(np.radians(degrees)), rel=2e-3, abs=5e-4)
    assert lift == pytest.approx(BY_FORMULA[degrees] * np.cos(np.radians(degrees)), rel=2e-3, abs=5e-4)
    assert float(normal_share(np.array(degrees))) * ACROSS == pytest.approx(BY_FORMULA[degrees])


@pytest.mark.parametrize("degrees", CENTRES)
def test_the_push_acts_ahead_of_the_middle_by_the_distance_of_the_formula(degrees: float) -> None:
    assert float(pressure_point(np.array(degrees))) == pytest.approx(CENTRES[degrees], abs=1e-12)
    if degrees > 5.0:
        # Torque about +y over the force along +z is the way of the point against the flow along +x.
        found = pushed(CARD, at(degrees))
        assert found.torque[0, 1] / found.force[0, 2] == pytest.approx(CENTRES[degrees], rel=2e-3, abs=2e-4)


@pytest.mark.parametrize(("degrees", "within"), [(10.0, 0.25), (20.0, 0.02), (30.0, 0.12)])
def test_lift_is_near_that_of_the_leading_edge_suction(degrees: float, within: float) -> None:
    """Another published law, of wings with a vortex over their edges: C_L = K_p sin cos^2 + K_v cos sin^2."""
    sine, cosine, (potential, vortex) = np.sin(np.radians(degrees)), np.cos(np.radians(degrees)), POLHAMUS
    wanted = potential * sine * cosine**2 + vortex * cosine * sine**2
    found = pushed(CARD, at(degrees), pressure=ACROSS).force[0]
    assert found[2] * cosine - found[0] * sine == pytest.approx(wanted, rel=within)


def test_across_the_flow_a_square_plate_has_hoerners_coefficient() -> None:
    """Fluid-Dynamic Drag (1965), chapter 3: 1.17."""
    assert pushed(CARD, at(90.0), pressure=ACROSS).force[0, 2] == pytest.approx(1.17, rel=0.02)


@pytest.mark.parametrize("shape", ["cube", "ball"])
def test_what_is_as_thick_as_wide_has_its_drag_of_before_and_nothing_else(shape: str) -> None:
    """Symmetry: at rest, from every side; a hull of 800 corners is round within 1 %."""
    points = corners(1.0, 1.0, 1.0) if shape == "cube" else ball(800)
    body, flows = hull(points), np.random.default_rng(1).normal(size=(40, 3))
    found, vectors = pushed(body, flows), area_vectors(points)
    none = np.zeros(len(vectors), dtype=np.int64)
    shown = np.array([projected_area(vectors, none, np.eye(3)[None], f[None])[0] for f in flows])
    one = np.ones(len(flows))
    drag = drag_force(Medium(flows, 2.0 * one, 0.0 * one, one), shown, np.zeros_like(flows))
    within = 1e-9 if shape == "cube" else 0.01
    assert found.force == pytest.approx(drag, rel=within, abs=within)
    assert np.abs(found.torque).max() < within * np.linalg.norm(drag, axis=1).max()
    assert body.flatness < within


def test_a_plate_edge_on_or_across_has_no_lift_by_symmetry() -> None:
    for degrees in (0.0, 90.0):
        found = pushed(CARD, at(degrees))
        along = at(degrees)
        assert np.linalg.norm(found.force[0] - (found.force[0] @ along) * along) < 1e-9
        assert np.abs(found.torque).max() < 1e-9


def test_no_way_of_cutting_faces_into_triangles_matters() -> None:
    """Points on the faces and edges of a box give more and other triangles, and the same push to the last bits."""
    plain = corners(0.4, 0.3, 0.02)
    grid = np.array([[x, y, z] for x in np.linspace(-0.2, 0.2, 5) for y in np.linspace(-0.15, 0.15, 4) for z in (-0.01, 0.01)])
    one, two = hull(plain), hull(np.concatenate([plain, grid]))
    flows = np.random.default_rng(2).normal(size=(30, 3))
    for a, b in ((pushed(one, flows), pushed(two, flows)),):
        assert a.force == pytest.approx(b.force, rel=1e-9, abs=1e-12)
        assert a.torque == pytest.approx(b.torque, rel=1e-9, abs=1e-12)
        assert a.resistance == pytest.approx(b.resistance, rel=1e-9, abs=1e-12)


def disc(corners_of: int, rings: int = 1) -> F64:
    """Points of a disc whose rim is rounded in some rings."""
    turn = np.linspace(0.0, 2.0 * np.pi, corners_of, endpoint=False)
    lean = np.linspace(-0.5 * np.pi, 0.5 * np.pi, rings + 1) if rings > 1 else np.array([-0.5 * np.pi, 0.5 * np.pi])
    return np.array(
        [
            [(0.5 + 0.01 * np.cos(a)) * np.cos(t), (0.5 + 0.01 * np.cos(a)) * np.sin(t), 0.01 * np.sin(a)]
            for a in lean
            for t in turn
        ]
    )


def test_push_and_torque_converge_with_the_facets_of_the_hull() -> None:
    """Convergence: a disc with 12, 24, 48 corners comes to that of 96 with the square of their number (a polygon of 12 has 4.5 % less area, its torque 7 %); beyond 128 faces they are gathered."""
    flows = np.array([at(d) for d in (8.0, 25.0, 43.0, 70.0)])
    fine = pushed(hull(disc(96)), flows)
    errors = []
    for count in (12, 24, 48):
        found = pushed(hull(disc(count)), flows)
        errors.append(
            max(
                np.abs(found.force - fine.force).max() / np.abs(fine.force).max(),
                np.abs(found.torque - fine.torque).max() / np.abs(fine.torque).max(),
            )
        )
    assert errors[0] < 0.08
    assert errors[1] < 0.3 * errors[0]
    assert errors[2] < 0.35 * errors[1]
    round_rim, finer = (pushed(hull(disc(96, rings)), flows) for rings in (8, 16))
    assert finer.force == pytest.approx(round_rim.force, rel=0.02, abs=0.01)
    assert finer.torque == pytest.approx(round_rim.torque, rel=0.03, abs=0.002)


@pytest.mark.parametrize("size", [(0.1, 0.1, 0.0005), (0.42, 0.33, 0.02), (0.5, 0.1, 0.01), (1, 1, 0.3), (0.2, 0.1, 0.06)])
@pytest.mark.parametrize("offset", [0.0, 0.2])
def test_it_never_gives_energy_in_the_frame_of_the_medium(size: tuple[float, float, float], offset: float) -> None:
    """Law of the second kind: F (v - u) + M w <= 0 at every attitude, speed and spin, wherever the centre of mass is."""
    rng, n = np.random.default_rng(3), 5000
    body = hull(corners(*size), (offset * size[0], -0.5 * offset * size[1], 0.0))
    turns = rotation_matrix(np.asarray([q / np.linalg.norm(q) for q in rng.normal(size=(n, 4))]))
    flows = rng.normal(size=(n, 3))
    spins = rng.normal(size=(n, 3)) * (10.0 ** rng.uniform(-2, 1.5, n) / size[0])[:, None]
    found = wrenches(stacked([body] * n), turns, flows, spins, np.ones(n))
    power = -(found.force * flows).sum(axis=1) + (found.turning(spins) * spins).sum(axis=1)
    assert power.max() < 0.0


def test_it_turns_with_the_body_and_grows_with_the_square_of_the_flow() -> None:
    turn = rotation_matrix(np.array([[0.8, 0.1, -0.5, 0.3]]) / np.linalg.norm([0.8, 0.1, -0.5, 0.3]))[0]
    plain, turned = pushed(CARD, at(25.0)), pushed(CARD, turn @ at(25.0), turn=turn)
    assert turned.force[0] == pytest.approx(turn @ plain.force[0])
    assert turned.torque[0] == pytest.approx(turn @ plain.torque[0])
    assert pushed(CARD, 3.0 * at(25.0)).force == pytest.approx(9.0 * plain.force)


def test_a_plate_that_turns_in_still_air_is_stopped_by_the_drag_of_its_strips() -> None:
    """Closed form: M = 1/2 rho C w^2 b L^4 / 32 about its middle line."""
    found = pushed(hull(corners(0.3, 0.2, 1e-5)), np.zeros(3), spin=np.array([0.0, 7.0, 0.0]), pressure=2.0)
    wanted = 2.0 * 49.0 * 0.2 * 0.3**4 / 32.0
    assert found.turning(np.array([[0.0, 7.0, 0.0]]))[0] == pytest.approx([0.0, -wanted, 0.0], rel=0.01, abs=1e-9)


def test_what_encloses_nothing_has_no_hull() -> None:
    assert hull_of(np.zeros((4, 3)), np.zeros(3)) is None
