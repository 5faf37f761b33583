"""The evals of the skills: one small case each, and that the skill's data is what differs between the arms."""

from __future__ import annotations

import json
import random
from pathlib import Path
from typing import Any

import pytest
from worldagent.bench import skill_building, skill_gas, skill_liquids, skill_repair, skill_settings
from worldagent.bench.trial import Trial
from worldagent.server.skill_files import SKILLS, skill_files, skill_names
from worldagent.verifiers.diagnosis import cite as diagnosis


def test_every_skill_has_cases_and_a_readme_of_its_eval() -> None:
    assert skill_names()
    for name in skill_names():
        assert {"evals/cases.json", "evals/README.md"} <= set(skill_files(name)), name


# ---------------------------------------------------------------- repair


def _repair(tmp_path: Path, flaw: str, arm: str) -> dict[str, Any]:
    data = skill_repair.cases()
    spec = skill_repair.flawed(data, flaw, random.Random(f"{flaw} 1"))
    prompt = data["worlds"][data["flaws"][flaw]["world"]]["prompt"]
    return skill_repair.repair(tmp_path / arm, prompt, spec, skill_repair.ARMS[arm], random.Random(1), budget=2)


def test_a_late_release_is_mended_by_the_table_and_not_without_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The check alone suggests the story's frames, which is a weakening; the table finds the driver and the time."""
    helped = _repair(tmp_path, "late_release", "with")
    assert (helped["repaired"], helped["groups"]) == (True, ["drivers"])
    monkeypatch.setattr(diagnosis, "entries", tuple)
    (tmp_path / "again").mkdir()
    emptied = _repair(tmp_path / "again", "late_release", "with")
    assert emptied["groups"][:1] != ["drivers"] or not emptied["repaired"]


def test_flaws_name_worlds_and_places_that_exist() -> None:
    data = skill_repair.cases()
    assert data["flaws"]
    for name in data["flaws"]:
        changed = skill_repair.flawed(data, name, random.Random(3))
        assert changed != data["worlds"][data["flaws"][name]["world"]]["spec"], name
        again = skill_repair.flawed(data, name, random.Random(3))
        assert changed == again


@pytest.mark.slow
@pytest.mark.parametrize("world", ["strike", "drop", "dominoes", "slide"])
def test_a_world_without_its_flaw_passes_the_probe(tmp_path: Path, world: str) -> None:
    case = skill_repair.cases()["worlds"][world]
    judged = Trial(tmp_path / "w", case["prompt"], case["spec"]).judge()
    assert judged.passed, [(r.id, r.evidence.get("explanation")) for r in judged.rows]


# ---------------------------------------------------------------- rigid-bodies


def test_settings_follow_the_numbers_of_the_skill() -> None:
    text = (SKILLS / "rigid-bodies" / "SKILL.md").read_text()
    rules = json.loads((SKILLS / "rigid-bodies" / "settings.json").read_text())
    assert f"{rules['step']['share_of_thickness']} * thickness / v" in text
    assert f"at most {rules['step']['largest_s']:.0e} s".replace("e-0", "e-") in text
    assert f"{2 * rules['skin']['share_of_dip']:g} * v * step" in text
    fast = skill_settings.by_skill(10.0, 0.002, 0.1)
    slow = skill_settings.by_skill(1.0, 0.05, 0.1)
    assert fast["step"] <= 0.45 * 0.002 / 10
    assert 2 * fast["skin"] >= 1.49 * 10 * fast["step"]
    assert slow["step"] == rules["step"]["largest_s"]


def test_another_rule_gives_other_settings_and_no_rule_the_defaults() -> None:
    rules = json.loads((SKILLS / "rigid-bodies" / "settings.json").read_text())
    rules["step"]["share_of_thickness"] /= 2
    assert skill_settings.by_skill(10.0, 0.002, 0.1, rules)["step"] < skill_settings.by_skill(10.0, 0.002, 0.1)["step"]
    case = {"text": "t", "axis": "x", "radius": [0.01, 0.01], "speed": [10.0, 10.0], "thickness": [0.004, 0.004]}
    (_, helped), (_, alone) = (skill_settings.scene(case, random.Random(1), arm) for arm in ("with", "without"))
    chosen = [s["simulation"]["solvers"]["rigid"].pop("settings") for s in (helped, alone)]
    assert chosen[0] != chosen[1]
    assert helped == alone


