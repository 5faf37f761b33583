"""Predicates and events of gas, on smoke as simulated and on fields written by hand."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter
from worldagent.testing.defects._gas_scenes import FRAMES, SOLVER, SOOT, scene
from worldagent.testing.worlds.simulated_worlds import edited
from worldagent.tests.verifiers.agreement import evaluate
from worldagent.verifiers.categories.gas.check import category_rows
from worldagent.verifiers.categories.gas.frames import box_of
from worldagent.verifiers.categories.gas.predicates import optical_depth
from worldagent.verifiers.categories.registry import JUDGES
from worldagent.verifiers.predicates.outcome import Outcome
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.predicates import Predicate
from worldagent.worlds.requirements import Row
from worldagent.worlds.spec import BoxRegion, CameraKey, Requirement, Shot

SPAN = (0, FRAMES - 1)
HALF = 0.5 * SOOT
Frame = dict[str, Any]


@pytest.fixture(scope="module")
def haze(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    """Half of the source's soot in the left half of the box until frame 5, a hundredth of that afterwards; the air stands."""

    def paint(k: int, data: Frame) -> None:
        data["gas_soot"][:] = 0.0
        data["gas_soot"][:8] = HALF if k <= 5 else 0.01 * HALF
        data["gas_temperature"][:] = 293.15
        data["gas_temperature"][0, 0, 0] = 350.0
        data["gas_velocity"][:] = 0.0

    found = edited(scene("cold"), tmp_path_factory.mktemp("haze"), SOLVER, paint)
    spec = found.spec.model_copy(deep=True)
    spec.graph.regions.update(
        left=BoxRegion(min=(-0.4, -0.4, 0), max=(0, 0.4, 0.6)),
        right=BoxRegion(min=(0.05, -0.4, 0), max=(0.4, 0.4, 0.6)),
        all=BoxRegion(min=(-0.4, -0.4, 0), max=(0.4, 0.4, 0.6)),
        away=BoxRegion(min=(3, 3, 3), max=(4, 4, 4)),
    )
    return Candidate(found.folder, spec, found.built, found.stage, found.caches)


def asked(candidate: Candidate, span: tuple[int, int] = SPAN, **fields: Any) -> Outcome:
    predicate: Any = TypeAdapter(Predicate).validate_python({"entity": "smoke", **fields})
    return evaluate(candidate, predicate, span)


CASES: list[tuple[dict[str, Any], str, float | None]] = [
    ({"kind": "gas_density_in", "region": "left", "min": 0.99 * HALF}, "pass", HALF),
    ({"kind": "gas_density_in", "region": "left", "min": 1.01 * HALF}, "fail", HALF),
    ({"kind": "gas_density_in", "region": "all", "min": 0.49 * HALF}, "pass", 0.5 * HALF),
    ({"kind": "gas_density_in", "region": "all", "measure": "largest", "min": 0.99 * HALF}, "pass", HALF),
    ({"kind": "gas_density_in", "region": "right", "max": 0.0, "when": "always"}, "pass", 0.0),
    ({"kind": "gas_temperature_in", "measure": "highest", "max": 349.0}, "fail", 350.0),
    ({"kind": "gas_temperature_in", "measure": "lowest", "min": 293.0}, "pass", 293.15),
    ({"kind": "gas_temperature_in", "region": "right", "max": 293.2, "when": "always"}, "pass", 293.15),
    ({"kind": "plume_height", "min": 0.56, "when": "always"}, "pass", 0.57),
    ({"kind": "plume_height", "base": 0.3, "max": 0.26}, "fail", 0.27),
    ({"kind": "gas_arrives", "region": "left"}, "pass", HALF),
    ({"kind": "gas_arrives", "region": "right"}, "fail", 0.0),
    ({"kind": "gas_arrives", "region": "left", "min_density": 2 * HALF}, "fail", HALF),
    ({"kind": "gas_arrives", "target": "floor"}, "pass", HALF),
    ({"kind": "light_through", "start": (-1, 0.01, 0.3), "end": (1, 0.01, 0.3), "max": 0.2}, "pass", np.exp(-8700 * HALF * 0.4)),
    ({"kind": "light_through", "start": (0.1, -1, 0.3), "end": (0.1, 1, 0.3), "min": 0.99, "when": "always"}, "pass", 1.0),
    ({"kind": "gas_clears", "max_share": 0.02}, "pass", 0.01),
    ({"kind": "gas_clears", "region": "left", "max_share": 0.005}, "fail", 0.01),
    ({"kind": "gas_clears", "region": "right"}, "fail", 1.0),
]  # fmt: skip


