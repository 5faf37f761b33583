"""Liquids that meet what deforms: small simulated worlds that pass, and copies broken in one way that fail."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.construction.build import build_entity
from worldagent.simulation.schedule import run_frames
from worldagent.testing.worlds.simulated_worlds import edited
from worldagent.testing.worlds.small_liquids import PROMPT, jelly_tank_spec
from worldagent.testing.worlds.small_soft import HAMMOCK_PROMPT, HIGH, hammock_spec
from worldagent.verifiers.categories.elastic import check as elastic
from worldagent.verifiers.categories.liquid import check as liquid
from worldagent.worlds.candidate import Candidate, cache_digest
from worldagent.worlds.patch import parse_spec


def simulate(folder: Path, given: dict[str, Any], prompt: str) -> Candidate:
    """The motion that a specification leads to."""
    spec = parse_spec({**given, "prompt": prompt})
    built = {n: build_entity(spec, n, Path()) for n in spec.entities}
    caches = run_frames(spec, built, folder / "run", frames=spec.simulation.frames)
    return Candidate(folder, spec, built, "probe", caches, "run", cache_digest(caches))


@pytest.fixture(scope="module")
def bathed(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    """A jelly that begins to float."""
    spec = jelly_tank_spec(frames=4, spacing=0.04, crate_at=0.245)
    return simulate(tmp_path_factory.mktemp("bathed"), spec, PROMPT)


@pytest.fixture(scope="module")
def strained(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    """Water that falls towards a cloth, which it meets one way."""
    spec = hammock_spec(frames=3, edge=0.055, radius=None)
    size = [0.12, 0.12, 0.12]
    spec["materials"]["water"] = {"density": 1000, "substance": "water"}
    spec["entities"]["water"] = {
        "role": "water", "motion": "dynamic", "material": "water", "dimensions": {"size": size},
        "pose": {"position": [0.0, 0.0, HIGH + 0.08]}, "parts": {"body": {"shape": {"kind": "box", "size": size}}},
        "physics": {"category": "liquid", "resolution": 0.04},
    }  # fmt: skip
    spec["entities"]["jelly"]["pose"]["position"] = [0.0, 0.0, 0.15]
    settings = {"domain": {"center": [0, 0, 0.3], "size": [0.6, 0.6, 0.6]}}
    spec["simulation"]["solvers"]["water"] = {"engine": "dfsph", "members": ["water"], "settings": settings}
    spec["simulation"]["couplings"] = {
        "led": {"source": "cloth", "target": "water", "direction": "one_way", "variables": ["motion"]}
    }
    return simulate(tmp_path_factory.mktemp("strained"), spec, HAMMOCK_PROMPT)


def rows_of(candidate: Candidate) -> dict[str, Any]:
    return {r.id.split(":")[2]: r for r in liquid.category_rows(candidate, "water")}


def test_what_water_and_a_jelly_give_each_other_is_judged(bathed: Candidate) -> None:
    rows = rows_of(bathed)
    assert {rows[n].status for n in ("exchange", "inside", "energy", "momentum", "declared", "density")} == {"pass"}
    assert {r.id.split(":")[2]: r.status for r in elastic.category_rows(bathed, "rigid")}["exchange"] == "pass"


@pytest.mark.parametrize("channel", ["exchange/impulse", "exchange/reaction"])
def test_an_impulse_that_one_side_alone_counts_is_told(bathed: Candidate, tmp_path: Path, channel: str) -> None:
    def more(frame: int, data: dict[str, Any]) -> None:
        data[channel] = data[channel] * (1.1 if frame == 3 else 1.0)

    broken = edited(bathed, tmp_path, "water", more)
    row = rows_of(broken)["exchange"]
    assert (row.status, row.first_failing_frame) == ("fail", 3)
    told = {r.id.split(":")[2]: r for r in elastic.category_rows(broken, "rigid")}["exchange"]
    assert (told.status, told.first_failing_frame) == (("fail", 3) if channel == "exchange/impulse" else ("pass", None))


def test_water_in_a_jelly_is_told(bathed: Candidate, tmp_path: Path) -> None:
    def put(frame: int, data: dict[str, Any]) -> None:
        if frame == 2:
            middle = bathed.deforming["jelly"].positions(2).mean(axis=0)
            data["particle/position"][5] = middle - data["origin"]

    row = rows_of(edited(bathed, tmp_path, "water", put))["inside"]
    assert (row.status, row.first_failing_frame, row.first_failing_entity) == ("fail", 2, "jelly")


def test_water_over_a_cloth_passes_and_water_that_went_through_is_told(strained: Candidate, tmp_path: Path) -> None:
    def risen(frame: int, data: dict[str, Any]) -> None:
        data["vertex/position"] = data["vertex/position"] + [0.0, 0.0, 0.06 if frame == 2 else 0.0]

    assert rows_of(strained)["leak"].status == "pass"
    row = rows_of(edited(strained, tmp_path, "cloth", risen))["leak"]
    assert (row.status, row.first_failing_frame, row.first_failing_entity) == ("fail", 2, "cloth")
    assert np.isfinite(row.measured)
