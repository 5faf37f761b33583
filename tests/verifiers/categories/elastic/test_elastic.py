"""Elastic bodies, judged on vertices written by hand: one world that passes, and one broken on purpose per check (R101)."""

from __future__ import annotations

import numpy as np
import pytest
from worldagent.testing.worlds.small_worlds import Touch, box, ground, world
from worldagent.testing.worlds.soft_worlds import block_mesh, deformed_candidate
from worldagent.tests.verifiers.agreement import evaluate
from worldagent.verifiers.categories.elastic import check as elastic
from worldagent.worlds.predicates import Deflection, Strain
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import ElasticPhysics, Pin

SIZE, FRAMES, G, HIGH = (0.4, 0.2, 0.2), 12, 9.81, 2.0
MESH = block_mesh(SIZE, (4, 2, 2))


def squeezed(share, poisson=0.3):
    """Stretch along z by 1 + share(t), sideways by Poisson's ratio, about the middle of the bottom."""

    def move(t, x):
        s = share(t)
        return np.column_stack([x[:, :2] * (1 - poisson * s), x[:, 2] * (1 + s)])

    return move


def falling(t, x):
    return x - [0, 0, 0.5 * G * t * t]


def still(t, x):
    return x


def judged(tmp_path, move, *, at=0.0, physics=None, touch=True, **more) -> dict[str, Row]:
    physics = physics or ElasticPhysics(young_modulus=1e5)
    things = {"floor": ground(), "soft": box(*SIZE, motion="dynamic", at=(0, 0, SIZE[2] / 2 + at), physics=physics)}
    touches = [Touch(k, "floor", "soft", impulse=600 * 0.016 * G / 24) for k in range(FRAMES)] if touch else []
    candidate = deformed_candidate(
        tmp_path, world(things, frames=FRAMES), {"soft": MESH}, {"soft": move}, touches=touches, **more
    )
    return {r.id.split(":")[2]: r for r in elastic.category_rows(candidate, "rigid")}


def statuses(rows):
    return {name: row.status for name, row in rows.items()}


def test_a_block_at_rest_passes(tmp_path):
    rows = judged(tmp_path, still)
    held = {"shape", "strain", "self", "volume", "step", "recovery", "energy", "solve", "records", "mass"}
    none = dict.fromkeys(("pins", "flight", "exchange", "together", "fields"), "not_applicable")
    assert statuses(rows) == dict.fromkeys(held, "pass") | none


def test_free_fall_passes_and_hovering_fails(tmp_path):
    rows = judged(tmp_path / "a", falling, at=HIGH, touch=False)
    assert rows["flight"].status == "pass"
    assert rows["flight"].measured < 1e-4
    rows = judged(tmp_path / "b", still, at=HIGH, touch=False)
    assert (rows["flight"].status, rows["flight"].first_failing_frame) == ("fail", 1)
    assert rows["flight"].measured == pytest.approx(G / 24, rel=1e-6)


def test_strain_is_measured_exactly_and_judged_against_the_contract(tmp_path):
    """Law: an even stretch of 10 % is a strain of 0.1 everywhere."""
    rows = judged(tmp_path / "a", squeezed(lambda t: 0.1))
    assert rows["strain"].measured == pytest.approx(0.1, abs=1e-12)
    assert rows["strain"].status == "pass"
    rows = judged(
        tmp_path / "b", squeezed(lambda t: 0.1 if t > 0.2 else 0.0), physics=ElasticPhysics(young_modulus=1e5, max_strain=0.08)
    )
    assert (rows["strain"].status, rows["strain"].first_failing_frame) == ("fail", 5)
    assert {c.group for c in rows["strain"].corrections} == {"stiffness", "resolution", "step"}


def test_an_inverted_tetrahedron_fails_at_its_frame(tmp_path):
    def move(t, x):
        x = x.copy()
        if t > 0.3:
            x[21] += [0, 0, 0.25]  # a vertex is pushed through its neighbours
        return x

    rows = judged(tmp_path, move)
    assert (rows["shape"].status, rows["shape"].first_failing_frame) == ("fail", 8)
    assert rows["shape"].measured < 0
    assert rows["shape"].evidence["inverted"] > 0


def test_a_vertex_that_is_not_finite_fails(tmp_path):
    rows = judged(tmp_path, lambda t, x: x * (np.nan if t > 0.3 else 1.0))
    assert rows["shape"].status == rows["strain"].status == rows["energy"].status == "fail"
    assert rows["shape"].first_failing_frame == 8


def test_a_surface_through_itself_fails(tmp_path):
    """A bar rolled up by more than a turn: no tetrahedron is inverted, and its ends overlap."""

    def move(t, x):
        if t <= 0:
            return x
        r = SIZE[0] / (min(t / 0.3, 1.0) * 7.0)
        a = x[:, 0] / r
        z = x[:, 2] - 0.1
        return np.column_stack([(r - z) * np.sin(a), x[:, 1], 0.1 + r - (r - z) * np.cos(a)])

    fine = block_mesh((0.4, 0.02, 0.02), (32, 2, 2))
    things = {
        "floor": ground(),
        "soft": box(0.4, 0.02, 0.02, motion="dynamic", at=(0, 0, 0.1), physics=ElasticPhysics(young_modulus=1e5)),
    }
    candidate = deformed_candidate(tmp_path, world(things, frames=FRAMES), {"soft": fine}, {"soft": move})
    rows = {r.id.split(":")[2]: r for r in elastic.category_rows(candidate, "rigid")}
    assert rows["self"].status == "fail"
    assert 6 <= rows["self"].first_failing_frame <= 8


