"""`worldagent bench` and `worldagent eval`: what measures the server and its agents."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..worlds.errors import InputError

__all__ = ["BENCHMARKS", "Add", "add_bench_commands"]

BENCHMARKS: dict[str, str] = {
    "startup": "worldagent.bench.startup:run",
    "job-start": "worldagent.bench.job_start:run",
    "edit-latency": "worldagent.bench.edit_latency:run",
    "first-verdict": "worldagent.bench.first_verdict:run",
    "estimates": "worldagent.bench.estimates:run",
    "rigid-dominoes": "worldagent.bench.rigid_dominoes:run",
    "rigid-impacts": "worldagent.bench.rigid_impacts:run",
    "fracture": "worldagent.bench.fracture:run",
    "clearance": "worldagent.bench.clearance:run",
    "contact-scale": "worldagent.bench.contact_scale:run",
    "render": "worldagent.bench.render:run",
    "defects": "worldagent.testing.defects.suites:run",
    "corrections": "worldagent.bench.corrections:run",
    "skills": "worldagent.bench.skills:run",
    "server-load": "worldagent.bench.server_load:run",
    "result-size": "worldagent.bench.result_size:run",
    "prompts": "worldagent.bench.prompts:run",
    "hydrology": "worldagent.bench.hydrology:run",
    "liquid-dambreak": "worldagent.bench.liquid_dambreak:run",
    "grains": "worldagent.bench.grains:run",
    "liquid-gpu": "worldagent.bench.liquid_gpu:run",
    "interiors": "worldagent.bench.interiors:run",
    "statics-scale": "worldagent.bench.statics_scale:run",
    "island": "worldagent.bench.island:run",
    "liquid-surfaces": "worldagent.bench.liquid_surfaces:run",
    "liquid-flip": "worldagent.bench.liquid_flip:run",
    "forest": "worldagent.bench.forest:run",
    "cloth": "worldagent.bench.cloth:run",
    "gas": "worldagent.bench.gas:run",
    "gas-fire": "worldagent.bench.gas_fire:run",
    "gas-peer": "worldagent.bench.gas_peer:run",
    "gas-judging": "worldagent.bench.gas_judging:run",
    "pen": "worldagent.bench.pen:run",
    "eval-smoke": "worldagent.bench.evaluation.smoke:run",
}
"""Benchmarks by name: `run()` returns the figures."""

Add = Callable[[str, Callable[[argparse.Namespace], int], str], argparse.ArgumentParser]
"""Adds a command by name, function and description."""


def add_bench_commands(add: Add) -> None:
    """Add the commands `bench` and `eval`; each sets `command`, which returns the exit code."""
    # Its own parser reads the words behind it: what it offers needs modules that no other command loads.
    evaluation = add("eval", _eval, "Run an evaluation: tasks, agents, isolation, budgets and verdicts (extra: eval).")
    evaluation.add_argument("words", nargs=argparse.REMAINDER, metavar="...", help="`worldagent eval run --help` tells more")
    bench = add("bench", _bench, "Run a benchmark: progress on stderr, one JSON object as the last line of stdout.")
    bench.add_argument(
        "--only",
        "--check",
        metavar="CHECK",
        action="append",
        help="defects: only this check, or `accepted` for the accepted worlds; corrections: only worlds of this suite, `flaws` or `edits`; "
        "skills: only this skill; gas-judging: only this world, or `all`; prompts --dishonest: only this mechanism (repeatable)",
    )
    bench.add_argument("--dishonest", action="store_true", help="prompts: tricks on honest worlds; 1 where one gets through")
    bench.add_argument(
        "--jobs", type=int, metavar="N", choices=range(1, 65), help="prompts --dishonest: scenes at a time (default: 1)"
    )
    bench.add_argument(
        "--adopt", type=Path, metavar="FOLDER", help="defects: keep this accepted world for the clean set, run nothing"
    )
    bench.add_argument(
        "--variants",
        type=int,
        metavar="N",
        help="defects: generated worlds of each kind per check; skills: seeds, each with every case",
    )
    bench.add_argument("--seed", type=int, metavar="N", help="defects, skills: draws magnitudes and details; default a new one")
    bench.add_argument(
        "name", metavar="NAME|list", choices=("list", *BENCHMARKS), help=f"list, or one of: {', '.join(BENCHMARKS)}"
    )


def _eval(arguments: argparse.Namespace) -> int:
    from ..bench.evaluation.commands import main

    return main(arguments.words)


def _bench(arguments: argparse.Namespace) -> int:
    if arguments.name == "list":
        print("\n".join(BENCHMARKS))
        return 0
    if arguments.adopt is not None:
        from ..testing.defects.accepted import KEPT, adopt

        print(adopt(arguments.adopt.expanduser().absolute(), KEPT))
        return 0
    from ..bench.machine import run_benchmark

    if arguments.dishonest and arguments.name == "prompts":
        tricks = "worldagent.bench.dishonest:dishonest_figures"
        found = run_benchmark("prompts", tricks, only=arguments.only, jobs=arguments.jobs or 1)
        print(json.dumps(found))
        return 1 if found["holes"] else 0
    options: dict[str, Any] = {"variants": arguments.variants, "seed": arguments.seed}
    options["checks"] = tuple(arguments.only) if arguments.only else None
    if arguments.only and arguments.name == "defects":
        options["accepted"] = "accepted" in arguments.only
        options["checks"] = tuple(c for c in arguments.only if c != "accepted")
    given = {k: v for k, v in options.items() if v is not None}
    takes = {"defects": given.keys(), "skills": given.keys(), "corrections": {"checks"}, "gas-judging": {"checks"}}
    allowed = takes.get(arguments.name, set())
    if given.keys() - allowed:
        raise InputError(
            f"--only, --variants and --seed belong to the benchmarks 'defects' and 'skills', --only to 'corrections' and 'gas-judging', not to {arguments.name!r}"
        )
    print(json.dumps(run_benchmark(arguments.name, BENCHMARKS[arguments.name], **given)))
    return 0
