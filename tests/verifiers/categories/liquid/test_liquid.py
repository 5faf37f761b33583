"""Rows of liquids on caches written by hand: each breach fails its own row, at its frame and place."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.defects import _liquid_scenes as scenes
from worldagent.testing.defects import liquid as defects
from worldagent.testing.defects._liquid_resolution import clinging
from worldagent.testing.worlds.liquid_worlds import DENSITY, Flow, pool_in_tank, stream, tank
from worldagent.verifiers.categories import check as category
from worldagent.verifiers.categories.liquid.check import WATCHES
from worldagent.verifiers.diagnosis.cite import diagnose
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Coupling, ReleaseDriver

S = scenes.SPACING


def rng() -> np.random.Generator:
    return np.random.default_rng(3)


def rows_of(candidate: Candidate) -> dict[str, Row]:
    """Rows of the liquid by the name of their claim."""
    rows = [r for r in (*category.check(candidate), *category.check_numerical(candidate)) if r.id.endswith(":water")]
    return {r.id.split(":")[-2]: r for r in rows}


def test_still_water_passes_every_row_that_has_a_case(tmp_path: Path) -> None:
    rows = rows_of(scenes.pool(rng()).candidate(tmp_path))
    assert set(rows) == {n for watch in WATCHES for n in watch.questions} | {"frames", "digest", "placed", "started"}
    assert {n for n, r in rows.items() if r.status == "not_applicable"} == {
        *("source", "openings", "flight", "received", "declared", "buoyancy", "surface", "closed", "pop", "wet"),
        *("waves_height", "waves_period", "fields"),
    }
    assert {r.status for r in rows.values()} == {"pass", "not_applicable"}


BREACHES = [
    ("volume_removed", 0.02, {"mass", "identity"}),
    ("counted_out", 0.02, {"identity"}),
    ("shrunk", 0.01, {"mass", "records"}),
    ("cooked_records", 0.1, {"records"}),
    ("forged_reaction", 0.01, {"exchange"}),
    ("unequal_sides", 0.01, {"received"}),
    ("sinks_through", 1.0, {"buoyancy"}),
    ("teleport", 4.0, {"jumps"}),
    ("spike", 1.5, {"spikes"}),
    ("hovering", 1.0, {"flight"}),
    ("boiling", 0.3, {"calm"}),
    ("drifting", 0.5, {"momentum"}),
    ("rising", 2.0, {"energy"}),
    ("crushed", 0.2, {"density", "recorded_density"}),
    ("in_wall", 0.012, {"inside"}),
    ("through_wall", 20.0, {"leak"}),
    ("gap", 0.002, {"leak"}),
    ("walled_source", 0.02, {"source"}),
    ("popping", 0.1, {"pop"}),
    ("stray_chunk", 8.0, {"closed"}),
    ("narrow_way", 2.0, {"passages"}),
    ("thin_wall", 0.3, {"obstacles"}),
    ("tight_tap", 2.0, {"openings"}),
    ("tight_drain", 2.0, {"openings"}),
    ("clinging", 12.0, {"sticks"}),
    ("dried", 0.05, {"wet"}),
    ("drowned", 1.0, {"wet"}),
    ("shifted", 1e-3, {"wet"}),
    ("flat_waves", 0.5, {"waves_height"}),
    ("slow_waves", 0.3, {"waves_period"}),
    ("undrawn", 0.2, {"fields", "momentum"}),
]


@pytest.mark.parametrize(("name", "magnitude", "wanted"), BREACHES, ids=[b[0] for b in BREACHES])
def test_a_breach_fails_the_rows_that_are_about_it(tmp_path: Path, name: str, magnitude: float, wanted: set[str]) -> None:
    world = getattr(defects, name)(tmp_path, magnitude, rng())
    rows = rows_of(world.candidate)
    failed = {n for n, r in rows.items() if r.status == "fail"}
    assert wanted <= failed, {n: rows[n].evidence["explanation"] for n in wanted}
    assert all(rows[n].corrections for n in wanted)


def test_liquid_that_clings_to_a_wall_is_sent_to_what_the_wall_does_to_it(tmp_path: Path) -> None:
    """R70: the first correction is of the boundary or of what flows along it, and never of the picture."""
    world = clinging(tmp_path, 12.0, rng())
    row = diagnose(rows_of(world.candidate)["sticks"], world.candidate.spec)
    assert row.status == "fail"
    assert row.first_failing_entity == "tank"
    assert any("wall_friction" in c.action or "wall_friction" in "".join(c.pointers) for c in row.corrections), row.corrections
    assert {c.group for c in row.corrections} <= {"liquid", "resolution", "interval", "shape", "placement"}
    assert not {c.edit_class for c in row.corrections} & {"shot", "text"}


def test_a_leak_names_the_gap_the_part_and_the_first_frame(tmp_path: Path) -> None:
    flow = scenes.draining(rng(), gap=0.002)
    row = rows_of(flow.candidate(tmp_path))["leak"]
    place = row.evidence["place"]
    columns = np.unique(flow.position[0][:, 0])
    middle = columns[np.argmin(np.abs(columns))] if len(columns) % 2 else columns[len(columns) // 2]
    assert abs(place[0] - middle) <= S
    wall = flow.spec.entities["tank"].parts["p4"].shape.size[2]  # type: ignore[union-attr]
    assert -wall - S <= place[2] <= S
    assert (row.first_failing_entity, row.evidence["part"] in {"p4", "p5"}) == ("tank", True)
    assert 3 <= int(row.first_failing_frame or 0) <= 8
    assert row.corrections[0].group == "shape"


def test_water_that_runs_over_the_rim_of_a_tank_is_no_leak(tmp_path: Path) -> None:
    """Particles that leave by an open way are not taken for ones that passed a wall."""
    flow = scenes.pool(rng())
    points = flow.position[0]
    row = int(np.argmax(points[:, 0] + points[:, 2]))
    rim = float(flow.spec.entities["tank"].parts["p0"].shape.size[2])  # type: ignore[union-attr]
    start = points[row]
    keys = np.array(
        [start, [start[0], start[1], rim + 3 * S], [start[0] + 0.12, start[1], rim + 3 * S], [start[0] + 0.12, start[1], 0.05]]
    )
    times = np.array([0, 7, 14, 23])
    for k in range(flow.frames):
        flow.position[k] = points.copy()
        flow.position[k][row] = [np.interp(k, times, keys[:, a]) for a in range(3)]
    assert rows_of(flow.candidate(tmp_path))["leak"].status == "pass"


def test_inflow_and_open_sides_close_the_books(tmp_path: Path) -> None:
    rows = rows_of(stream(speed=1.5).candidate(tmp_path))
    assert (rows["mass"].status, rows["identity"].status, rows["source"].status) == ("pass", "pass", "pass")
    assert rows["mass"].evidence["inflow_kg"] > 10 * rows["mass"].measured  # type: ignore[operator]
    assert rows["identity"].evidence["births"] > 100


@pytest.mark.parametrize(("beyond", "status"), [(9e-16, "pass"), (1e-4, "fail")])
def test_an_opening_may_stand_out_of_the_domain_by_rounding_alone(tmp_path: Path, beyond: float, status: str) -> None:
    """The opening lies in a side: 9e-16 m is what sums of pose and size round to, 0.1 mm is a mistake."""
    flow = stream(speed=1.5)
    solver = flow.spec.simulation.liquid["water"]
    top = float(flow.spec.simulation.drivers["tap"].pose.position[2]) - beyond  # type: ignore[union-attr]
    domain = solver.settings.domain.model_copy(update={"center": (0.0, 0.0, 0.5 * top), "size": (0.6, 0.6, top)})
    solver = solver.model_copy(update={"settings": solver.settings.model_copy(update={"domain": domain})})
    simulation = flow.spec.simulation.model_copy(update={"solvers": {**flow.spec.simulation.solvers, "water": solver}})
    spec = flow.spec.model_copy(update={"simulation": simulation})
    row = rows_of(flow.edited(spec=spec).candidate(tmp_path))["source"]
    assert row.status == status
    assert status == "pass" or row.measured == pytest.approx(beyond, rel=0.01)


def test_mass_that_is_booked_but_never_came_fails(tmp_path: Path) -> None:
    flow = stream(speed=1.5)
    booked = flow.inflow["tap"].copy()
    booked[10:] += 1e-5 * booked[-1]
    row = rows_of(flow.edited(inflow={"tap": booked}).candidate(tmp_path))["mass"]
    assert (row.status, row.first_failing_frame) == ("fail", 10)


def test_liquid_that_starts_in_a_solid_fails_at_frame_zero(tmp_path: Path) -> None:
    flow = scenes.pool(rng(), wall=0.04)
    for k in range(flow.frames):
        flow.position[k] = flow.position[k] - np.array([0, 0, 0.025])
    rows = rows_of(flow.candidate(tmp_path))
    assert (rows["inside"].status, rows["inside"].first_failing_frame, rows["inside"].first_failing_entity) == ("fail", 0, "tank")
    assert rows["inside"].corrections[0].group == "placement"
    assert rows["inside"].evidence["place"][2] < 0


def test_solids_in_the_initial_volume_take_their_share_of_it(tmp_path: Path) -> None:
    """The crate displaces half of its volume; particles fill the rest."""
    row = rows_of(scenes.crate_afloat(rng()).candidate(tmp_path))["start"]
    assert row.status == "pass"
    assert row.measured == pytest.approx(0.0, abs=2e-3)


def test_a_body_without_coupling_must_say_so(tmp_path: Path) -> None:
    flow = scenes.crate_afloat(rng())
    plan = flow.spec.simulation
    bare = flow.edited(spec=flow.spec.model_copy(update={"simulation": plan.model_copy(update={"couplings": {}})}))
    row = rows_of(bare.candidate(tmp_path / "a"))["declared"]
    assert (row.status, row.first_failing_entity) == ("fail", "crate")
    one_way = {"c": Coupling(source="rigid", target="water", direction="one_way", variables=["motion"])}
    said = flow.edited(spec=flow.spec.model_copy(update={"simulation": plan.model_copy(update={"couplings": one_way})}))
    row = rows_of(said.candidate(tmp_path / "b"))["declared"]
    assert row.status == "pass"
    assert row.evidence["omitted_share_of_weight"]["crate"] == pytest.approx(1.0, rel=1e-6)


def test_a_heavy_load_floats_deeper(tmp_path: Path) -> None:
    """Archimedes: the push is the weight of the displaced liquid at a draft of density ratio times height."""
    for density in (200.0, 800.0):
        flow = scenes.crate_afloat(rng(), density=density)
        assert rows_of(flow.candidate(tmp_path / str(density)))["buoyancy"].status == "pass"
    wrong = scenes.crate_afloat(rng(), density=800.0)
    lifted = {row: 0.3 * push for row, push in wrong.share.items()}
    channels = {**wrong.rigid, "exchange/impulse": 0.3 * wrong.rigid["exchange/impulse"]}
    row = rows_of(wrong.edited(share=lifted, rigid=channels).candidate(tmp_path / "wrong"))["buoyancy"]
    assert (row.status, row.first_failing_entity) == ("fail", "crate")


def test_missing_channels_leave_their_rows_open_and_no_others(tmp_path: Path) -> None:
    flow = scenes.pool(rng())
    cache = flow.candidate(tmp_path).caches["water"]
    from worldagent.worlds.cache import read_container, write_container

    digests = []
    for k in range(flow.frames):
        held = {n: v for n, v in read_container(cache.path(k)).items() if n != "exchange/reaction"}
        digests.append(write_container(cache.path(k), held))
    cache.begin_digests(digests)
    candidate = dataclasses.replace(flow.candidate(tmp_path / "spec"), caches={"water": cache})
    rows = rows_of(candidate)
    opened = {n for n, r in rows.items() if r.status == "unverified"}
    assert opened == {"momentum", "exchange", "received", "declared", "buoyancy"}
    assert "exchange/reaction" in rows["momentum"].evidence["explanation"]


def test_a_frame_that_is_gone_leaves_all_rows_open_and_fails_the_container(tmp_path: Path) -> None:
    candidate = scenes.pool(rng()).candidate(tmp_path)
    candidate.caches["water"].path(5).unlink()
    rows = rows_of(candidate)
    assert (rows["frames"].status, rows["frames"].first_failing_frame) == ("fail", 5)
    assert {r.status for n, r in rows.items() if n not in ("frames", "digest", "placed", "started")} == {"unverified"}


@pytest.mark.parametrize("channel", ["particle/position", "particle/velocity", "exchange/impulse", "record/kinetic_energy"])
def test_a_number_that_is_not_finite_fails_and_stops_nothing(tmp_path: Path, channel: str) -> None:
    flow = scenes.pool(rng())
    held = flow.candidate(tmp_path / "whole").caches["water"].read(7)
    value = np.array(held[channel], dtype=held[channel].dtype)
    value.reshape(-1)[0] = np.nan
    rows = rows_of(flow.edited(change={(7, channel): value}).candidate(tmp_path))
    assert (rows["finite"].status, rows["finite"].first_failing_frame) == ("fail", 7)
    assert all(r.measured is None or np.isfinite(r.measured) for r in rows.values())


def counted(name: str, value: Any) -> Flow:
    flow = scenes.pool(rng())
    return flow.edited(change={(4, f"record/{name}"): np.array(float(value))})


@pytest.mark.parametrize(
    ("name", "value", "row"),
    [("lost", 3, "lost"), ("iterations_capped", 200, "iterations"), ("steps", 3, "counters"), ("max_speed", 90.0, "speed"),
     ("density_error_mean", 0.03, "density")],
)  # fmt: skip
def test_counters_of_the_engine_are_judged(tmp_path: Path, name: str, value: float, row: str) -> None:
    found = rows_of(counted(name, value).candidate(tmp_path))[row]
    assert found.status == "fail"
    assert found.evidence["category"] == "liquid"


@pytest.mark.parametrize("capped", [0, 3])
def test_more_iterations_are_advised_only_where_a_solve_ended_at_their_cap(tmp_path: Path, capped: int) -> None:
    flow = counted("density_error_mean", 0.03)
    change = {**flow.change, (4, "record/iterations_capped"): np.array(float(capped))}
    row = rows_of(flow.edited(change=change).candidate(tmp_path))["density"]
    assert (row.status, row.first_failing_frame) == ("fail", 4)
    told = [c.action for c in row.corrections]
    assert told[-1].startswith("halve max_step from")
    assert any(t.startswith("double the iterations") for t in told) == (capped > 0)


def test_a_pool_in_a_wide_tank_keeps_its_books_whatever_the_density(tmp_path: Path) -> None:
    flow = scenes.pool(rng())
    assert sum(flow.position[0].shape) > 0
    row = rows_of(flow.candidate(tmp_path))["mass"]
    assert row.evidence["mass_start_kg"] == pytest.approx(flow.volume * DENSITY * len(flow.position[0]))
    assert tank((1, 1, 1), 0.1).dimensions.size == pytest.approx((1.2, 1.2, 1.1))


@pytest.mark.parametrize(("speed", "near", "status"), [(0.0, True, "fail"), (1.0, True, "pass"), (1.0, False, "fail")])
def test_a_particle_that_a_body_has_pushed_away_within_a_frame_has_not_jumped(
    tmp_path: Path, speed: float, near: bool, status: str
) -> None:
    flow = scenes.crate_afloat(rng())
    away = np.linalg.norm(flow.position[0] - flow.tracks["crate"][0][0], axis=1)
    row, first = int(np.argmin(away) if near else np.argmax(away)), 6
    made = flow.edited()
    for k in range(first, flow.frames):
        made.position[k][row, 2] += 1.5 * S
    made.rigid["velocity"][first - 1, 0] = [0.0, 0.0, -speed]
    assert rows_of(made.candidate(tmp_path))["jumps"].status == status


@pytest.mark.parametrize(("pushed", "status"), [(1.0, "pass"), (9.0, "fail")])
def test_what_a_body_is_given_while_it_is_held_need_not_move_it(tmp_path: Path, pushed: float, status: str) -> None:
    """Let go 0.8 of a frame after its start, a crate afloat answers to a fifth of its weight and of what water gives it."""
    flow = scenes.crate_afloat(rng())
    plan = flow.spec.simulation
    held = plan.model_copy(update={"drivers": {**plan.drivers, "hold": ReleaseDriver(entity="crate", time=4.8 / plan.fps)}})
    made = flow.edited(spec=flow.spec.model_copy(update={"simulation": held}))
    made.rigid["velocity"][5:, 0, 0] += (pushed - 1.0) * 0.1
    found = [r for r in category.check(made.candidate(tmp_path)) if r.id.startswith("category:rigid:momentum:")]
    assert [r.status for r in found] == [status]


@pytest.mark.parametrize(("layers", "first"), [(2, "resolution"), (6, "step")])
def test_growth_of_energy_in_a_film_asks_for_finer_particles_before_shorter_steps(
    tmp_path: Path, layers: int, first: str
) -> None:
    """All of it is lifted by a fifth of a spacing, as particles do that close up where they land."""
    flow = pool_in_tank(size=(0.24, 0.2, layers * S), spacing=S, wall=0.02, frames=12)
    made = flow.edited()
    for k in range(6, made.frames):
        made.position[k][:, 2] += 0.2 * S
    row = rows_of(made.candidate(tmp_path))["energy"]
    assert row.status == "fail"
    assert row.corrections[0].group == first