@pytest.mark.parametrize(("fields", "status", "value"), CASES)
def test_fields_written_by_hand_have_the_measures_that_they_were_given(
    haze: Candidate, fields: dict[str, Any], status: str, value: float
) -> None:
    found = asked(haze, **fields)
    assert (found.status, found.value) == (status, pytest.approx(value, rel=1e-5, abs=1e-12)), found.explanation


def test_it_clears_at_the_frame_at_which_it_is_thin(haze: Candidate) -> None:
    assert asked(haze, kind="gas_clears", max_share=0.02).first_true_frame == 6
    assert asked(haze, (7, 9), kind="gas_clears", max_share=0.02).status == "fail", "nothing clears that is thin all the time"


def test_what_the_frames_do_not_hold_is_no_evidence(haze: Candidate) -> None:
    assert asked(haze, kind="gas_density_in", region="away", min=0.0).status == "unverified"
    assert asked(haze, kind="gas_arrives", region="nowhere").status == "unverified"
    other = TypeAdapter(Predicate).validate_python({"kind": "plume_height", "entity": "floor", "min": 0.1})
    assert evaluate(haze, other, SPAN).status == "fail", "a floor is no gas"


def test_optical_depth_adds_up_along_any_line(haze: Candidate) -> None:
    """Beer and Lambert: the way through the smoke times its extinction, whatever the direction and where the line begins."""
    box, frame = box_of(haze, SOLVER), box_of(haze, SOLVER).read(0)
    draw = np.random.default_rng(2)
    for _ in range(20):
        a, b = draw.uniform((-0.39, -0.39, 0.01), (0.39, 0.39, 0.59), (2, 3))
        share = np.clip((0.0 - a[0]) / (b[0] - a[0]), 0.0, 1.0)
        within = share if a[0] < 0 else 1.0 - share
        whole = 1.0 if max(a[0], b[0]) < 0 else 0.0 if min(a[0], b[0]) > 0 else within
        assert optical_depth(box, frame, a, b) == pytest.approx(8700 * HALF * whole * np.linalg.norm(b - a), rel=1e-5, abs=1e-9)


def test_hot_smoke_rises_and_cold_fog_does_not() -> None:
    hot, cold = asked(scene("hot"), kind="rises"), asked(scene("cold"), kind="rises")
    assert (hot.status, cold.status) == ("pass", "fail"), (hot.explanation, cold.explanation)


def test_smoke_drifts_with_the_wind_and_not_without() -> None:
    blown, still = asked(scene("wind"), kind="drifts"), asked(scene("hot"), kind="drifts")
    assert (blown.status, still.status) == ("pass", "fail"), (blown.explanation, still.explanation)
    way = blown.details["way"]
    assert way[0] > 2.0 * way[1] > 0.0, "along the wind of 1.0 and 0.3 m/s"


def test_smoke_spreads_where_it_covers_more_from_above(haze: Candidate) -> None:
    assert asked(scene("vent"), kind="spreads").status == "pass"
    assert asked(haze, kind="spreads").status == "fail"


