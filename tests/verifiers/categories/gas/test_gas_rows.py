"""Rows of gas on small simulated rooms and on the same broken on purpose; the suite of seeded defects holds the others (testing/defects/gas.py)."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.defects._gas_scenes import FRAMES, SOLVER, SOOT, scene, scene_spec
from worldagent.testing.worlds.simulated_worlds import edited
from worldagent.testing.worlds.small_gas import SMOKE_PROMPT
from worldagent.testing.worlds.small_worlds import build_all
from worldagent.verifiers.categories.gas.books import declared
from worldagent.verifiers.categories.gas.check import WATCHES, category_rows, numerical_rows
from worldagent.verifiers.categories.gas.fires import Fires
from worldagent.verifiers.categories.gas.flow import mirrored, net_outflow
from worldagent.verifiers.categories.gas.frames import box_of
from worldagent.verifiers.categories.gas.kindling import Kindling
from worldagent.verifiers.categories.gas.pushing import Pushing
from worldagent.verifiers.categories.gas.reach import within_reach
from worldagent.verifiers.categories.gas.steaming import Steaming
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import WorldSpec

Frame = dict[str, Any]
Forge = Callable[[Callable[[int, Frame], None]], dict[str, Row]]


def rows_of(candidate: Candidate) -> dict[str, Row]:
    """Rows by the name of their question."""
    return {r.id.split(":")[-2]: r for r in (*numerical_rows(candidate, SOLVER), *category_rows(candidate, SOLVER))}


@pytest.fixture
def forge(tmp_path: Path) -> Forge:
    """Rows of the room with other frames."""
    return lambda change: rows_of(edited(scene("room"), tmp_path, SOLVER, change))


def test_every_row_of_a_sound_room_passes_or_has_no_case() -> None:
    rows = rows_of(scene("room"))
    assert set(rows) == {n for watch in WATCHES for n in watch.questions} | {"frames", "digest"}
    assert {n for n, r in rows.items() if r.status != "pass"} == {
        *Fires.questions,  # it has no fuel
        *Kindling.questions,
        *Steaming.questions,
        *Pushing.questions,
    }


def test_smoke_that_leaves_is_counted_by_two_routes_and_the_side_that_cuts_it_off_is_named() -> None:
    rows = rows_of(scene("vent"))
    assert {n for n, r in rows.items() if r.status not in ("pass", "not_applicable")} == {"cut"}
    assert (rows["cut"].mandatory, rows["cut"].evidence["side"]) == (False, "+z")
    assert max(rows["escape"].evidence["left_by_side"], key=rows["escape"].evidence["left_by_side"].__getitem__) == "+z"
    box = box_of(scene("vent"), SOLVER)
    assert box.record("escaped_soot")[-1] > 0.05 * declared(box)["soot"][-1]
    assert "/simulation/solvers/air/settings/domain/size" in rows["cut"].corrections[0].pointers


def test_smoke_along_a_closed_side_that_is_no_wall_is_told(forge: Forge) -> None:
    """The lower side of the room is closed, and a floor is there; smoke may lie on it."""

    def lie(k: int, data: Frame) -> None:
        data["gas_soot"][:, :, 0] = SOOT

    assert forge(lie)["stopped"].status == "pass"
    bare = scene("room")
    box = box_of(bare, SOLVER)
    assert box.sides[4] == "closed"
    assert {p.entity for p in box.bodies.pieces} == {"floor", "plate"}


def test_without_the_floor_smoke_along_the_lower_side_is_told(tmp_path: Path) -> None:
    def lie(k: int, data: Frame) -> None:
        data["gas_soot"][:, :, 0] = SOOT

    found = edited(scene("room"), tmp_path, SOLVER, lie)
    spec = found.spec.model_copy(deep=True)
    del spec.entities["floor"]
    bare = Candidate(tmp_path, spec, found.built, found.stage, found.caches)
    row = rows_of(bare)["stopped"]
    assert (row.status, row.mandatory, row.evidence["side"]) == ("fail", False, "-z")


def test_what_is_wrong_is_named_with_its_place_and_frame(forge: Forge) -> None:
    def chill(k: int, data: Frame) -> None:
        if k >= 4:
            data["gas_temperature"][2, 3, 9] = 280.0

    row = forge(chill)["temperature"]
    assert (row.status, row.first_failing_frame, row.evidence["at"]) == ("fail", 4, [-0.275, -0.225, 0.475])


def test_damaged_fields_leave_rows_unverified(forge: Forge) -> None:
    def cut(k: int, data: Frame) -> None:
        data["gas_soot"] = data["gas_soot"][:-1]

    rows = forge(cut)
    assert {rows[n].status for n in ("soot", "carried", "divergence", "inside")} == {"unverified"}
    assert "shape" in str(rows["soot"].evidence)


def test_a_missing_record_leaves_only_its_rows_unverified(forge: Forge) -> None:
    def drop(k: int, data: Frame) -> None:
        del data["record/divergence"]

    rows = forge(drop)
    assert (rows["projection"].status, rows["soot"].status, rows["carried"].status) == ("unverified", "pass", "pass")


def test_net_outflow_of_means_of_faces_is_exact_and_sees_a_source() -> None:
    """Law: smoothing 1, 2, 1 along the other axes makes it the mean outflow of 27 cells, whatever the faces."""
    draw = np.random.default_rng(3)
    n = 9
    potential = draw.normal(size=(3, n + 1, n + 1, n + 1))
    faces = [np.roll(potential[(a + 2) % 3], -1, (a + 1) % 3) - potential[(a + 2) % 3] for a in range(3)]
    faces = [f - (np.roll(potential[(a + 1) % 3], -1, (a + 2) % 3) - potential[(a + 1) % 3]) for a, f in enumerate(faces)]
    centred = np.stack([0.5 * (f + np.roll(f, -1, a)) for a, f in enumerate(faces)], axis=-1)[1:-2, 1:-2, 1:-2]
    assert np.abs(net_outflow(centred, 0.1)).max() < 1e-11
    assert np.abs(np.gradient(centred[..., 0], 0.1, axis=0)).max() > 1.0
    source = [f.copy() for f in faces]
    source[0][5, 4, 4] += 0.3
    fed = np.stack([0.5 * (f + np.roll(f, -1, a)) for a, f in enumerate(source)], axis=-1)[1:-2, 1:-2, 1:-2]
    net = net_outflow(fed, 0.1)
    assert np.abs(net).max() == pytest.approx(0.3 / 0.1 / 16.0)
    assert net.sum() == pytest.approx(0.0, abs=1e-11)


def test_closed_sides_let_nothing_pass_in_the_mirrored_field() -> None:
    """Faces of a box with all sides closed, one of which is still: the outflow of all its cells is none."""
    draw = np.random.default_rng(4)
    n = 6
    centred = np.zeros((n, n, n, 3))
    for axis in range(3):
        shape = [n, n, n]
        shape[axis] += 1
        face = draw.normal(size=shape)
        for end in (0, -1):
            face[tuple(end if a == axis else slice(None) for a in range(3))] = 0.0
        low, high = (np.take(face, range(k, k + n), axis=axis) for k in (0, 1))
        centred[..., axis] = 0.5 * (low + high)
    net = net_outflow(mirrored(centred, ("closed",) * 6), 0.1)
    assert net.sum() == pytest.approx(0.0, abs=1e-10)
    assert np.isnan(net_outflow(mirrored(centred, ("closed",) * 5 + ("open",)), 0.1)[:, :, -1]).all()


def test_reach_goes_round_walls_and_not_through_them() -> None:
    values = np.zeros((5, 5, 1))
    values[0, 0] = 1.0
    walls = (np.zeros((4, 5, 1), bool), np.zeros((5, 4, 1), bool), np.zeros((5, 5, 0), bool))
    walls[0][1, :4] = True
    near = within_reach(values, np.full((5, 5, 1), 2.0), walls, (0.0,) * 6)[:, :, 0]
    assert (near[1, 2], near[2, 0], near[3, 4]) == (1.0, 0.0, 0.0)
    far = within_reach(values, np.full((5, 5, 1), 5.0), walls, (0.0,) * 6)[:, :, 0]
    assert (far[1, 2], far[2, 4]) == (1.0, 1.0)
    shut = within_reach(values, np.full((5, 5, 1), 9.0), (np.ones_like(walls[0]), walls[1], walls[2]), (0.0,) * 6)[:, :, 0]
    assert (shut[0, 4], shut[1, 0]) == (1.0, 0.0)


def test_reach_is_that_of_plain_steps_on_random_cells() -> None:
    """The compiled loops beside the same steps in numpy, with walls, unequal ways, values beyond the sides, and cells without a number."""
    rng = np.random.default_rng(3)
    shape = (7, 5, 6)
    values, way = rng.normal(size=shape), rng.uniform(0.0, 4.0, size=shape)
    values[2, 3, 1] = np.nan
    x, y, z = (rng.random(tuple(n - (a == axis) for a, n in enumerate(shape))) < 0.3 for axis in range(3))
    walls = (x, y, z)
    beyond = tuple(rng.normal(size=6))
    expected = values.copy()
    for step in range(1, 5):
        wider = expected.copy()
        for axis in range(3):
            padded = np.moveaxis(wider, axis, 0)
            shut = np.moveaxis(walls[axis], axis, 0)
            low, high = np.where(shut, -np.inf, padded[:-1]), np.where(shut, -np.inf, padded[1:])
            ends = [np.full_like(padded[:1], beyond[2 * axis + side]) for side in (0, 1)]
            found = np.maximum(padded, np.maximum(np.concatenate([ends[0], low]), np.concatenate([high, ends[1]])))
            wider = np.moveaxis(found, 0, axis)
        expected = np.where(way >= step, wider, expected)
    np.testing.assert_array_equal(within_reach(values, way, walls, beyond), expected)


def test_books_of_the_declared_source_are_those_of_its_drivers() -> None:
    """6 litres a second of 400 K over 9 frames of 24: volume, 1 g/m^3 of soot, and 1 - T_a/T of the air's heat."""
    given = declared(box_of(scene("room"), SOLVER))
    volume = 0.006 * (FRAMES - 1) / 24
    assert given["volume"][-1] == pytest.approx(volume)
    assert given["soot"][-1] == pytest.approx(volume * SOOT)
    assert given["heat"][-1] == pytest.approx(volume * 1.2041 * 1005.0 * 293.15 * (1 - 293.15 / 400.0), rel=1e-3)
    puff = declared(box_of(scene("puff"), SOLVER))
    assert puff["volume"][-1] == pytest.approx(0.006 * 0.15)


@pytest.mark.parametrize(("beside", "status"), [(0.55, "pass"), (0.7, "fail")])
def test_a_body_against_an_open_side_may_close_it_to_the_cells_there(tmp_path: Path, beside: float, status: str) -> None:
    """Air that starts at the side of a cell, where a plate stands against it or half a cell off."""

    def closed(k: int, data: Frame) -> None:
        data["gas_velocity"][:] = 0.0
        data["gas_velocity"][-1, 7:9, 7:9, 0] = 0.1

    found = edited(scene("cold"), tmp_path, SOLVER, closed)
    document = scene_spec("cold")
    document["entities"]["plate"]["pose"]["position"] = [beside, 0.0, 0.4]
    spec = WorldSpec.model_validate({"prompt": SMOKE_PROMPT, **document})
    moved = Candidate(found.folder, spec, build_all(spec), found.stage, found.caches)
    assert rows_of(moved)["divergence"].status == status