def test_a_fast_ball_on_a_thin_wall_passes_with_the_skills_settings_and_not_with_the_defaults(tmp_path: Path) -> None:
    case = {"text": "t", "axis": "x", "radius": [0.01, 0.01], "speed": [10.0, 10.0], "thickness": [0.004, 0.004]}
    judged = {}
    for arm in ("with", "without"):
        prompt, spec = skill_settings.scene(case, random.Random(1), arm)
        judged[arm] = Trial(tmp_path / arm, prompt, spec).judge()
    assert judged["with"].passed, [r.id for r in judged["with"].rows]
    assert "numerical:step_travel:rigid" in {r.id for r in judged["without"].rows}


# ---------------------------------------------------------------- world-building


def test_the_rules_and_what_is_done_without_them_speak_of_the_same_things() -> None:
    rules = json.loads((SKILLS / "world-building" / "rules.json").read_text())
    assert set(rules) == set(skill_building.NAIVE)
    assert all(rules[k] != skill_building.NAIVE[k] for k in rules)
    text = (SKILLS / "world-building" / "SKILL.md").read_text()
    assert f"Put a body `{rules['gap_skins']} * skin` above its support" in text


def test_a_world_built_by_the_rules_leaves_fewer_rows_open(tmp_path: Path) -> None:
    rules = json.loads((SKILLS / "world-building" / "rules.json").read_text())
    case = {"text": "t", "size": [0.1, 0.1], "way_of_size": [2.0, 2.0]}
    open_rows = {}
    for arm, given in (("with", rules), ("without", skill_building.NAIVE)):
        prompt, spec = skill_building.build("push", case, random.Random(1), given)
        open_rows[arm] = [r.id for r in Trial(tmp_path / arm, prompt, spec).judge().rows]
    assert open_rows["with"] == []
    assert len(open_rows["without"]) > 1


# ---------------------------------------------------------------- liquids, coupled-systems


def test_a_vessel_of_thin_glass_is_resolved_by_the_rule_and_not_by_a_coarse_guess(tmp_path: Path) -> None:
    sizes = {"side": 0.08, "depth": 0.06, "wall": 0.004}
    ruled = skill_liquids.start_resolution("dfsph", sizes)
    assert ruled == pytest.approx(0.004)
    assert skill_liquids._accepted("dfsph", sizes, ruled, tmp_path) == ""
    assert "thick" in skill_liquids._accepted("dfsph", sizes, 0.02, tmp_path)


@pytest.mark.parametrize("shape", ["box", "sphere", "lying_cylinder"])
def test_drafts_of_the_skill_displace_the_weight_of_the_body(shape: str) -> None:
    for ratio in (0.15, 0.42, 0.5, 0.77):
        assert skill_liquids.submerged_share(shape, skill_liquids.start_draft(shape, ratio)) == pytest.approx(ratio, rel=0.03)


# ---------------------------------------------------------------- gas


def test_a_hotter_source_and_a_longer_run_get_a_higher_box_by_the_rule_and_the_same_without_it() -> None:
    steam = skill_gas.Source("water", 0.02, 0.8, 373.0, 0.08, 0.5)
    box = skill_gas.by_skill(steam)
    assert box.cell == pytest.approx(0.04 / 3)
    assert skill_gas.by_skill(steam._replace(seconds=2.0)).above > box.above
    assert skill_gas.by_skill(steam._replace(temperature=600.0)).above > box.above
    assert skill_gas.by_guess(steam._replace(seconds=2.0)) == skill_gas.by_guess(steam)


def test_heavy_gas_is_told_no_rise() -> None:
    mist = skill_gas.Source("water", 0.02, 0.8, 250.0, 0.005, 1.0)
    assert skill_gas.by_skill(mist).above == pytest.approx(0.04)
