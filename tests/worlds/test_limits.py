"""Caps: refused before the work, with cap, estimate and knob."""

from __future__ import annotations

import copy
import math
from pathlib import Path
from typing import Any

import pytest
from worldagent.worlds.errors import InputError, LimitError
from worldagent.worlds.limits import CAPS, check_cap, check_limits, check_workspace, estimate_counts, workspace_bytes
from worldagent.worlds.spec import WorldSpec

BOX = {
    "role": "box",
    "motion": "dynamic",
    "material": "wood",
    "dimensions": {"size": [1, 1, 1]},
    "parts": {"a": {"shape": {"kind": "box", "size": [1, 1, 1]}}, "b": {"shape": {"kind": "sphere", "radius": 0.5}}},
}
ROPE = {**BOX, "parts": {}, "generator": {"kind": "rope", "points": [[0, 0, 0], [1, 0, 0]], "radius": 0.01, "segments": 30}}


def world(entities: dict[str, Any], **simulation: Any) -> WorldSpec:
    plan = {"frames": 49, "fps": 24, "solvers": {"rigid": {"engine": "mujoco", "members": sorted(entities)}}, **simulation}
    materials = {"wood": {"density": 600.0, "friction": 0.5, "restitution": 0.2, "substance": "wood"}}
    return WorldSpec.model_validate(
        {"title": "t", "prompt": "p", "materials": materials, "entities": entities, "simulation": plan}
    )


def test_counts_of_a_small_world() -> None:
    counts = estimate_counts(world({"a": BOX, "floor": {**BOX, "motion": "static"}, "rope": ROPE}, preroll=1.0))
    assert counts["bodies"] == 31
    assert counts["parts"] == 2 + 2 + 30
    assert counts["frames"] == 49 + 24
    assert counts["steps"] == pytest.approx(3.0 / 5e-4)
    assert counts["body_steps"] == pytest.approx(31 * 3.0 / 5e-4)
    assert counts["cache_bytes"] == 31 * 49 * 160


def test_a_small_world_is_within_all_caps() -> None:
    assert set(check_limits(world({"a": BOX}))) <= set(CAPS)


@pytest.mark.parametrize(
    ("entities", "simulation", "cap", "knob"),
    [
        ({f"rope{k}": {**ROPE, "generator": {**ROPE["generator"], "segments": 200}} for k in range(11)}, {}, "bodies", "rope"),
        ({"a": BOX}, {"frames": 20000, "preroll": 1.0}, "frames", "/simulation/preroll"),
    ],
)
def test_too_much_is_refused_with_cap_estimate_and_knob(entities: Any, simulation: Any, cap: str, knob: str) -> None:
    with pytest.raises(LimitError) as caught:
        check_limits(world(entities, **simulation))
    text = str(caught.value)
    assert text.startswith(f"{cap}: estimated ")
    assert f"cap {CAPS[cap].value:,}" in text
    assert knob in text


def test_what_robustness_and_counterfactuals_repeat_is_estimated_before_it_runs() -> None:
    beat = {"text": "t", "owner": "rigid", "subject": "a", "predicate": {"kind": "speed", "entity": "a", "min": 1.0}}
    beats = {"one": {**beat, "frames": [0, 24]}, "two": {**beat, "frames": [24, 48], "causes": ["one"]}}
    spec = world({"a": BOX}).model_dump(mode="json", exclude_none=True)
    spec["story"] = {"beats": beats}
    steps = 2000.0
    causal = estimate_counts(WorldSpec.model_validate(spec))["rerun_body_steps"]
    assert causal == pytest.approx((48 + 24) / 24 * steps)
    pushed = copy.deepcopy(spec)
    pushed["simulation"]["drivers"] = {"f": {"kind": "force", "entity": "a", "force": [1, 0, 0], "start": 1.0, "end": 2.0}}
    assert estimate_counts(WorldSpec.model_validate(pushed))["rerun_body_steps"] - causal == pytest.approx(
        (48 - 24 + 24) / 24 * steps
    )
    pushed["story"]["beats"]["one"]["owner"] = "f"
    assert estimate_counts(WorldSpec.model_validate(pushed))["rerun_body_steps"] == causal, (
        "a beat owns it: nothing runs without it"
    )
    spec["story"]["robustness"] = {
        "r": {"kind": "perturbed", "beats": ["two"], "samples": 10, "min_fraction": 1, "speed": 0.1},
        "f": {"kind": "refined", "beats": ["one"], "factor": 4},
    }
    assert estimate_counts(WorldSpec.model_validate(spec))["rerun_body_steps"] - causal == pytest.approx((10 * 2 + 4 * 1) * steps)
    spec["simulation"] |= {
        "frames": 20000,
        "solvers": {"rigid": {"engine": "mujoco", "members": ["a"], "settings": {"step": 2e-5}}},
    }
    spec["story"]["beats"]["two"]["frames"] = [24, 19999]
    spec["story"]["robustness"]["r"]["samples"] = 64
    with pytest.raises(LimitError, match="rerun_body_steps"):
        check_limits(WorldSpec.model_validate(spec))


def test_the_cap_itself_is_allowed_and_no_number_is_not() -> None:
    check_cap("bodies", 2000)
    for bad in (2001, math.nan, math.inf):
        with pytest.raises(LimitError):
            check_cap("bodies", bad)


def test_workspace_bytes_count_files_and_do_not_follow_links(tmp_path: Path) -> None:
    workspace = tmp_path / "workspace"
    (workspace / "a").mkdir(parents=True)
    (workspace / "a" / "file").write_bytes(b"x" * 1000)
    (tmp_path / "outside").write_bytes(b"x" * 100_000)
    (workspace / "link").symlink_to(tmp_path)
    assert 1000 <= workspace_bytes(workspace) < 2000
    check_workspace(workspace, 1000)
    with pytest.raises(LimitError, match="workspace_bytes"):
        check_workspace(workspace, CAPS["workspace_bytes"].value)


def test_a_workspace_that_is_gone_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="'away' is gone; create it again"):
        check_workspace(tmp_path / "away", 1000)
