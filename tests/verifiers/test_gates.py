"""Rigid instances in which hardly anything but a gate on its path moves: no energy of theirs hides what is booked wrongly."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.worlds.simulated_worlds import edited, simulate
from worldagent.testing.worlds.small_grains import SAND_PROMPT, sand_spec
from worldagent.verifiers.categories import check as category
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.spec import WorldSpec

FRAMES, OPENS = 8, 0.1131
"""The gate stops within a step."""
CUBE, STEEL = 0.02, 7800.0
"""[m], [kg/m^3]"""


def gate_world(*, free: bool) -> WorldSpec:
    """A gate that is pulled out of sand, aslant; `free`: beside a cube that lies on the tray's wall."""
    plan = sand_spec(radius=0.012, depth=0.05, frames=FRAMES, ball_at=None, young=1e7, preroll=0.1)
    entities, simulation = plan["entities"], plan["simulation"]
    entities["gate"] = {
        "role": "gate that is pulled up",
        "motion": "kinematic",
        "material": "steel",
        "dimensions": {"size": [0.01, 0.2, 0.1]},
        "pose": {"position": [0, 0, 0.07]},
        "parts": {"plate": {"shape": {"kind": "box", "size": [0.01, 0.2, 0.1]}}},
    }
    if free:
        entities["cube"] = {
            "role": "cube on the wall",
            "motion": "dynamic",
            "material": "steel",
            "dimensions": {"size": [CUBE] * 3},
            "pose": {"position": [0.135, 0, 0.12 + CUBE / 2 + 0.001]},
            "parts": {"body": {"shape": {"kind": "box", "size": [CUBE] * 3}}},
        }
    keys = {"a": {"time": 0.0, "pose": {"position": [0, 0, 0.07]}}, "b": {"time": OPENS, "pose": {"position": [0.01, 0, 0.17]}}}
    simulation["drivers"] = {"pull": {"kind": "path", "entity": "gate", "keys": keys}}
    simulation["solvers"]["bodies"]["members"] = ["tray", "gate", *(["cube"] if free else [])]
    both = {"source": "bodies", "target": "grains", "direction": "two_way", "variables": ["motion", "wrench"]}
    simulation["couplings"] = {"sand_and_gate": both}
    return WorldSpec.model_validate({"prompt": SAND_PROMPT, **plan})


def open_rows(candidate: Candidate) -> dict[str, str]:
    rows = [r for r in category.check(candidate) if r.id.endswith(":bodies")]
    return {r.id.split(":")[-2]: r.evidence["explanation"] for r in rows if r.status not in ("pass", "not_applicable")}


def _pushed(candidate: Candidate) -> float:
    """Largest impulse that the grains gave to the gate in a frame [N s]."""
    cache = candidate.caches["bodies"]
    return float(max(np.abs(cache.read(k)["exchange/impulse"]).max() for k in range(1, FRAMES)))


@pytest.fixture(scope="module")
def beside(tmp_path_factory: pytest.TempPathFactory) -> Candidate:
    return simulate(tmp_path_factory.mktemp("beside"), gate_world(free=True))


def test_a_gate_pulled_out_of_grains_needs_nothing_else_that_moves(tmp_path: Path) -> None:
    """Work on the gate itself is nobody's energy, and no other body takes any."""
    candidate = simulate(tmp_path, gate_world(free=False))
    assert _pushed(candidate) > 1e-4
    assert open_rows(candidate) == {}
    assert np.abs(candidate.caches["bodies"].series("record/driver_work")).max() == 0.0


def test_a_free_body_beside_the_gate_has_its_own_account(beside: Candidate, tmp_path: Path) -> None:
    """An error of 1 mJ, which the gate's own motion once left in the ledger, fails where a body that nothing pushes has it."""
    assert open_rows(beside) == {}
    row = beside.caches["bodies"].index.bodies.index("cube/body")
    speed = np.sqrt(2 * 1e-3 / (STEEL * CUBE**3))

    def gain(frame: int, data: dict[str, Any]) -> None:
        if frame >= 4:
            data["velocity"][row, 0] += speed
            data["record/kinetic_energy"] = data["record/kinetic_energy"] + 1e-3

    assert "energy" in open_rows(edited(beside, tmp_path / "forged", "bodies", gain))
