"""A gas that a part of its box follows: rows on a tall plume, on one whose part does not grow, and a run that is taken up again."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction.build import build_entity
from worldagent.simulation.gas import active
from worldagent.simulation.gas.active import ActiveGas
from worldagent.simulation.gas.solver import SolverGas
from worldagent.testing.defects._gas_scenes import SOLVER
from worldagent.testing.worlds.by_category import spec_of
from worldagent.testing.worlds.simulated_worlds import edited, simulate
from worldagent.testing.worlds.small_gas import SMOKE_PROMPT, followed_spec
from worldagent.verifiers.categories.gas.check import WATCHES, category_rows, numerical_rows
from worldagent.verifiers.categories.gas.flow import Flow
from worldagent.verifiers.categories.gas.following import Following
from worldagent.verifiers.categories.gas.frames import box_of
from worldagent.verifiers.categories.gas.outflow import outflow
from worldagent.verifiers.categories.gas.register import gas_lines
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.requirements import Row

FRAMES = 30


def tall(frames: int = FRAMES, **settings: Any) -> dict[str, Any]:
    """Smoke that rises in a tall box."""
    return followed_spec(frames=frames, **settings)


def baked(folder: Path, spec: dict[str, Any]) -> Candidate:
    """It as simulated."""
    return simulate(folder, spec_of(spec, SMOKE_PROMPT))


def rows_of(candidate: Candidate) -> dict[str, Row]:
    """Rows by the name of their question."""
    return {r.id.split(":")[-2]: r for r in (*numerical_rows(candidate, SOLVER), *category_rows(candidate, SOLVER))}


@pytest.fixture(scope="module")
def plume(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    """The plume, followed."""
    return baked(tmp_path_factory.mktemp("plume"), tall())


def test_rows_of_a_plume_that_is_followed_pass(plume: Candidate) -> None:
    rows = rows_of(plume)
    assert {n for n, r in rows.items() if r.status not in ("pass", "not_applicable")} == set()
    assert set(Following.questions) <= set(rows)
    assert rows["divergence"].status == rows["energy"].status == rows["outflow"].status == rows["escape"].status == "pass"
    box = box_of(plume, SOLVER)
    parts = [box.read(k).part for k in range(FRAMES)]
    assert parts[0] is not None
    assert parts[-1] is not None
    assert (parts[-1] - parts[0]).any()
    assert parts[-1][1, 2] < box.shape[2]


def test_gases_that_are_not_followed_are_not_asked_about_it(tmp_path: Path) -> None:
    spec = tall(follows=False)
    spec["simulation"]["frames"] = 3
    found = rows_of(baked(tmp_path, spec))
    assert set(found) == {n for watch in WATCHES for n in watch.questions} | {"frames", "digest"}


def test_a_part_that_does_not_grow_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Broken on purpose in the engine: its books stay right, and yet gas comes to the sides and through them."""
    monkeypatch.setattr(ActiveGas, "_follow", lambda self, changed: None)
    monkeypatch.setattr(active, "MARGIN", -2)
    rows = rows_of(baked(tmp_path, tall(frames=48)))
    assert rows["soot"].status == "pass"
    assert {"arrived", "slipped"} <= {n for n, r in rows.items() if r.status == "fail"}
    assert "/simulation/solvers/air/settings/follows" in [p for c in rows["slipped"].corrections for p in c.pointers]


def test_a_part_that_leaves_a_body_outside_is_found(plume: Candidate, tmp_path: Path) -> None:
    """Cells far above open over a frame, as if a body had gone from them."""

    def close(k: int, data: dict[str, Any]) -> None:
        if k < 5:
            data["gas_room"][16, 16, 44] = 0.0

    row = rows_of(edited(plume, tmp_path, SOLVER, close))["followed"]
    assert (row.status, row.first_failing_frame, row.measured) == ("fail", 5, 1.0)


def test_a_part_that_is_none_leaves_rows_unverified(plume: Candidate, tmp_path: Path) -> None:
    def turn(k: int, data: dict[str, Any]) -> None:
        data["gas_active"] = data["gas_active"][::-1].copy()

    rows = rows_of(edited(plume, tmp_path, SOLVER, turn))
    assert rows["divergence"].status == rows["arrived"].status == "unverified"


def test_air_that_is_made_inside_the_part_is_still_found(plume: Candidate, tmp_path: Path) -> None:
    """The divergence is judged up to the inner sides, and not across them, where frames end."""

    def spout(k: int, data: dict[str, Any]) -> None:
        data["gas_velocity"][14:18, 14:18, 10:12, 2] += 0.5

    assert rows_of(edited(plume, tmp_path, SOLVER, spout))["divergence"].status == "fail"
    watch = Flow(box_of(plume, SOLVER))
    watch.see(box_of(plume, SOLVER).read(6), None)
    assert watch.net[0] < 1e-5


def test_air_comes_in_through_inner_sides(plume: Candidate) -> None:
    """Its energy counts as that of what flows in at open sides."""
    box = box_of(plume, SOLVER)
    frame = box.read(FRAMES - 1)
    assert frame.inner_sides == (5,)
    assert frame.part is not None
    assert outflow(box, frame).inward > 0.0
    top, air = int(frame.part[1, 2]), frame.velocity.copy()
    air[:, :, top - 2 : top] = (0.0, 0.0, -0.1)
    sinking = replace(frame, velocity=air)
    more = outflow(box, sinking).inward - outflow(box, replace(sinking, part=None)).inward
    flux = 0.5 * 0.1**3 * box.density(frame)[:, :, top - 1] * frame.room[:, :, top - 1] * box.cell**2
    assert more == pytest.approx(float(flux.sum()), rel=1e-5)


def test_a_run_that_is_taken_up_again_is_the_same_to_the_bit() -> None:
    """From a checkpoint on, over a growth of the part."""
    spec = spec_of(tall(), SMOKE_PROMPT)
    built = {n: build_entity(spec, n, Path()) for n in spec.entities}
    first = SolverGas(spec, built, SOLVER)
    first.prepare()
    for frame in range(1, 5):
        first.advance(frame)
    state, before = first.checkpoint(), np.array(first.frame_data()["gas_active"])
    second = SolverGas(spec, built, SOLVER)
    second.prepare()
    second.restore(state, 4)
    for frame in range(5, 21):
        first.advance(frame)
        second.advance(frame)
    one, other = first.frame_data(), second.frame_data()
    assert set(one) == set(other)
    assert all(np.array_equal(one[n], other[n]) for n in one)
    assert (one["gas_active"] != before).any()


def test_the_register_tells_of_it() -> None:
    lines = [line["what"] for line in gas_lines(spec_of(tall(), SMOKE_PROMPT))]
    assert sum("follows it" in what for what in lines) == 1
    assert not any("follows it" in line["what"] for line in gas_lines(spec_of(tall(follows=False), SMOKE_PROMPT)))
