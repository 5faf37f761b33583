"""A case that a spacing cannot resolve is unverified, never passed: slots that particles cannot enter, bodies that have no inside."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest
from worldagent.testing.defects import _liquid_resolution as made
from worldagent.testing.defects import _liquid_scenes as scenes
from worldagent.testing.worlds import small_worlds as sw
from worldagent.testing.worlds.liquid_worlds import Flow, liquid_world, water
from worldagent.testing.worlds.small_liquids import tank_spec
from worldagent.verifiers.categories.liquid import check as liquid
from worldagent.verifiers.categories.liquid.across import Across, thin_lines
from worldagent.verifiers.categories.liquid.leaks import Leaks
from worldagent.verifiers.rows.findings import Finding
from worldagent.worlds.coarsening import write_overrides
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.predicates import LiquidLevelAt, LiquidVolumeIn, SubmergedFraction
from worldagent.worlds.spec import Entity, Requirement, Story

S = scenes.SPACING


def found(monkeypatch: pytest.MonkeyPatch, flow: Flow, folder: Path) -> dict[str, Finding]:
    """Findings of both watches."""
    monkeypatch.setattr(liquid, "WATCHES", (Leaks, Across))
    return {n: f for watch in liquid.findings_of(flow.candidate(folder), "water").values() for n, (_, f) in watch.items()}


def rng(seed: int = 3) -> np.random.Generator:
    return np.random.default_rng(seed)


# ---------------------------------------------------------------- slots


@pytest.mark.parametrize("width", [0.0012, 0.002, 0.005, 0.015])
def test_a_slot_that_the_spacing_does_not_see_is_unverified(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, width: float
) -> None:
    """A slot of 2 mm at a spacing of 20 mm holds water for ever, here, and nowhere else."""
    row = found(monkeypatch, made.slotted(rng(), width), tmp_path)["leak"]
    assert row.status == "unverified"
    assert row.measured == pytest.approx(width / S, rel=0.02)
    assert (row.bound, row.unit, row.entity) == (3.0, "spacings", "tank")
    assert row.evidence is not None
    assert row.evidence["gap_m"] == pytest.approx(width, rel=0.02)
    assert row.evidence["spacing_m"] == S
    assert sorted(row.evidence["between"]) == ["tank/p4", "tank/p5"]
    assert row.evidence["place"][2] == pytest.approx(0.0, abs=0.04)
    assert "or close the gap" in row.text
    patches = [p for h in row.hints for p in h.patch]
    assert patches[0]["value"] == pytest.approx(width / 3, rel=0.03)


@pytest.mark.parametrize("width", [0.0, 0.0003, 0.0009])
def test_boards_that_meet_within_two_skins_are_a_joint(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, width: float) -> None:
    assert found(monkeypatch, made.slotted(rng(), width), tmp_path)["leak"].status == "pass"


def _basin(solids: dict[str, Entity], *, frames: int = 6) -> Flow:
    """Water between two walls and on a floor that goes on outside."""
    size = (16 * S, 12 * S, 7 * S)
    walls = {
        "floor": sw.box(1.2, 1.0, 0.1, at=(0, 0, -0.05)),
        "left": sw.box(0.04, 0.5, 0.3, at=(-size[0] / 2 - 0.02, 0, 0.15)),
        "near": sw.box(size[0], 0.04, 0.3, at=(0, -size[1] / 2 - 0.02, 0.15)),
        "far": sw.box(size[0], 0.04, 0.3, at=(0, size[1] / 2 + 0.02, 0.15)),
    }
    entities = {**walls, "pool": water(size, (0, 0, size[2] / 2), S), **solids}
    spec = liquid_world(entities, spacing=S, low=(-0.5, -0.4, -0.1), high=(0.5, 0.4, 0.5), frames=frames)
    points = np.stack(np.meshgrid(*[(np.arange(n) + 0.5) * S for n in (16, 12, 7)], indexing="ij"), axis=-1).reshape(-1, 3)
    points = points - [8 * S, 6 * S, 0]
    for solid in solids.values():
        half = 0.5 * np.array(solid.dimensions.size) + 0.25 * S
        points = points[(np.abs(points - solid.pose.position) > half).any(axis=1)]
    names = tuple(f"{n}/body" for n in entities if n != "pool")
    return Flow(spec, [points] * frames, [np.zeros_like(points)] * frames, [np.arange(len(points))] * frames, S**3, names)


RIGHT = 8 * S + 0.02


def _board(low: float, high: float) -> Entity:
    """A piece of the right wall between two heights."""
    return sw.box(0.04, 0.5, high - low, at=(RIGHT, 0, 0.5 * (low + high)))


def test_a_crack_between_two_boards_of_a_wall_is_found_under_water_only(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    wet = _basin({"lower": _board(0.0, 0.06), "upper": _board(0.063, 0.3)})
    row = found(monkeypatch, wet, tmp_path / "wet")["leak"]
    assert (row.status, row.evidence and sorted(row.evidence["between"])) == ("unverified", ["lower/p0", "upper/p0"])
    dry = _basin({"lower": _board(0.0, 0.24), "upper": _board(0.243, 0.3)})
    assert found(monkeypatch, dry, tmp_path / "dry")["leak"].status == "pass"
    whole = _basin({"wall": _board(0.0, 0.3)})
    assert found(monkeypatch, whole, tmp_path / "whole")["leak"].status == "pass"


def test_cracks_that_lead_nowhere_and_gaps_under_stones_are_no_leaks(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Boards against the inside of a sound wall, and a stone that stands 3 mm off the floor in the water."""
    solids = {
        "wall": _board(0.0, 0.3),
        "low_board": sw.box(0.02, 0.3, 0.06, at=(8 * S - 0.01, 0, 0.03)),
        "high_board": sw.box(0.02, 0.3, 0.1, at=(8 * S - 0.01, 0, 0.113)),
        "stone": sw.box(0.06, 0.06, 0.05, at=(0, 0, 0.028)),
    }
    row = found(monkeypatch, _basin(solids), tmp_path)["leak"]
    assert (row.status, row.text) == ("pass", row.text)


