"""A lift with a crate on it shows its phases: the contact that carries is there from frame 0 (R77, S12)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from worldagent.construction import build_world, built_paths
from worldagent.simulation.freeze import open_freeze
from worldagent.simulation.probe import run_probe
from worldagent.verifiers.story.phases import check, find_phases
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.folder import WorldFolder
from worldagent.worlds.patch import parse_spec

CRATE = 0.1
FRAMES = 28


def _entity(motion: str, material: str, size: list[float], at: list[float]) -> dict[str, Any]:
    body = {"body": {"shape": {"kind": "box", "size": size}}}
    return {
        "role": "thing",
        "motion": motion,
        "material": material,
        "dimensions": {"size": size},
        "pose": {"position": at},
        "parts": body,
    }


def _lift(crate_at: list[float], on: str) -> dict[str, Any]:
    path = {"a": (0, 0.01), "b": (0.2, 0.011), "c": (1.1, 0.3)}
    keys = {k: {"time": t, "pose": {"position": [0, 0, z]}} for k, (t, z) in path.items()}
    up: dict[str, Any] = {"text": "it lifts the crate", "owner": "rigid", "subject": "crate", "frames": [3, 27], "causes": ["go"],
                          "predicate": {"kind": "lifts", "entity": "lift", "other": "crate"}}  # fmt: skip
    go = {
        "text": "the platform rises",
        "owner": "pp",
        "subject": "lift",
        "frames": [2, 20],
        "predicate": {"kind": "rises", "entity": "lift"},
    }
    return {
        "spec_version": "2",
        "prompt": "A platform rises from the floor, and it lifts a wooden crate.",
        "title": "lift",
        "story": {"beats": {"go": go, "up": up}},
        "materials": {"wood": {"density": 600, "substance": "wood", "friction": 0.3}},
        "entities": {
            "floor": _entity("static", "wood", [3, 2, 0.1], [0, 0, -0.05]),
            "lift": _entity("kinematic", "wood", [0.3, 0.3, 0.02], [0, 0, 0.01]),
            "crate": _entity("dynamic", "wood", [CRATE] * 3, crate_at),
        },
        "graph": {"relations": {"s": {"kind": "supports", "a": on, "b": "crate"}}},
        "simulation": {
            "fps": 24,
            "frames": FRAMES,
            "solvers": {
                "rigid": {"engine": "mujoco", "members": ["floor", "lift", "crate"], "settings": {"step": 0.0005, "skin": 0.0005}}
            },
            "drivers": {"pp": {"kind": "path", "entity": "lift", "keys": keys}},
        },
    }


def _probed(root: Path, document: dict[str, Any]) -> Candidate:
    spec = parse_spec(document)
    folder = WorldFolder(root / "w")
    folder.root.mkdir()
    folder.assets.mkdir()
    built, _ = build_world(folder, spec)
    return run_probe(folder, open_freeze(folder, spec, built, built_paths(folder, spec), 1))


def test_what_is_carried_from_the_start_has_no_contact_to_wait_for(tmp_path: Path) -> None:
    candidate = _probed(tmp_path, _lift([0, 0, 0.071], "lift"))
    (row,) = check(candidate)
    assert row.status == "pass", row.evidence
    assert "crate and lift touch from frame 0 on" in find_phases(candidate).notes["first_contact"]


def test_a_crate_beside_the_lift_misses_the_contact_that_is_asked_for(tmp_path: Path) -> None:
    candidate = _probed(tmp_path, _lift([0.6, 0, CRATE / 2 + 0.001], "floor"))
    (row,) = check(candidate)
    assert row.status == "fail"
    assert "no new contact between crate and lift" in find_phases(candidate).notes["first_contact"]


@pytest.mark.parametrize("gap", [0.15])
def test_a_crate_that_falls_onto_the_lift_meets_it_anew(tmp_path: Path, gap: float) -> None:
    phases = find_phases(_probed(tmp_path, _lift([0, 0, 0.071 + gap], "lift")))
    assert phases.first_contact is not None
    assert not phases.touchless
