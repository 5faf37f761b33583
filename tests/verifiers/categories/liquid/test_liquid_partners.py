"""Books of bodies that water pushes: they begin at frame 0, and what water gives to one member is no energy that another gained."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction.build import build_entity
from worldagent.simulation.schedule import run_frames
from worldagent.testing.worlds.simulated_worlds import edited
from worldagent.testing.worlds.small_liquids import PROMPT, springboard_spec, tank_spec
from worldagent.verifiers.categories.elastic import check as elastic
from worldagent.verifiers.categories.liquid import check as liquid
from worldagent.verifiers.categories.rigid import check as rigid
from worldagent.worlds.candidate import Candidate, cache_digest
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.requirements import Row

FRAMES = 4


def simulate(folder: Path, given: dict[str, Any]) -> Candidate:
    """The motion that a specification leads to."""
    spec = parse_spec({**given, "prompt": PROMPT})
    built = {n: build_entity(spec, n, Path()) for n in spec.entities}
    caches = run_frames(spec, built, folder / "run", frames=spec.simulation.frames)
    return Candidate(folder, spec, built, "probe", caches, "run", cache_digest(caches))


def by_name(rows: list[Row]) -> dict[str, Row]:
    return {r.id.split(":")[2]: r for r in rows}


@pytest.mark.parametrize("preroll", [0.0, 0.5])
@pytest.mark.parametrize(("engine", "spacing"), [("dfsph", 0.04), ("flip", 0.03)])
def test_what_a_floating_crate_received_is_what_water_gave(tmp_path: Path, engine: str, spacing: float, preroll: float) -> None:
    """Both sides count from frame 0 on: what was given during the preroll is of no frame."""
    given = tank_spec(engine=engine, spacing=spacing, frames=FRAMES, crate_at=0.2)
    given["simulation"]["preroll"] = preroll
    candidate = simulate(tmp_path, given)
    row = by_name(liquid.category_rows(candidate, "water"))["received"]
    assert (row.status, row.bound) == ("pass", 1e-5), row.evidence
    bodies = candidate.caches["rigid"].series("exchange/impulse")
    assert not bodies[0].any()
    assert bodies[-1, 0, 2] > 0.0


@pytest.fixture(scope="module")
def sprung(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    """A crate that water lifts, and a board that springs beside it, in one instance."""
    return simulate(tmp_path_factory.mktemp("sprung"), springboard_spec(spacing=0.04, frames=FRAMES + 1))


def test_a_crate_that_water_lifts_is_no_energy_that_a_springboard_gained(sprung: Candidate) -> None:
    rows = by_name(elastic.category_rows(sprung, "rigid"))
    assert rows["energy"].status == "pass"
    given = rows["energy"].evidence["given_by_others_J"]
    assert given > 5.0 * rows["energy"].bound * rows["energy"].evidence["scale_J"], "else nothing had to be taken off"
    assert by_name(rigid.category_rows(sprung, "rigid"))["energy"].status == "pass"


def test_energy_that_a_springboard_gains_beside_a_lifted_crate_is_told(sprung: Candidate, tmp_path: Path) -> None:
    scale = float(by_name(elastic.category_rows(sprung, "rigid"))["energy"].evidence["scale_J"])

    def gains(frame: int, data: dict[str, Any]) -> None:
        data["record/strain_energy"] = np.float64(data["record/strain_energy"] + (0.5 * scale if frame >= 3 else 0.0))

    broken = edited(sprung, tmp_path, "rigid", gains)
    row = by_name(elastic.category_rows(broken, "rigid"))["energy"]
    assert (row.status, row.first_failing_frame) == ("fail", 3)


def test_what_water_gives_to_an_elastic_member_is_no_energy_that_a_rigid_one_gained(sprung: Candidate, tmp_path: Path) -> None:
    """The mirrored case: work on the board that its record says partners did is taken off the instance's balance, and no other."""

    def pushed(frame: int, data: dict[str, Any]) -> None:
        data["record/strain_energy"] = np.float64(data["record/strain_energy"] + (5.0 if frame >= 3 else 0.0))
        data["record/soft_exchange_work"] = np.float64(data["record/soft_exchange_work"] + (5.0 if frame == 3 else 0.0))

    def gained(frame: int, data: dict[str, Any]) -> None:
        data["record/strain_energy"] = np.float64(data["record/strain_energy"] + (5.0 if frame >= 3 else 0.0))

    told = by_name(rigid.category_rows(edited(sprung, tmp_path / "a", "rigid", pushed), "rigid"))["energy"]
    assert told.status == "pass"
    told = by_name(rigid.category_rows(edited(sprung, tmp_path / "b", "rigid", gained), "rigid"))["energy"]
    assert (told.status, told.first_failing_frame) == ("fail", 3)
