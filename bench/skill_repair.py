"""Does the diagnosis help to repair? Flawed worlds, one scripted solver, with and without what the skills say.

Worlds and flaws are data in `skills/repair/evals/cases.json`; magnitudes are drawn by seed. All arms get the same
worlds, the same budget of edits and the same rules of repair; they differ in what a failing row carries:

- `with`: ranked causes, patches, history of this world (the tables of the skills);
- `checks`: what the checks suggest by themselves, in their order;
- `without`: verdict, measurement, entity and frame only. The solver then draws a group and a generic step.
"""

from __future__ import annotations

import copy
import json
import random
import statistics
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from ..worlds.groups import GROUPS
from ..worlds.requirements import Row
from .trial import Advice, Judged, Trial

__all__ = ["ARMS", "cases", "flawed", "measure", "repair"]

CASES = Path(__file__).resolve().parent.parent / "skills" / "repair" / "evals" / "cases.json"
ARMS: dict[str, Advice] = {"with": "table", "checks": "checks", "without": "none"}
BUDGET = 6
"""Most tests of edits per world."""
SETTINGS = "/simulation/solvers/rigid/settings"
ORDER = (
    "audit",
    "scale",
    "interpenetration",
    "support",
    "navigability",
    "relations",
    "numerical",
    "category",
    "contact",
    "beat",
    "causal",
    "claim",
)
"""Upstream first, as `skills/repair/SKILL.md` asks."""
CAUSAL_CLASSES = ("scene", "solver")


def cases() -> dict[str, Any]:
    """The worlds and flaws of the eval."""
    read: dict[str, Any] = json.loads(CASES.read_text())
    return read


def _at(document: Any, pointer: str) -> tuple[Any, Any]:
    """The container of a pointer's last token, and that token; objects on the way are made."""
    *way, last = pointer.split("/")[1:]
    for token in way:
        document = document[int(token)] if isinstance(document, list) else document.setdefault(token, {})
    return document, int(last) if isinstance(document, list) else last


def flawed(data: dict[str, Any], name: str, rng: random.Random) -> dict[str, Any]:
    """The specification of a flaw's world with the flaw in it, its magnitude drawn."""
    flaw = data["flaws"][name]
    spec: dict[str, Any] = copy.deepcopy(data["worlds"][flaw["world"]]["spec"])
    share = rng.random()
    for operation in flaw["operations"]:
        place, key = _at(spec, operation["pointer"])

        def drawn(value: Any, share: float = share) -> Any:
            return value[0] + share * (value[1] - value[0]) if isinstance(value, list) else value

        if "value" in operation:
            place[key] = drawn(operation["value"])
        elif "plus" in operation:
            place[key] = round(place[key] + drawn(operation["plus"]), 6)
        else:
            place[key] = place[key] * drawn(operation["scale"])
    return spec


# ---------------------------------------------------------------- the solver


def _suggested(rows: Sequence[Row]) -> Iterator[tuple[str, list[dict[str, Any]], str]]:
    """(group, patch, hypothesis) of the rows' own suggestions, best first; none that makes the specification easier."""
    ranks = max((len(r.corrections) for r in rows), default=0)
    for c in (r.corrections[rank] for rank in range(ranks) for r in rows if rank < len(r.corrections)):
        if c.patch and GROUPS[c.group].edit_class in CAUSAL_CLASSES and c.group != "relations":
            yield c.group, [dict(o) for o in c.patch], f"{c.cause}: {c.action}"


def _put(pointer: str, value: Any) -> list[dict[str, Any]]:
    return [{"op": "add", "path": pointer, "value": value}]


def _generic(document: dict[str, Any], row: Row, group: str, rng: random.Random) -> Iterator[list[dict[str, Any]]]:
    """Steps that need no numbers of the row: move by millimetres, halve, double."""
    solver = document["simulation"]["solvers"]["rigid"].get("settings", {})
    if group == "step":
        yield _put(f"{SETTINGS}/step", max(2e-5, solver.get("step", 5e-4) / 2))
    elif group == "contact":
        yield _put(f"{SETTINGS}/skin", round(min(1.2e-3, solver.get("skin", 5e-4) * rng.choice((0.5, 2.0))), 7))
    elif group == "material":
        name = rng.choice(sorted(document["materials"]))
        friction = document["materials"][name]["friction"]
        yield _put(f"/materials/{name}/friction", round(friction * rng.choice((0.6, 1.6)), 4))
    elif group == "drivers":
        for name, driver in document["simulation"].get("drivers", {}).items():
            if "time" in driver:
                yield _put(f"/simulation/drivers/{name}/time", round(driver["time"] * rng.choice((0.5, 1.5)), 4))
    else:
        yield from _generic_of_bodies(document, row, group, rng)