def test_rising_and_drifting_may_be_asked_of_a_gas_and_toppling_not() -> None:
    """`CategorySpec.meets`: bodily kinds of event that matter which is no body meets in its own way."""
    kinds, found = {"rises": False, "drifts": False, "spins": True}, {}
    for kind in kinds:
        spec = scene("room").spec.model_copy(deep=True)
        predicate = TypeAdapter(Predicate).validate_python({"kind": kind, "entity": "smoke"})
        spec.story.requirements["asked"] = Requirement(text="it does", predicate=predicate)
        found[kind] = "asks for a body" in str([r.evidence for r in audit(spec).rows])
    assert found == kinds


def _fate(candidate: Candidate) -> Row:
    return next(r for r in category_rows(candidate, SOLVER) if r.question == "category:gas:fate")


def test_smoke_that_thins_out_and_smoke_that_the_solver_loses_are_told_apart(haze: Candidate, tmp_path: Path) -> None:
    """Both are as good as clear at frame 6; in one all soot is still there, in the other hardly any."""

    def thin(k: int, data: Frame) -> None:
        data["record/emitted_soot"] = np.float64(1e-6)
        data["gas_soot"][:] = 0.0
        if k < 6:
            data["gas_soot"][8, 8, 6] = 1e-6 / 0.05**3
        else:
            data["gas_soot"][:] = 1e-6 / (data["gas_soot"].size * 0.05**3)

    def lose(k: int, data: Frame) -> None:
        thin(k, data)
        if k >= 6:
            data["gas_soot"] *= np.float32(0.01)

    def leave(k: int, data: Frame) -> None:
        lose(k, data)
        data["record/escaped_soot"] = np.float64(0.99e-6 if k >= 6 else 0.0)

    base = scene("cold")
    rows = {c.__name__: _fate(edited(base, tmp_path / c.__name__, SOLVER, c)) for c in (thin, lose, leave)}
    assert {n: r.evidence["cause"] for n, r in rows.items()} == {"thin": "thinned", "lose": "lost", "leave": "escaped"}
    assert all((r.status, r.mandatory, r.first_failing_frame) == ("fail", False, 6) for r in rows.values())
    assert rows["thin"].evidence["thinned"] == pytest.approx(1.0, abs=1e-4)
    assert rows["lose"].evidence["lost"] == pytest.approx(0.99, abs=1e-3)


def test_smoke_out_of_the_picture_is_told_to_be_cropped() -> None:
    base = scene("hot")
    for target, status in (((0, 0, 0.3), "pass"), ((0, 0, 9.0), "fail")):
        spec = base.spec.model_copy(deep=True)
        key = CameraKey(frame=0, position=(0, -2, 0.3), target=target, fov_deg=40)
        spec.shots["side"] = Shot(frames=SPAN, covers=[], intent="smoke", keys={"a": key})
        row = _fate(Candidate(base.folder, spec, base.built, base.stage, base.caches))
        assert row.status == status, row.evidence
    assert row.evidence["cause"] == "cropped"


def test_the_judge_tells_where_smoke_is_how_much_and_what_is_simplified() -> None:
    judge, base = JUDGES["gas"], scene("hot")
    centers, mass = judge.centers(base, "smoke"), judge.mass(base, "smoke")
    assert mass == pytest.approx(box_of(base, SOLVER).record("soot_mass"), rel=1e-6)
    assert centers[0] == pytest.approx([0, 0, 0.05]), "nothing has come yet: it will come there"
    assert (np.diff(centers[1:, 2]) > 0).all()
    skin = judge.outline(base, "smoke", FRAMES - 1)
    low, high = skin.vertices.min(axis=0), skin.vertices.max(axis=0)
    assert ((low <= centers[-1]) & (centers[-1] <= high)).all()
    assert "2.25 litres" in judge.amount(base, "smoke")
    told = " ".join(line["what"] + line["effect"] for line in judge.lines(scene("curled")))
    for word in ("eddies", "confinement", "open side", "settles", "omitted reaction"):
        assert word in told