def test_lost_volume_fails(tmp_path):
    physics = ElasticPhysics(young_modulus=1e5, poisson_ratio=0.49, max_strain=0.5)
    rows = judged(tmp_path, lambda t, x: x * (1 - 0.1 * min(t / 0.2, 1.0)), physics=physics)
    assert rows["volume"].status == "fail"
    assert rows["volume"].measured == pytest.approx(1 - 0.9**3, abs=1e-9)


def test_a_body_that_stays_dented_has_not_recovered(tmp_path):
    """A dent of 3 cm that stays, in a body that hardly gives way under its own weight."""

    def dented(t, x):
        depth = 0.03 * min(t / 0.2, 1.0) * np.exp(-((x[:, 0] / 0.1) ** 2)) * (x[:, 2] / SIZE[2])
        return np.column_stack([x[:, 0], x[:, 1], x[:, 2] - depth])

    stiff = ElasticPhysics(young_modulus=1e7)
    rows = judged(tmp_path / "a", dented, physics=stiff)
    assert (rows["recovery"].status, rows["recovery"].first_failing_frame) == ("fail", FRAMES - 1)
    assert judged(tmp_path / "b", still, physics=stiff)["recovery"].status == "pass"
    soft = ElasticPhysics(young_modulus=1e7, yield_strain=0.01)
    assert judged(tmp_path / "c", dented, physics=soft)["recovery"].status == "not_applicable"


def test_a_pin_that_slips_fails(tmp_path):
    pins = {"wall": Pin(center=(-0.2, 0, 0), size=(0.01, 0.3, 0.3))}
    physics = ElasticPhysics(young_modulus=1e6, pins=pins)
    assert judged(tmp_path / "a", still, physics=physics)["pins"].status == "pass"
    rows = judged(tmp_path / "b", lambda t, x: x + np.array([0.2 * t, 0, 0]), physics=physics)
    assert rows["pins"].status == "fail"
    assert rows["pins"].evidence["pin"] == "wall"
    assert rows["pins"].measured == pytest.approx(0.2 * (FRAMES - 1) / 24, abs=1e-9)


def test_too_long_a_step_for_its_edges_fails(tmp_path):
    rows = judged(tmp_path, still, travel=0.09)
    assert rows["step"].status == "fail"
    assert judged(tmp_path / "b", still, travel=0.01)["step"].status == "pass"


def test_energy_from_nowhere_fails(tmp_path):
    strain = np.zeros(FRAMES)
    strain[7:] = 5.0
    rows = judged(tmp_path, still, strain_energy=strain)
    assert (rows["energy"].status, rows["energy"].first_failing_frame) == ("fail", 7)


def test_a_solve_that_did_not_converge_fails(tmp_path):
    assert judged(tmp_path / "a", still, residual=1e-6)["solve"].status == "pass"
    row = judged(tmp_path / "b", still, residual=0.2)["solve"]
    assert (row.status, row.first_failing_frame) == ("fail", 0)
    assert {c.group for c in row.corrections} == {"step", "mass", "resolution"}


def test_records_that_are_not_those_of_the_vertices_fail(tmp_path):
    rows = judged(tmp_path, falling, at=HIGH, touch=False, kinetic=0.5)
    assert rows["records"].status == "fail"
    assert rows["records"].evidence["quantity"] == "elastic_kinetic_energy"


def test_missing_records_leave_rows_open(tmp_path):
    rows = judged(tmp_path, still, without=("record/strain_energy",))
    assert rows["energy"].status == rows["records"].status == "unverified"


def test_predicates_measure_strain_and_deflection(tmp_path):
    things = {"floor": ground(), "soft": box(*SIZE, motion="dynamic", at=(0, 0, 0.1), physics=ElasticPhysics(young_modulus=1e5))}
    move = squeezed(lambda t: 0.2 * np.sin(np.pi * t * 24 / (FRAMES - 1)) if t >= 0 else 0.0, poisson=0.0)
    candidate = deformed_candidate(tmp_path, world(things, frames=FRAMES), {"soft": MESH}, {"soft": move})
    span = (0, FRAMES - 1)
    most = 0.2 * np.sin(np.pi * 5 / 11)
    assert evaluate(candidate, Strain(entity="soft", min=0.99 * most), span).status == "pass"
    assert evaluate(candidate, Strain(entity="soft", min=1.01 * most), span).status == "fail"
    found = evaluate(candidate, Deflection(entity="soft", min=0.5 * most * SIZE[2] * 0.99), span)
    assert found.status == "pass"
    assert evaluate(candidate, Deflection(entity="soft", max=1e-6, when="end"), span).status == "pass"
    assert evaluate(candidate, Deflection(entity="floor", max=1.0), span).status == "unverified"