def _generic_of_bodies(document: dict[str, Any], row: Row, group: str, rng: random.Random) -> Iterator[list[dict[str, Any]]]:
    entities = document["entities"]
    named = [n for n in row.entities if n in entities]
    if group == "placement":
        for name in (n for n in named if entities[n]["motion"] != "static"):
            axis, length = rng.choice((0, 2, 2)), rng.choice((-0.02, -0.005, 0.005, 0.02))
            position = list(entities[name]["pose"]["position"])
            position[axis] = round(position[axis] + length, 6)
            yield _put(f"/entities/{name}/pose/position", position)
    elif group == "initial_state":
        for name, entity in entities.items():
            speed = entity.get("physics", {}).get("linear_velocity")
            if speed and any(speed):
                factor = rng.choice((0.7, 1.4, 2.0))
                yield _put(f"/entities/{name}/physics/linear_velocity", [round(v * factor, 6) for v in speed])
    elif group == "shape":
        for name in (n for n in named if not entities[n]["parts"]["body"].get("collides", True)):
            yield _put(f"/entities/{name}/parts/body/collides", True)


GENERIC_GROUPS = ("placement", "initial_state", "step", "contact", "material", "drivers", "shape")


def _guessed(
    document: dict[str, Any], rows: Sequence[Row], rng: random.Random
) -> Iterator[tuple[str, list[dict[str, Any]], str]]:
    """Generic steps on the first failing row: the groups it names, best first; where it names none, in random order."""
    for row in rows:
        named = list(dict.fromkeys(c.group for c in row.corrections if GROUPS[c.group].edit_class in CAUSAL_CLASSES))
        groups = [g for g in named if g in GENERIC_GROUPS] or rng.sample(GENERIC_GROUPS, len(GENERIC_GROUPS))
        for group in groups:
            for patch in _generic(document, row, group, rng):
                yield group, patch, f"a guess: {group} may cause {row.id}"


def _next_edit(trial: Trial, judged: Judged, rng: random.Random, tried: set[str]) -> str | None:
    """Make the next edit that the rules allow; returns its group, None where there is none."""
    # A row without evidence asks for a test, not for an edit.
    failing = [r for r in judged.rows if r.status == "fail"]
    rows = sorted(failing, key=lambda r: (ORDER.index(r.check) if r.check in ORDER else len(ORDER), r.id == "probe:phases"))
    for source in (_suggested(rows), _guessed(trial.document, rows, rng)):
        for group, patch, hypothesis in source:
            key = json.dumps([patch, trial.document], sort_keys=True)
            if key in tried:
                continue
            tried.add(key)
            if not trial.edit(patch, hypothesis):
                return group
    return None


def repair(
    folder: Path, prompt: str, spec: dict[str, Any], advice: Advice, rng: random.Random, budget: int = BUDGET
) -> dict[str, Any]:
    """Repair one world; how many tested edits it took, and which groups."""
    trial = Trial(folder, prompt, spec, advice)
    judged = trial.judge()
    first = [r.id for r in judged.rows if r.status == "fail"]
    groups: list[str] = []
    tried: set[str] = set()
    while not judged.passed and len(groups) < budget:
        group = _next_edit(trial, judged, rng, tried)
        if group is None:
            break
        groups.append(group)
        judged = trial.judge()
    return {"repaired": judged.passed, "edits": len(groups), "groups": groups, "first_failing": first}


def measure(
    seeds: Sequence[int], names: Sequence[str] = (), arms: Sequence[str] = tuple(ARMS), budget: int = BUDGET
) -> dict[str, Any]:
    """Every flaw (or those named) once per seed and arm."""
    data = cases()
    runs: dict[str, list[dict[str, Any]]] = {arm: [] for arm in arms}
    for seed in seeds:
        for name in names or data["flaws"]:
            world = data["worlds"][data["flaws"][name]["world"]]
            for arm in arms:
                spec = flawed(data, name, random.Random(f"{name} {seed}"))
                rng = random.Random(f"{name} {seed} steps")
                with tempfile.TemporaryDirectory() as folder:
                    found = repair(Path(folder) / "w", world["prompt"], spec, ARMS[arm], rng, budget)
                print(
                    f"repair {name} {seed} {arm}: {'mended' if found['repaired'] else 'open'} after {found['groups']}",
                    file=sys.stderr,
                )
                runs[arm].append({"flaw": name, "seed": seed, **found})
    return {
        "budget_edits": budget,
        "worlds": len(seeds) * len(names or data["flaws"]),
        "arms": {a: _figures(r, budget) for a, r in runs.items()},
        "runs": runs,
    }


def _figures(runs: list[dict[str, Any]], budget: int) -> dict[str, Any]:
    """Share of broken worlds that were mended, and the mean of edits; one that stays open counts the whole budget."""
    broken = [r for r in runs if r["first_failing"] or r["edits"]]
    return {
        "broken": len(broken),
        "repaired_share": round(sum(r["repaired"] for r in broken) / max(1, len(broken)), 3),
        "mean_edits": round(statistics.mean([r["edits"] if r["repaired"] else budget for r in broken] or [0]), 2),
    }