# ---------------------------------------------------------------- thin bodies


@pytest.mark.parametrize(("layers", "status"), [(3, "unverified"), (4, "unverified"), (5, "pass"), (8, "pass")])
def test_what_floats_on_a_few_layers_of_water_is_unverified(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, layers: int, status: str
) -> None:
    row = found(monkeypatch, made.thin_pool(rng(), layers), tmp_path)["across"]
    assert (row.status, row.measured, row.bound) == (status, pytest.approx(layers), 5.0)
    assert row.entity == ("pool" if status == "unverified" else None)
    if status == "unverified":
        assert "refine to" in row.text
        assert "(buoyancy)" in row.text


def _thin(asks: dict[str, Requirement]) -> Flow:
    flow = scenes.pool(rng())
    size = (0.3, 0.24, 3 * S)
    points = np.stack(np.meshgrid(*[(np.arange(n) + 0.5) * S for n in (15, 12, 3)], indexing="ij"), axis=-1).reshape(-1, 3)
    points = points - [7.5 * S, 6 * S, 0]
    spec = flow.spec.model_copy(
        update={
            "entities": {**flow.spec.entities, "pool": water(size, (0, 0, size[2] / 2), S)},
            "story": Story(requirements=asks),
        }
    )
    frames = flow.frames
    return flow.edited(
        spec=spec,
        position=[points] * frames,
        velocity=[np.zeros_like(points)] * frames,
        identity=[np.arange(len(points))] * frames,
    )


ASKED = {
    "level": (LiquidLevelAt(entity="pool", point=(0, 0), min=0.01), "unverified"),
    "float": (SubmergedFraction(entity="tank", liquid="pool", max=0.5), "unverified"),
    "volume": (LiquidVolumeIn(entity="pool", region="there", min=0.001), "pass"),
}


@pytest.mark.parametrize("name", ASKED)
def test_a_thin_body_cannot_answer_what_its_depth_decides(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, name: str) -> None:
    """Choice: a volume in a place is counted by particles, each with its exact volume; a level is not."""
    predicate, status = ASKED[name]
    row = found(monkeypatch, _thin({"r": Requirement(text="t", predicate=predicate)}), tmp_path)["across"]
    assert row.status == status
    assert "3 spacings" in row.text
    optional = _thin({"r": Requirement(text="t", predicate=predicate, mandatory=False)})
    assert found(monkeypatch, optional, tmp_path / "optional")["across"].status == "pass"


def test_a_thin_body_of_which_nothing_is_asked_stands_in_the_register(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    flow = _thin({})
    row = found(monkeypatch, flow, tmp_path)["across"]
    assert row.status == "pass"
    assert "the register tells it" in row.text
    (line,) = thin_lines(flow.spec)
    assert line["what"] == "the liquid body 'pool' is 3 spacings of 0.02 m across at frame 0"
    assert thin_lines(parse_spec({**tank_spec(crate_at=None), "prompt": "p"})) == []


def test_a_body_of_several_parts_is_measured_by_its_particles(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    for layers, status in ((3, "unverified"), (8, "pass")):
        flow = made.thin_pool(rng(), layers)
        pool = flow.spec.entities["pool"]
        two = pool.model_copy(update={"parts": {**pool.parts, "more": next(iter(pool.parts.values()))}})
        spec = flow.spec.model_copy(update={"entities": {**flow.spec.entities, "pool": two}})
        assert found(monkeypatch, flow.edited(spec=spec), tmp_path / str(layers))["across"].status == status


def test_a_coarser_probe_is_judged_by_the_spacing_of_the_world(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Its particles vouch for the motion; what the bake will resolve is not held against it, and what it will not is."""
    for name, real, status in (("finer", 0.5 * S, "pass"), ("as_coarse", S, "unverified")):
        flow = made.thin_pool(rng(), 4)
        root = tmp_path / name
        candidate = dataclasses.replace(flow.candidate(root), stage="probe", artifact="candidates/f/probe")
        monkeypatch.setattr(liquid, "WATCHES", (Leaks, Across))
        probe = root / "candidates/f/probe"
        probe.mkdir(parents=True)
        write_overrides(probe, {"/entities/pool/physics/resolution": S})
        document = {"spec": {"entities": {"pool": {"physics": {"resolution": real}}}}}
        (probe.parent / "candidate.json").write_text(json.dumps(document))
        watches = liquid.findings_of(candidate, "water").values()
        row = next(f for watch in watches for n, (_, f) in watch.items() if n == "across")
        assert row.status == status, row.text
