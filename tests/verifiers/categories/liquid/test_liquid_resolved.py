"""Widths and thicknesses that a spacing resolves, liquid that stays where nothing bears it, and worlds that only look wrong."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.testing.defects import _liquid_resolution as made
from worldagent.testing.defects import _liquid_scenes as scenes
from worldagent.testing.worlds import small_worlds as sw
from worldagent.testing.worlds.liquid_worlds import Flow, liquid_world, water
from worldagent.verifiers.categories.liquid import check as liquid
from worldagent.verifiers.categories.liquid.resolved import Resolved
from worldagent.verifiers.categories.liquid.sticking import Sticking
from worldagent.verifiers.rows.findings import Finding
from worldagent.worlds.spec import Entity

S = scenes.SPACING


def found(monkeypatch: pytest.MonkeyPatch, flow: Flow, folder: Path) -> dict[str, Finding]:
    """Findings of both watches."""
    monkeypatch.setattr(liquid, "WATCHES", (Resolved, Sticking))
    return {n: f for watch in liquid.findings_of(flow.candidate(folder), "water").values() for n, (_, f) in watch.items()}


def rng(seed: int = 3) -> np.random.Generator:
    return np.random.default_rng(seed)


@pytest.mark.parametrize("width", [1.2, 2.5, 2.95])
def test_a_narrow_way_is_measured_at_its_place(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, width: float) -> None:
    flow = made.parted(rng(), width * S)
    row = found(monkeypatch, flow, tmp_path)["passages"]
    assert row.status == "fail"
    assert row.measured == pytest.approx(width, rel=0.01)
    posts = [flow.spec.entities[n] for n in ("near_post", "far_post")]
    y = 0.5 * sum(p.pose.position[1] + s * p.parts["p0"].shape.size[1] / 2 for p, s in zip(posts, (1, -1), strict=True))  # type: ignore[union-attr]
    assert row.evidence is not None
    assert row.evidence["place"][1] == pytest.approx(y, abs=0.05 * S)
    assert sorted(row.evidence["between"]) == ["far_post/p0", "near_post/p0"]


@pytest.mark.parametrize("width", [3.05, 4.0])
def test_a_way_that_is_wide_enough_passes(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, width: float) -> None:
    assert found(monkeypatch, made.parted(rng(), width * S), tmp_path)["passages"].status == "pass"


def standing(solids: dict[str, Entity]) -> Flow:
    """Water that stands on a floor about solids, 24 spacings wide."""
    size = (24 * S, 24 * S, 8 * S)
    floor = sw.box(0.8, 0.8, 0.1, at=(0, 0, -0.05))
    entities = {"floor": floor, "pool": water(size, (0, 0, size[2] / 2), S), **solids}
    spec = liquid_world(entities, spacing=S, low=(-0.25, -0.25, -0.1), high=(0.25, 0.25, 0.5), frames=8)
    points = np.stack(np.meshgrid(*[(np.arange(n) + 0.5) * S for n in (24, 24, 8)], indexing="ij"), axis=-1).reshape(-1, 3)
    points = points - [12 * S, 12 * S, 0]
    names = tuple(f"{n}/body" for n in entities if n != "pool")
    return Flow(spec, [points] * 8, [np.zeros_like(points)] * 8, [np.arange(len(points))] * 8, S**3, names)


def test_edges_corners_grooves_and_small_things_are_no_passages(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """An outer edge, a groove of two spacings that ends, and a stone that water goes around as well as under."""
    solids = {
        "step": sw.box(0.2, 0.2, 0.08, at=(-0.14, -0.14, 0.04)),
        "groove_a": sw.box(0.12, 0.04, 0.2, at=(0.18, 0.0, 0.1)),
        "groove_b": sw.box(0.12, 0.04, 0.2, at=(0.18, 0.08, 0.1)),
        "groove_end": sw.box(0.04, 0.12, 0.2, at=(0.23, 0.04, 0.1)),
        "stone": sw.box(0.04, 0.04, 0.04, at=(0.0, 0.14, 0.05)),
    }
    row = found(monkeypatch, standing(solids), tmp_path)["passages"]
    assert (row.status, row.text) == ("pass", row.text)


def test_thickness_counts_all_that_is_behind_a_wet_face(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A sheet alone is too thin; the same sheet on the floor is part of a thick one."""
    alone = standing({"sheet": sw.box(0.006, 0.2, 0.2, at=(0.003, 0, 0.1))})
    laid = standing({"sheet": sw.box(0.2, 0.2, 0.006, at=(0, 0, 0.003))})
    thin = found(monkeypatch, alone, tmp_path / "a")["obstacles"]
    assert (thin.status, thin.entity) == ("fail", "sheet")
    assert thin.measured == pytest.approx(0.3, abs=0.07)
    assert found(monkeypatch, laid, tmp_path / "b")["obstacles"].status == "pass"


@pytest.mark.parametrize(("viscosity", "status"), [(1e-3, "fail"), (10.0, "fail"), (1000.0, "not_applicable")])
def test_stiff_liquids_get_the_time_that_a_film_takes(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, viscosity: float, status: str
) -> None:
    """Films of a spacing: density g h^2 / (3 viscosity) is 1.3 m/s for 1 Pa s, 1.3 mm/s for 1000."""
    flow = scenes.falling(rng(), frames=18)
    still = [flow.position[0].copy() for _ in range(18)]
    pool = flow.spec.entities["pool"]
    stiff = pool.model_copy(update={"physics": pool.physics.model_copy(update={"viscosity": viscosity})})
    spec = flow.spec.model_copy(update={"entities": {**flow.spec.entities, "pool": stiff}})
    row = found(monkeypatch, flow.edited(spec=spec, position=still, velocity=[np.zeros_like(p) for p in still]), tmp_path)[
        "sticks"
    ]
    assert row.status == status, row.text
    assert status != "fail" or "in the air" in row.text


def test_drops_that_surface_tension_holds_are_not_judged(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    flow = scenes.pool(rng())
    pool = flow.spec.entities["pool"]
    sticky = pool.model_copy(update={"physics": pool.physics.model_copy(update={"surface_tension": 10.0})})
    spec = flow.spec.model_copy(update={"entities": {**flow.spec.entities, "pool": sticky}})
    assert found(monkeypatch, flow.edited(spec=spec), tmp_path)["sticks"].status == "not_applicable"


@pytest.mark.parametrize("seed", [1, 2])
def test_what_lies_on_a_ledge_or_turns_round_does_not_stick(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, seed: int) -> None:
    lying = found(monkeypatch, made.ledge(rng(seed), 20), tmp_path / "a")["sticks"]
    assert lying.status == "pass", lying.text
    thrown = found(monkeypatch, made.apex(rng(seed), 1.2), tmp_path / "b")["sticks"]
    assert thrown.status == "pass", thrown.text
