"""Tool calls in random order, with forgeries between them: no path leads to acceptance of a world that does not deserve it.

Three kinds of such worlds: a story that cannot happen, blocks that stand inside each other, a block in mid-air. What a random
sequence may reach is a world whose requirement was dropped with a reason; then the acceptance says so.
"""

from __future__ import annotations

import copy
import json
import random
import shutil
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from worldagent.tests.stories.inline_jobs import run_jobs_inline
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.verifiers.acceptance import judge
from worldagent.worlds.errors import WorldAgentError
from worldagent.worlds.ledger import Ledger

KINDS = ("over the limit: ", "invalid: ", "refused: ", "evidence: ", "engine: ", "stopped: ")
"""The kinds of error that clients are told of; `internal error` is none of them."""
LENGTHS = (6, 12)
"""Calls of a short sequence, least and most."""
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


def _nested() -> dict[str, Any]:
    """Two blocks stand inside each other; the story asks for no more than what happens anyhow."""
    spec = _impossible()
    spec["entities"]["b2"]["pose"]["position"][0] = spec["entities"]["b3"]["pose"]["position"][0] - 0.012
    return spec


def _floating() -> dict[str, Any]:
    """A block that nothing carries is called static, and the one that should fall stays."""
    spec = _impossible()
    spec["entities"]["b2"] |= {"motion": "static", "pose": {"position": [0.1, 0, 0.6]}}
    return spec


WORLDS: dict[str, Callable[[], dict[str, Any]]] = {"impossible": _impossible, "nested": _nested, "floating": _floating}


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
        # Ways of asking for less.
        ("/story/beats/fall/mandatory", False),
        ("/story/beats/fall/observe", False),
        ("/story/beats/fall/predicate/min", rng.choice([1e-5, 0.001, -1.0])),
        ("/story/beats/fall/predicate", {"kind": "supported", "entity": "b3"}),
        ("/story/beats/fall/causes", []),
        ("/story/beats/fall/frames", [11, 11]),
        ("/claims/falls_off", {"quote": "falls off", "type": "event", "waived": "dropped for now"}),
        ("/claims/falls_off", {"quote": "falls off", "type": "property", "by": ["/entities/b3"]}),
        ("/claims/falls_off/by", ["/story/beats/strike"]),
        (
            "/graph/relations/glue",
            {
                "kind": "fastened",
                "a": "b2",
                "b": "b3",
                "max_depth": rng.choice([0.01, 0.02, 1.0]),
                "reason": "glued as one piece",
            },
        ),
        ("/entities/b3/motion", rng.choice(["static", "kinematic"])),
        ("/entities/b2/parts/body/collides", False),
        ("/entities/b3/dimensions/tolerance", 0.5),
        ("/simulation/limits/support_drift", 0.05),
        ("/simulation/drivers/lift", {"kind": "force", "entity": "b3", "force": [0, 0, 40], "end": 0.4}),
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


def _forge(rng: random.Random, folder: Path, donor: Path) -> str:
    """Do what an agent with a shell might do: to the ledger, to records, to caches, or with those of an accepted world."""
    import sqlite3

    statements = (
        "UPDATE freezes SET passed=1",
        "UPDATE matrix SET status='pass'",
        "DELETE FROM history",
        "UPDATE iterations SET probe='x'",
        "UPDATE bakes SET digest='x'",
    )
    frames = sorted(folder.glob("candidates/*/*/rigid/frame_*.npz"))
    choice = rng.choice(["ledger", "ledger", "swap", "flip", "record", "donor", "built", "world"])
    if choice == "ledger":
        with sqlite3.connect(folder / "ledger.sqlite") as db:
            db.execute(rng.choice(statements))
            if rng.random() < 0.5:
                db.execute("DELETE FROM meta")
        db.close()
    elif choice == "swap" and len(frames) > 1:
        first, second = rng.sample(frames, 2)
        spare = first.with_name("spare")
        first.rename(spare)
        second.rename(first)
        spare.rename(second)
    elif choice == "flip" and frames:
        path = rng.choice(frames)
        data = bytearray(path.read_bytes())
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
        path.write_bytes(bytes(data))
    elif choice == "record":
        for path in folder.glob("candidates/*/candidate.json"):
            record = json.loads(path.read_text())
            record["freeze"] = "".join(rng.choices("0123456789abcdef", k=64))
            path.write_text(json.dumps(record))
    elif choice == "donor":
        shutil.copytree(donor / "candidates", folder / "candidates", dirs_exist_ok=True)
    elif choice == "built":
        for path in list(folder.glob("built/*"))[:1]:
            path.write_bytes(rng.choice(list((donor / "built").glob("*"))).read_bytes())
    elif choice == "world" and rng.random() < 0.3:
        document = json.loads((folder / "world.json").read_text())
        document["simulation"]["limits"] = {**document["simulation"].get("limits", {}), "max_speed": 99.0}
        (folder / "world.json").write_text(json.dumps(document))
    return choice


