"""Rows about a liquid that are known before anything is simulated: how wide it is, how thick what it wets; and when motion decides them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from worldagent.construction import build_entity
from worldagent.testing.defects import _liquid_scenes as scenes
from worldagent.testing.worlds import small_worlds as sw
from worldagent.testing.worlds.liquid_worlds import Flow, liquid_world, water
from worldagent.verifiers.categories.check import check_declared
from worldagent.verifiers.categories.liquid.corrections import rounded_down
from worldagent.verifiers.categories.liquid.declared import Declared
from worldagent.verifiers.categories.liquid.frames import liquid_of
from worldagent.verifiers.categories.liquid.obstacles import obstacles_finding
from worldagent.verifiers.categories.liquid.resolved import Resolved
from worldagent.verifiers.rows.findings import Finding
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import Bond, Breakable, Entity, Part, Revolution, VoronoiPattern

S = scenes.SPACING


def _turned(profile: list[tuple[float, float]]) -> Part:
    return Part(shape=Revolution(profile=profile, segments=14))


def vase(wall: float, *, neck: float = 0.098, bulge: float = 0.04, breaks: bool = True, spacing: float = S) -> dict[str, Entity]:
    """A vase that is full of water, 27 cm wide inside if nothing is said, with walls of so many metres, on a floor."""
    outer = [(0.0, 0.0), (neck + 0.02, 0.0), (neck + 0.02 + bulge, 0.22), (neck + 0.02, 0.4), (neck + 0.02, 0.5)]
    inner = [
        (neck + 0.02 - wall, 0.5),
        (neck + 0.02 - wall, 0.4),
        (neck + 0.02 + bulge - wall, 0.22),
        (neck + 0.02 - wall, 0.035),
    ]
    vessel = sw.entity(_turned([*outer, *inner, (0.0, 0.035)]), motion="dynamic", size=(0.32, 0.32, 0.5))
    if breaks:
        pattern = VoronoiPattern(pieces=8, seed=7)
        vessel = vessel.model_copy(update={"breakable": Breakable(pattern=pattern, bond=Bond(tension=6e5, shear=1e6))})
    inside = [(0.0, 0.036), *[(r - 0.001, min(z, 0.45)) for r, z in reversed(inner)], (0.0, 0.45)]
    body = water((0.1, 0.1, 0.1), (0.0, 0.0, 0.0), spacing)
    body = body.model_copy(update={"parts": {"volume": _turned(inside)}})
    return {"floor": sw.box(1.0, 1.0, 0.1, at=(0, 0, -0.05)), "vase": vessel, "water": body}


def judged(folder: Path, entities: dict[str, Entity], spacing: float = S) -> dict[str, Row]:
    spec = liquid_world(entities, spacing=spacing, low=(-0.5, -0.5, 0), high=(0.5, 0.5, 1), two_way=True)
    built = {n: build_entity(spec, n, folder) for n in spec.entities}
    return {r.question.rpartition(":")[2]: r for r in check_declared(Candidate(folder, spec, built, "static"))}


def test_a_full_vase_is_as_wide_as_it_is_and_its_pieces_as_thick_as_its_wall(tmp_path: Path) -> None:
    """The case of a trial: 3.9 spacings were measured of 13, and a cut edge of 6 mm of a wall of 20 mm."""
    rows = judged(tmp_path, vase(0.02))
    assert (rows["across"].status, rows["obstacles"].status) == ("pass", "pass")
    width = 2.0 * (0.098 + 0.06 - 0.02 - 0.001) * np.cos(np.pi / 14)
    assert rows["across"].measured is not None
    assert width * np.cos(np.arctan2(0.06, 0.18)) / S - 0.1 < rows["across"].measured < width / S  # its walls lean
    assert rows["across"].id == "category:liquid:across:water"
    assert rows["obstacles"].measured == pytest.approx(1.0, abs=0.1)


def test_a_bottle_of_three_spacings_is_too_thin_and_the_patch_cures_it(tmp_path: Path) -> None:
    row = judged(tmp_path, vase(0.02, neck=0.012, bulge=0.02))["across"]
    assert (row.status, row.bound) == ("unverified", 5.0)
    assert row.measured == pytest.approx(3.1, abs=0.4)
    finer = float(row.corrections[0].patch[0]["value"])  # type: ignore[arg-type]
    assert judged(tmp_path, vase(0.02, neck=0.012, bulge=0.02, spacing=finer), finer)["across"].status == "pass"


@pytest.mark.parametrize("breaks", [True, False])
def test_a_wall_of_a_quarter_spacing_fails_whole_or_in_pieces_and_the_patch_cures_it(tmp_path: Path, breaks: bool) -> None:
    row = judged(tmp_path, vase(0.005, breaks=breaks))["obstacles"]
    assert (row.status, row.first_failing_entity, row.first_failing_frame) == ("fail", "vase", 0)
    assert row.measured == pytest.approx(0.25, abs=0.07)
    finer = float(row.corrections[1].patch[0]["value"])  # type: ignore[arg-type]
    assert judged(tmp_path, vase(0.005, breaks=breaks, spacing=finer), finer)["obstacles"].status == "pass"


def test_a_spacing_that_a_rule_asks_for_is_rounded_down() -> None:
    assert [rounded_down(v) for v in (0.0125, 0.010068, 0.0199999, 12.3456)] == [0.0125, 0.01, 0.0199, 12.3]


# ---------------------------------------------------------------- what motion decides


FRAMES, REACHES = 12, 6


def _coming(wet_from: int) -> Flow:
    """A pool beside a thin sheet; its water stands at the sheet from a frame on."""
    size = (8 * S, 12 * S, 8 * S)
    sheet = sw.box(0.006, 0.3, 0.3, at=(0.2, 0, 0.15))
    entities = {"floor": sw.box(1.2, 1.2, 0.1, at=(0, 0, -0.05)), "pool": water(size, (0, 0, size[2] / 2), S), "sheet": sheet}
    spec = liquid_world(entities, spacing=S, low=(-0.4, -0.4, -0.1), high=(0.4, 0.4, 0.5), frames=FRAMES)
    points = np.stack(np.meshgrid(*[(np.arange(n) + 0.5) * S for n in (8, 12, 8)], indexing="ij"), axis=-1).reshape(-1, 3)
    points = points - [4 * S, 6 * S, 0]
    there = points + np.array([0.197 - 4 * S, 0, 0])
    places = [there if k >= wet_from else points for k in range(FRAMES)]
    names = tuple(f"{n}/body" for n in entities if n != "pool")
    return Flow(spec, places, [np.zeros_like(points)] * FRAMES, [np.arange(len(points))] * FRAMES, S**3, names)


def _obstacles(candidate: Candidate) -> Finding:
    liquid = liquid_of(candidate, "water")
    watch = Resolved(liquid)
    for step in liquid.steps():
        watch.see(step)
    return obstacles_finding(Declared(candidate, "water"), watch.visited)


def test_what_gets_wet_later_stops_no_probe_and_fails_the_whole_run(tmp_path: Path) -> None:
    whole = _coming(REACHES).candidate(tmp_path)
    dry = _obstacles(whole.until(REACHES - 2))
    assert dry.status == "pass", dry.text
    begun = _obstacles(whole.until(REACHES + 1))
    assert (begun.status, begun.frames) == ("unverified", (0, FRAMES - 1)), begun.text
    assert "later frames decide" in begun.text
    ended = _obstacles(whole)
    assert (ended.status, ended.entity) == ("fail", "sheet"), ended.text
    never = _obstacles(_coming(FRAMES).candidate(tmp_path / "never"))
    assert never.status == "pass", never.text
