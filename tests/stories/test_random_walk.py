"""Tool calls in random order: no path leads to acceptance of a world whose story cannot happen, and none to a crash."""

from __future__ import annotations

import copy
import random
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.worlds.ledger import Ledger

KINDS = ("over the limit: ", "invalid: ", "refused: ", "evidence: ", "engine: ", "stopped: ")
"""The kinds of error that clients are told of; `internal error` is none of them."""
WHY = "a guess about what hinders the last block"
REASON = "a guess whether the requirement may be dropped"


def _impossible() -> dict[str, Any]:
    """The last block shall fly two metres up, with nothing to throw it. Few frames and large steps: it is cheap to run."""
    spec = small_spec()
    spec["story"]["beats"]["fall"]["predicate"] = {"kind": "displacement", "entity": "b3", "axis": [0, 0, 1], "min": 2.0}
    spec["story"]["beats"]["fall"]["frames"] = [4, 11]
    spec["simulation"]["frames"] = 12
    spec["shots"]["only"]["frames"] = [0, 11]
    spec["simulation"]["solvers"]["rigid"]["settings"]["step"] = 0.001
    return spec


def _edits(rng: random.Random) -> list[dict[str, Any]]:
    """One or two random changes, sensible or not, none of which takes the impossible beat or its cause away."""
    choices: list[tuple[str, Any]] = [
        ("/entities/ball/physics/linear_velocity/0", round(rng.uniform(-2, 3), 3)),
        ("/entities/b1/pose/position/0", round(rng.uniform(0.05, 0.16), 4)),
        ("/entities/b3/pose/position/2", round(rng.uniform(0.2, 0.5), 4)),
        ("/entities/b2/physics", {"category": "rigid", "mass": round(rng.uniform(0.01, 1), 3)}),
        ("/simulation/solvers/rigid/settings/step", rng.choice([0.0005, 0.001, 1.0])),
        ("/simulation/solvers/rigid/settings/skin", rng.choice([0.0005, 0.001, 0.02])),
        ("/simulation/limits/max_speed", rng.choice([1.0, 100.0])),
        ("/simulation/limits/energy_growth", rng.choice([0.01, 0.2])),
        ("/shots/only/keys/a/position/1", round(rng.uniform(-2, 2), 2)),
        ("/shots/only/frames", [0, rng.randint(0, 14)]),
        ("/look/exposure", round(rng.uniform(-1, 1), 2)),
        ("/title", f"t{rng.random()}"),
        ("/story/beats/roll/frames", [0, rng.randint(0, 11)]),
        ("/story/beats/fall/text", "it flies"),
        ("/materials/wood/friction", round(rng.uniform(0, 1), 2)),
        ("/graph/relations/hits/text", "they meet"),
        ("/entities/b2/material", rng.choice(["wood", "ghost"])),
        ("/prompt", "another"),
        ("/nowhere", 1),
        ("/simulation/gravity", [0, 0, rng.choice([-9.81, -3.7])]),
    ]
    return [
        {"op": "replace" if p.rpartition("/")[2].isdigit() else "add", "path": p, "value": copy.deepcopy(v)}
        for p, v in rng.sample(choices, rng.choice([1, 1, 1, 2]))
    ]


def _call(rng: random.Random) -> tuple[str, dict[str, Any]]:
    job = f"job_{rng.randrange(16**12):012x}"
    calls: list[tuple[float, str, dict[str, Any]]] = [
        (
            8,
            "edit_spec",
            {"patch": _edits(rng), "hypothesis": rng.choice(["", WHY]), "weakening_reason": rng.choice(["", REASON])},
        ),
        (1, "edit_spec", {"on_hand_edit": rng.choice(["adopt", "restore"])}),
        (1, "edit_spec", {"prompt": PROMPT}),
        (3, "place_object", {}),
        (
            1,
            "place_object",
            {"entity": rng.choice(["b1", "b3", "ghost"]), "on": rng.choice(["shelf", "floor"]), "hypothesis": WHY},
        ),
        (1, "build_terrain", {"kind": "flat", "entity": rng.choice(["land", "floor"]), "cells": 2, "hypothesis": WHY}),
        (2, "probe_sim", {"wait_s": 60}),
        (1, "bake_sim", {"wait_s": 60}),
        (2, "run_checks", {"scope": rng.choice(["audit", "static", "acceptance"]), "wait_s": 60}),
        (0.3, "run_checks", {"scope": rng.choice(["probe", "full"]), "only": ["beat"], "wait_s": 60}),
        (2, "render_shot", {"kind": "final", "wait_s": 0}),
        (0.2, "render_shot", {"kind": "preview", "width": 64, "height": 64}),
        (
            3,
            "inspect_world",
            {"part": rng.choice(["overview", "matrix", "iterations", "revisions", "acceptance", "events", "records"])},
        ),
        (1, "job", {"action": rng.choice(["list", "status", "cancel"]), "job_id": job}),
    ]
    weights = [w for w, _, _ in calls]
    _, tool, arguments = rng.choices(calls, weights)[0]
    return tool, arguments if tool == "job" else {"world": "w", **arguments}


def _forge(rng: random.Random, folder: Path) -> None:
    """What an agent with a shell might do to the ledger."""
    import sqlite3

    with sqlite3.connect(folder / "ledger.sqlite") as db:
        db.execute(
            rng.choice(
                [
                    "UPDATE freezes SET passed=1",
                    "UPDATE matrix SET status='pass'",
                    "DELETE FROM history",
                    "UPDATE iterations SET probe='x'",
                ]
            )
        )
    db.close()


def _walk(agent: Any, seed: int, calls: int, *, forging: float) -> Counter[str]:
    rng = random.Random(seed)
    folder = agent.workspace / "w"
    agent.call("edit_spec", world="w", prompt=PROMPT, spec=_impossible())
    seen: Counter[str] = Counter()
    for _ in range(calls):
        tool, arguments = _call(rng)
        if rng.random() < forging:
            _forge(rng, folder)
        answer = agent.result(tool, **arguments)
        text = answer.content[0].text
        if answer.is_error:
            assert text.startswith(KINDS), (tool, arguments, text)
            seen[f"{tool} {text.split(':')[0]}"] += 1
        else:
            seen[tool] += 1
        ledger = Ledger(folder / "ledger.sqlite")
        verdict = ledger.acceptance()
        assert verdict is None or verdict["verdict"] != "accepted", (tool, arguments)
        assert not list(folder.glob("candidates/*/final"))
        assert ledger.revision() >= 1
        recorded = ledger.revision_spec(ledger.revision())
        assert recorded is not None
        assert PROMPT in recorded[0]
    return seen


def test_a_random_walk_of_calls_accepts_nothing_impossible_and_crashes_nothing(agent: Any) -> None:
    seen = _walk(agent, 7, 150, forging=0.02)
    assert seen["edit_spec"] > 5
    assert seen["edit_spec refused"] > 5
    assert seen["render_shot refused"] + seen["run_checks refused"] > 3


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 3, 4])
def test_long_random_walks(agent: Any, seed: int) -> None:
    _walk(agent, seed, 250, forging=0.05)