def _allowed(folder: Path) -> bool:
    """Nothing is accepted; or what was dropped on the way stands in the acceptance."""
    found = Ledger(folder / "ledger.sqlite").acceptance()
    if found is None or found["verdict"] != "accepted":
        return not list(folder.glob("candidates/*/final"))
    prompt = found["record"]["prompt"]
    told = [*prompt["waivers"], *prompt["readings"], *prompt["warnings"]]
    return any("falls" in words for words in told) and bool(found["record"]["weakenings"])


def _walk(
    agent: Any, seed: int, calls: int, *, forging: float, world: str = "w", kind: str = "impossible", donor: Path | None = None
) -> Counter[str]:
    rng = random.Random(seed)
    folder = agent.workspace / world
    agent.call("edit_spec", world=world, prompt=PROMPT, spec=WORLDS[kind]())
    seen: Counter[str] = Counter()
    revision = 1
    for _ in range(calls):
        tool, arguments = _call(rng)
        if tool != "job":
            arguments["world"] = world
        if donor is not None and rng.random() < forging:
            seen[f"forged {_forge(rng, folder, donor)}"] += 1
        answer = agent.result(tool, **arguments)
        text = answer.content[0].text
        if answer.is_error:
            assert text.startswith(KINDS), (tool, arguments, text)
            seen[f"{tool} {text.split(':')[0]}"] += 1
        else:
            seen[tool] += 1
        assert _allowed(folder), (kind, seed, tool, arguments)
        ledger = Ledger(folder / "ledger.sqlite")
        assert revision <= ledger.revision() <= revision + 1
        revision = ledger.revision()
        recorded = ledger.revision_spec(revision)
        assert recorded is not None
        assert PROMPT in recorded[0]
    return seen


@pytest.fixture(scope="module")
def walker(tmp_path_factory: pytest.TempPathFactory, agent_of: Callable[[Path], Any]) -> Iterator[Any]:
    """A client whose jobs run within its calls."""
    with pytest.MonkeyPatch.context() as patch, agent_of(tmp_path_factory.mktemp("walks")) as made:
        run_jobs_inline(patch)
        yield made


def _sequences(agent: Any, donor: Path, seeds: range) -> Counter[str]:
    total: Counter[str] = Counter()
    for seed in seeds:
        world = f"s{seed}"
        total += _walk(
            agent,
            seed,
            random.Random(seed).randint(*LENGTHS),
            forging=0.15,
            world=world,
            kind=list(WORLDS)[seed % len(WORLDS)],
            donor=donor,
        )
        shutil.rmtree(agent.workspace / world)
    return total


def test_a_random_walk_of_calls_accepts_nothing_impossible_and_crashes_nothing(agent: Any) -> None:
    """Through real worker processes."""
    seen = _walk(agent, 7, 60, forging=0.0)
    assert seen["edit_spec"] > 2
    assert seen["edit_spec refused"] > 2


def test_short_sequences_of_calls_and_forgeries_accept_nothing_undeserved(walker: Any, accepted_folder: Path) -> None:
    seen = _sequences(walker, accepted_folder, range(30))
    assert seen["edit_spec refused"] > 10
    assert sum(n for name, n in seen.items() if name.startswith("forged")) > 10


@pytest.mark.slow
@pytest.mark.parametrize("first", range(1000, 2000, 100))
def test_a_thousand_sequences_of_calls_and_forgeries_accept_nothing_undeserved(
    walker: Any, accepted_folder: Path, first: int
) -> None:
    seen = _sequences(walker, accepted_folder, range(first, first + 100))
    assert seen["run_checks"] > 10
    assert seen["bake_sim refused"] > 10


@pytest.mark.slow
@pytest.mark.parametrize("kind", WORLDS)
@pytest.mark.parametrize("seed", [1, 2])
def test_long_random_walks(walker: Any, accepted_folder: Path, seed: int, kind: str) -> None:
    world = f"long{seed}{kind}"
    _walk(walker, seed, 250, forging=0.05, world=world, kind=kind, donor=accepted_folder)
    assert _verdict(walker.workspace / world) != "accepted" or Ledger(walker.workspace / world / "ledger.sqlite").weakenings()


def _verdict(folder: Path) -> str:
    """Verdict of the verifiers on the folder by themselves, or why they cannot judge."""
    try:
        return str(judge(folder)["verdict"])
    except WorldAgentError as error:
        return str(error)
