"""Benchmark `gas-judging`: processor time of judging gas worlds that the skill records, beside that of simulating them.

    worldagent bench gas-judging                              # the small ones
    worldagent bench gas-judging --only lava --only banner    # those named, or `all`

A world is built and baked in a new folder, then judged twice from its files: at the static stage, and the bake in full, by every check that
needs neither runs nor plates. A run of a few frames, simulated and judged before, loads modules and compiles kernels, and is not counted.
Times are processor seconds of this process and its children, so that other work on the machine hardly counts.
"""

from __future__ import annotations

import os
import statistics
import sys
import tempfile
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from ..construction import build_world, built_paths
from ..simulation.bake import run_bake
from ..simulation.freeze import open_freeze
from ..simulation.schedule import run_frames
from ..testing.defects.accepted import recorded
from ..verifiers.checks import names_of, run_checks
from ..worlds.baked import frame_digests
from ..worlds.candidate import Candidate, open_candidate
from ..worlds.errors import InputError
from ..worlds.folder import WorldFolder, write_atomically
from ..worlds.ledger import Ledger
from ..worlds.spec import WorldSpec

__all__ = ["SMALL", "Judged", "judged_world", "run"]

T = TypeVar("T")
SMALL = ("blower", "bowl", "candle", "chimney", "kettle")
"""Recorded worlds that a core simulates within a minute."""
WARM = 3
"""Frames of the run that compiles."""


class Judged(NamedTuple):
    """Processor seconds of one world."""

    simulated: float
    static: dict[str, float]
    """Seconds of each check at the static stage."""
    full: dict[str, float]
    """Seconds of opening the bake, and of each check of it."""
    open_rows: tuple[str, ...]
    """Rows of the bake that neither pass nor have no case."""

    @property
    def ratio(self) -> float:
        """Judging the bake over simulating it."""
        return sum(self.full.values()) / self.simulated

    def told(self) -> dict[str, Any]:
        """Its figures, rounded."""
        return {
            "ratio": round(self.ratio, 3),
            "simulated_cpu_s": round(self.simulated, 2),
            "static_cpu_s": round(sum(self.static.values()), 2),
            "full_cpu_s": round(sum(self.full.values()), 2),
            "static_checks_cpu_s": {n: round(v, 2) for n, v in self.static.items()},
            "full_checks_cpu_s": {n: round(v, 2) for n, v in self.full.items()},
            "open_rows": list(self.open_rows),
        }


def worked() -> float:
    """Processor seconds of this process and its children so far."""
    return sum(os.times()[:4])


def chosen_worlds(names: Sequence[str]) -> dict[str, WorldSpec]:
    """Specifications of gas worlds by name; of the small ones where none is named, of every one for `all`.

    Raises:
        InputError: there is no such world.
    """
    known = {n.partition("/")[2]: s for n, s in recorded() if n.startswith("gas/")}
    wanted = tuple(known) if "all" in names else tuple(names) or SMALL
    if missing := [n for n in wanted if n not in known]:
        raise InputError(f"no recorded gas world {missing[0]!r}; name some of {', '.join(known)}, or all")
    return {n: known[n] for n in wanted}


def judged_world(spec: WorldSpec, root: Path) -> Judged:
    """Bake a world in a new folder, and judge it from its files."""
    folder = WorldFolder(root)
    root.mkdir()
    write_atomically(folder.spec_path, spec.model_dump_json(exclude_none=True).encode())
    built, _ = build_world(folder, spec)
    few = min(WARM, spec.simulation.frames)
    warm = Candidate(root, spec, built, "probe", run_frames(spec, built, root / "warm", frames=few))
    run_checks(warm, reruns=False, plates=False)
    run_checks(Candidate(root, spec, built, "static"))
    _, static = _rows(Candidate(root, spec, built, "static"))
    freeze = open_freeze(folder, spec, built, built_paths(folder, spec), 1)
    baked, simulated = _timed(lambda: run_bake(folder, freeze))
    Ledger(folder.ledger_path).put_bake(freeze, 1, baked.digest, {"frame_digests": frame_digests(baked.caches)})
    candidate, opened = _timed(lambda: open_candidate(folder, freeze, "full"))
    rows, full = _rows(candidate)
    unmet = tuple(i for i, status in rows.items() if status not in ("pass", "not_applicable"))
    return Judged(simulated, static, {"opened": opened, **full}, unmet)


def _timed(work: Callable[[], T]) -> tuple[T, float]:
    """Result of a call, and its processor seconds."""
    began = worked()
    found = work()
    return found, worked() - began


def _rows(candidate: Candidate) -> tuple[dict[str, str], dict[str, float]]:
    """Status of each row by id, and processor seconds of each check; what one of them works out stands for those after it."""
    statuses: dict[str, str] = {}
    seconds: dict[str, float] = {}
    for name in names_of(candidate.stage):
        rows, seconds[name] = _timed(partial(run_checks, candidate, only=(name,), reruns=False, plates=False))
        statuses |= {r.id: r.status for r in rows}
    return statuses, seconds


def run(*, checks: Sequence[str] | None = None) -> dict[str, Any]:
    """Figures of the chosen worlds, median and worst ratio.

    Args:
        checks: names of worlds, or `all`; default the small ones.
    """
    found: dict[str, Judged] = {}
    for name, spec in chosen_worlds(tuple(checks or ())).items():
        with tempfile.TemporaryDirectory(prefix="worldagent-gas-") as folder:
            found[name] = judged_world(spec, Path(folder) / name)
        print(f"{name}: {found[name].told()}", file=sys.stderr, flush=True)
    ratios = {n: j.ratio for n, j in found.items()}
    worst = max(ratios, key=lambda n: ratios[n])
    return {
        "median_ratio": round(statistics.median(ratios.values()), 3),
        "worst_ratio": round(ratios[worst], 3),
        "worst_world": worst,
        "worlds": {n: j.told() for n, j in found.items()},
    }
