"""Rows and predicates of cloth on worlds that keep them and on worlds broken on purpose."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.simulated_worlds import edited, simulate
from worldagent.testing.worlds.small_cloth import DRAPE_PROMPT, FLAG_PROMPT, PULLED_PROMPT, drape_spec, flag_spec, pulled_spec
from worldagent.tests.verifiers.agreement import agrees, evaluate
from worldagent.verifiers.categories.cloth.check import category_rows
from worldagent.verifiers.categories.cloth.predicates import shadow
from worldagent.verifiers.categories.cloth.register import cloth_lines
from worldagent.verifiers.checks import run_checks
from worldagent.verifiers.diagnosis.cite import diagnose
from worldagent.verifiers.story import beats
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.categories.elastic.events import DeformEvent
from worldagent.worlds.patch import parse_spec
from worldagent.worlds.predicates import Drape, Flutters, Pinned, Torn
from worldagent.worlds.requirements import Row

Frame = dict[str, Any]
FRAMES, STRENGTH = 10, 20.0


def _rows(candidate: Candidate) -> dict[str, Any]:
    return {r.id.split(":")[2]: r for r in category_rows(candidate, "cloth")}


def _strip(folder: Path, strength: float | None, **changes: Any) -> Candidate:
    spec = pulled_spec(stretch=0.018, strength=strength, frames=FRAMES, notch=True)
    spec["simulation"] |= changes
    return simulate(folder, parse_spec({**spec, "prompt": PULLED_PROMPT}))


@pytest.fixture(scope="module")
def torn_strip(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    return _strip(tmp_path_factory.mktemp("torn"), STRENGTH)


def _first(candidate: Candidate) -> int:
    return next(k for k in range(FRAMES) if len(candidate.caches["cloth"].read(k)["tear/time"]))


def test_a_strip_that_tears_passes_every_row(torn_strip: Candidate) -> None:
    rows = _rows(torn_strip)
    assert {n: r.status for n, r in rows.items() if r.status != "pass"} == {}
    assert rows["tears"].measured >= 1.0
    assert any("lips" in line["effect"] for line in cloth_lines(torn_strip))


def test_bodies_on_paths_alone_put_no_energy_in_but_forged_work_is_found(torn_strip: Candidate, tmp_path: Path) -> None:
    def open_rows(candidate: Candidate) -> set[str]:
        return {r.id for r in run_checks(candidate, only=["category"]) if r.mandatory and r.status in ("fail", "unverified")}

    assert open_rows(torn_strip) == set()

    def forged(k: int, data: Frame) -> None:
        if k >= 5:
            data["record/driver_work"] = data["record/driver_work"] - np.float64(1e-7)

    assert "category:rigid:energy:rigid" in open_rows(edited(torn_strip, tmp_path / "forged", "rigid", forged))


def test_tears_without_a_pull_or_a_log_are_found(torn_strip: Candidate, tmp_path: Path) -> None:
    first = _first(torn_strip)

    def eased(k: int, data: Frame) -> None:
        places = data["tear/place"]
        if k == first:
            data["tear/place"] = places.mean(axis=(0, 1)) + 0.99 * (places - places.mean(axis=(0, 1)))

    def louder(k: int, data: Frame) -> None:
        data["tear/tension"] *= 1.1

    def silent(k: int, data: Frame) -> None:
        for name in [n for n in data if n.startswith("tear/")]:
            data[name] = data[name][:0]

    def healed(k: int, data: Frame) -> None:
        if k == FRAMES - 1:
            data["edge/open"][:] = 0

    def parted(k: int, data: Frame) -> None:
        if k == 1:
            data["vertex/position"][0, 2] += 1e-6

    def elsewhere(k: int, data: Frame) -> None:
        data["tear/place"] += 0.5

    def early(k: int, data: Frame) -> None:
        data["tear/time"] -= 1 / 24

    def blamed(k: int, data: Frame) -> None:
        data["tear/cause"][:] = 1
        data["exchange/impulse"][:] = 0.0

    said = {eased: "below the strength", louder: "is logged with", silent: "without a tear in the log", healed: "without a tear", parted: "apart though", elsewhere: "cannot have been", early: "not of its frame", blamed: "gave nothing"}  # fmt: skip
    for change, text in said.items():
        row = _rows(edited(torn_strip, tmp_path / change.__name__, "cloth", change))["tears"]
        assert row.status == "fail", change.__name__
        assert text in row.evidence["explanation"], (change.__name__, row.evidence["explanation"])


def test_a_sheet_that_stays_whole_over_its_strength_is_found(tmp_path: Path) -> None:
    """The run of a stronger fabric, judged by the contract of a weaker one."""
    strong = _strip(tmp_path, 1000.0)
    assert _rows(strong)["strength"].status == "pass"
    entity = strong.spec.entities["strip"]
    weak = entity.model_copy(update={"physics": entity.physics.model_copy(update={"tear": entity.physics.tear.model_copy(update={"strength": 12.0})})})  # fmt: skip
    spec = strong.spec.model_copy(update={"entities": {**strong.spec.entities, "strip": weak}})
    row = _rows(replace(strong, spec=spec))["strength"]
    assert (row.status, row.first_failing_entity) == ("fail", "strip")
    assert row.measured > 1.2


def test_torn_counts_what_opened_and_by_whom(torn_strip: Candidate) -> None:
    last, first = FRAMES - 1, _first(torn_strip)
    whole = evaluate(torn_strip, Torn(entity="strip", min=0.05), (0, last))
    assert whole.status == "pass"
    assert whole.first_true_frame >= first
    assert evaluate(torn_strip, Torn(entity="strip", by="rod", min=0.05), (0, last)).value == pytest.approx(whole.value)
    assert evaluate(torn_strip, Torn(entity="strip", by="post", min=0.05), (0, last)).status == "fail"
    assert evaluate(torn_strip, Torn(entity="strip", max=0.0, when="always"), (0, first - 1)).status == "pass"
    assert evaluate(torn_strip, Torn(entity="rod", max=0.0), (0, last)).status == "unverified"


def test_pins_on_a_rod_that_moves_and_turns_keep_the_cloth_and_a_slip_is_found(tmp_path: Path) -> None:
    spec = pulled_spec(stretch=0.02, strength=None, frames=6)
    spec["simulation"]["drivers"]["pull"]["keys"]["k1"]["pose"]["euler"] = [0.3, 0.0, 0.1]
    spec["simulation"]["drivers"]["pull"]["keys"]["k1"]["pose"]["position"][2] = 1.05
    sound = simulate(tmp_path / "sound", parse_spec({**spec, "prompt": PULLED_PROMPT}))
    row = _rows(sound)["pins"]
    assert row.status == "pass"
    assert evaluate(sound, Pinned(entity="strip", pin="drawn"), (0, 5)).status == "pass"
    held = np.flatnonzero(sound.caches["cloth"].read(0)["vertex/position"][:, 0] > 0.2499)
    moved = sound.caches["cloth"].read(5)["vertex/position"][held] - sound.caches["cloth"].read(0)["vertex/position"][held]
    assert np.linalg.norm(moved, axis=1).min() > 0.02

    def late(k: int, data: Frame) -> None:
        if k == 3:
            data["vertex/position"][held] = sound.caches["cloth"].read(2)["vertex/position"][held]

    def loose(k: int, data: Frame) -> None:
        if k >= 4:
            data["vertex/position"][held[0], 2] -= 3e-5 * (6 - k)

    for change, frame in ((late, 3), (loose, 4)):
        broken = edited(sound, tmp_path / change.__name__, "cloth", change)
        row = _rows(broken)["pins"]
        assert (row.status, row.first_failing_frame) == ("fail", frame), row.evidence
        slip = Pinned(entity="strip", max_slip=1e-5)
        assert evaluate(broken, slip, (0, 5)).first_failing_frame == frame
        assert evaluate(broken, Pinned(entity="strip", pin="still", max_slip=1e-5), (0, 5)).status == "pass"
    assert evaluate(sound, Pinned(entity="strip", pin="no"), (0, 5)).status == "unverified"


Waves = Callable[[str, Callable[[Any, float], Any]], Candidate]


@pytest.fixture(scope="module")
def waved(tmp_path_factory: pytest.TempPathFactory) -> Waves:
    """Makes flags of 33 frames that move across their plane as a function of the place at rest and the time says."""
    folder = tmp_path_factory.mktemp("waves")
    spec = flag_spec(frames=33, resolution=0.1)
    spec["simulation"]["drivers"] = {}
    base = simulate(folder / "base", parse_spec({**spec, "prompt": FLAG_PROMPT}))
    rest = base.caches["cloth"].read(0)["vertex/position"]
    place = (rest - rest.min(axis=0)) / np.ptp(rest, axis=0).max()

    def moved(name: str, way: Callable[[Any, float], Any]) -> Candidate:
        def change(k: int, data: Frame) -> None:
            data["vertex/position"] = rest + np.outer(way(place, k / 24), [0.0, 1.0, 0.0])

        return edited(base, folder / name, "cloth", change)

    return moved


def test_a_flutter_is_measured_and_what_does_not_go_to_and_fro_is_rejected(waved: Waves) -> None:
    """Written motions: 2.9 Hz with 0.2 m at the fly end, a bend to one side, none at all."""
    asked = Flutters(entity="flag", min_amplitude=0.15)
    waving = waved("waves", lambda place, t: place[:, 0] * 0.2 * float(np.sin(2 * np.pi * 2.9 * t + 0.4)))
    found = evaluate(waving, asked, (0, 32))
    assert (found.status, found.value, found.unit) == ("pass", pytest.approx(0.19, rel=0.05), "m")
    agrees(found)
    assert found.details["amplitude_m"] == pytest.approx(0.2, rel=0.05)
    assert found.details["frequency_hz"] == pytest.approx(2.9, rel=0.2)
    assert found.details["share"] == pytest.approx(0.25, abs=0.08)
    for changes, unit, value in (
        ({"min_frequency": 5.0}, "Hz", 2.9),
        ({"max_frequency": 2.0}, "Hz", 2.9),
        ({"min_amplitude": 0.3}, "m", 0.19),
        ({"max_amplitude": 0.16}, "m", 0.19),
        ({"min_cycles": 6.0}, "cycles", 3.75),
    ):
        missed = evaluate(waving, asked.model_copy(update=changes), (0, 32))
        assert (missed.status, missed.unit, missed.value) == ("fail", unit, pytest.approx(value, rel=0.15)), changes
        assert missed.bound == next(iter(changes.values()))
        agrees(missed)
    middle = evaluate(waving, asked.model_copy(update={"point": (0.0, 0.0, 0.0)}), (0, 32))
    assert (middle.status, middle.value) == ("fail", pytest.approx(0.1, rel=0.05))
    for still in (waved("bends", lambda place, t: place[:, 0] * 0.5 * t), waved("stands", lambda place, t: 0.0 * place[:, 0])):
        found = evaluate(still, asked, (0, 32))
        assert found.status == "fail"
        agrees(found)


def test_a_sheet_that_sags_bends_and_one_that_moves_as_a_whole_does_not(waved: Waves) -> None:
    """Written motions: sag along either side by a tenth of a metre, a turn about an edge, a way of the whole, a ripple of 1 % of its length."""
    asked = DeformEvent(kind="bends", entity="flag")
    across = waved("across", lambda place, t: 0.1 * t / 1.33 * np.sin(np.pi * place[:, 0]))
    found = evaluate(across, asked, (0, 32))
    assert (found.status, found.unit) == ("pass", "1")
    agrees(found)
    upright = waved("upright", lambda place, t: 0.1 * t / 1.33 * np.sin(1.5 * np.pi * place[:, 2]))
    assert evaluate(upright, asked, (0, 32)).status == "pass"
    for name, way in {
        "turned": lambda place, t: 0.3 * t * place[:, 0],
        "pushed": lambda place, t: t + 0.0 * place[:, 0],
        "rippled": lambda place, t: 0.01 * t / 1.33 * np.sin(np.pi * place[:, 0]),
    }.items():
        assert evaluate(waved(name, way), asked, (0, 32)).status == "fail", name
    for kind in ("stretches", "wobbles"):
        assert evaluate(across, DeformEvent(kind=kind, entity="flag"), (0, 32)).status == "unverified"


def test_a_corner_that_shakes_is_no_flutter_and_one_still_corner_stops_none(waved: Waves) -> None:
    """A sheet 1 wide and 2/3 high (of its own width): its far corner shakes alone, or all but that corner ripples."""
    asked = Flutters(entity="flag", min_amplitude=0.05)
    fly, hoist = (0.6, 0.4, 0.0), (-0.35, 0.0, 0.0)

    def corner(place: Any) -> Any:
        return (place[:, 0] > 0.85) & (place[:, 2] > 0.85 * place[:, 2].max())

    def shake(t: float) -> float:
        return 0.1 * float(np.sin(2 * np.pi * 3.0 * t))

    board = waved("board", lambda place, t: corner(place) * shake(t))
    found = evaluate(board, asked, (0, 32))
    assert (found.status, found.value) == ("fail", pytest.approx(0.0, abs=1e-6))
    assert 0.0 < found.details["share"] < 0.1
    assert found.details["point"] == pytest.approx(fly, abs=0.21)
    assert evaluate(board, asked.model_copy(update={"point": fly}), (0, 32)).status == "pass"
    ripples = waved("ripples", lambda place, t: ~corner(place) * (place[:, 0] > 0.05) * shake(t + 0.2))
    found = evaluate(ripples, asked, (0, 32))
    assert (found.status, found.value) == ("pass", pytest.approx(0.1, rel=0.1))
    assert found.details["share"] > 0.8
    assert evaluate(ripples, asked.model_copy(update={"point": fly}), (0, 32)).status == "fail"
    assert evaluate(ripples, asked.model_copy(update={"point": hoist}), (0, 32)).status == "pass"


def test_a_flutter_that_is_too_seldom_asks_for_more_frames(waved: Waves) -> None:
    """More frames of the run where it ends with the interval, else of the interval; a ball or friction is never to blame."""
    waving = waved("seldom", lambda place, t: place[:, 0] * 0.2 * float(np.sin(2 * np.pi * 2.9 * t + 0.4)))

    def row(cycles: float, frames: tuple[int, int]) -> Row:
        event = waving.spec.story.beats["event"]
        asked = event.model_copy(
            update={"predicate": Flutters(entity="flag", min_amplitude=0.1, min_cycles=cycles), "frames": frames}
        )
        story = waving.spec.story.model_copy(update={"beats": {"event": asked}})
        spec = waving.spec.model_copy(update={"story": story})
        (found,) = [r for r in beats.check(replace(waving, spec=spec)) if r.id == "beat:event"]
        return diagnose(found, spec)

    short = row(6.0, (0, 32))
    assert (short.status, short.unit, short.comparison, short.bound) == ("fail", "cycles", ">=", 6.0)
    assert (short.evidence["about"], short.evidence["asks"]) == ("cloth", "flutters")
    assert short.corrections[0].group == "interval"
    assert short.measured == 3.5
    assert short.corrections[0].patch[0]["value"] == 67  # 3.5 cycles in 32 frames: 6 take 55, and a fifth more
    assert {c.group for c in short.corrections} <= {"interval", "drivers", "cloth", "mass", "joints"}
    inner = row(2.4, (0, 16))
    assert inner.corrections[-1].group == "story"
    assert inner.measured == 1.5
    assert inner.corrections[-1].patch[0]["value"] == [0, 31]  # 1.5 cycles in 16 frames: 2.4 take 25.6, and a fifth more


def test_a_drape_is_told_by_its_shadow(tmp_path: Path) -> None:
    square = np.array([[0, 0, 0], [2, 0, 1], [2, 1, 0], [0, 1, 5.0]])
    assert shadow(square, np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1]], dtype=np.int32)) == pytest.approx(2.0, rel=0.01)
    draped = simulate(tmp_path, parse_spec({**drape_spec(frames=20, resolution=0.1), "prompt": DRAPE_PROMPT}))
    asked = Drape(entity="cloth", over="ball", max=0.6)
    start = evaluate(draped, asked, (0, 0))
    assert (start.status, start.value) == ("fail", pytest.approx(1.0, abs=0.01))
    end = evaluate(draped, asked, (0, 19))
    assert end.status == "pass"
    assert 0.0 < end.value < 0.6
    assert evaluate(draped, asked.model_copy(update={"min": 0.0, "max": 0.01}), (0, 19)).status == "fail"
    assert evaluate(draped, asked.model_copy(update={"over": "ground"}), (0, 19)).status == "unverified"
    assert evaluate(draped, asked.model_copy(update={"entity": "ball"}), (0, 19)).status == "unverified"
