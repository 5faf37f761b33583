"""Golden rows: every row of seeded worlds as data, and what differs from them today.

python -m worldagent.bench.golden record [--only CHECK] [--worlds]   # write tests/golden/<check>.json
python -m worldagent.bench.golden compare [--only CHECK] [--worlds]  # print each difference; 1 where there is one

Of every mechanism of every suite the first world picked by hand is judged by the suite's check; `--worlds` takes the accepted worlds
and those that the skills record instead, built and baked anew, with the rows of their acceptance.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from ..execution.processes import core_count
from ..testing.defects.accepted import recorded, rejudge, specifications
from ..testing.defects.judge import judge_one
from ..testing.defects.suites import CHECKS, suite_of
from ..worlds.requirements import Row

__all__ = ["FIELDS", "GOLDEN", "compare", "differences", "main", "rows_of_suite", "write"]

GOLDEN = Path(__file__).parents[1] / "tests" / "golden"
FIELDS = ("id", "status", "measured", "bound", "unit", "first_failing_entity", "first_failing_frame")
CLOSE = 1e-6
"""Relative: numbers of other processors differ by rounding."""
TINY = 1e-9
"""Absolute: differences of numbers that are zero but for rounding."""
SEED = 1

World = list[list[Any]]
"""Rows of one world, in the order of `FIELDS`, sorted by id."""


def data_of(rows: Iterable[Row]) -> World:
    """The kept fields of rows, sorted by id."""
    return sorted(([getattr(row, name) for name in FIELDS] for row in rows), key=lambda r: str(r[0]))


def rows_of_suite(check: str) -> dict[str, World]:
    """Rows of the first hand-picked world of every mechanism of a suite, by mechanism."""
    suite = suite_of(check)
    return {m.name: data_of(judge_one(suite.check, m, m.hand_picked[0], SEED).rows) for m in suite.mechanisms}


def rows_of_worlds() -> dict[str, World]:
    """Rows of the acceptance of every accepted world and every one that a skill records."""
    return {name: data_of(rejudge(name, spec).rows) for name, spec in (*specifications(), *recorded())}


def _same(a: Any, b: Any) -> bool:
    if isinstance(a, float) and isinstance(b, float | int):
        return math.isclose(a, b, rel_tol=CLOSE, abs_tol=TINY) or (math.isnan(a) and math.isnan(b))
    return bool(a == b)


def differences(before: dict[str, World], now: dict[str, World]) -> Iterator[str]:
    """Lines about worlds and rows that are gone, new or other."""
    for world in sorted({*before, *now}):
        if world not in now or world not in before:
            yield f"{world}: {'gone' if world not in now else 'new'}"
            continue
        old, new = ({str(r[0]): r for r in side[world]} for side in (before, now))
        for row in sorted({*old, *new}):
            if row not in new or row not in old:
                yield f"{world}: {row} is {'gone' if row not in new else 'new'}"
                continue
            for name, a, b in zip(FIELDS, old[row], new[row], strict=True):
                if not _same(a, b):
                    yield f"{world}: {row}: {name} was {a!r}, is {b!r}"


def compare(name: str, now: dict[str, World]) -> list[str]:
    """Lines about rows that differ from those kept under a name; none where all are equal."""
    path = GOLDEN / f"{name}.json"
    if not path.exists():
        return [f"{name}: nothing is recorded; run `python -m worldagent.bench.golden record`"]
    # Through JSON, as the recorded ones went.
    fresh = json.loads(json.dumps(now))
    return [f"{name}: {line}" for line in differences(json.loads(path.read_text()), fresh)]


def write(name: str, found: dict[str, World]) -> None:
    """Keep the rows of a suite, one row a line."""
    GOLDEN.mkdir(parents=True, exist_ok=True)
    worlds = ",\n".join(
        f" {json.dumps(world)}: [\n" + ",\n".join(f"  {json.dumps(row)}" for row in rows) + "\n ]"
        for world, rows in found.items()
    )
    (GOLDEN / f"{name}.json").write_text(f"{{\n{worlds}\n}}\n")


def _judge(name: str) -> dict[str, World]:
    return rows_of_worlds() if name == "worlds" else rows_of_suite(name)


def main(arguments: Sequence[str] | None = None) -> int:
    """The command; 0 where nothing differs."""
    parser = argparse.ArgumentParser(prog="golden", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("record", "compare"))
    parser.add_argument("--only", action="append", choices=CHECKS, help="only this suite (repeatable)")
    parser.add_argument("--worlds", action="store_true", help="accepted and recorded worlds instead of the suites")
    options = parser.parse_args(arguments)
    names = ["worlds"] if options.worlds else list(options.only or CHECKS)
    wrong = 0
    with ProcessPoolExecutor(min(core_count(), len(names)), mp_context=get_context("spawn")) as pool:
        for name, found in zip(names, pool.map(_judge, names), strict=True):
            if options.what == "record":
                write(name, found)
                print(f"{name}: {sum(map(len, found.values()))} rows of {len(found)} worlds", flush=True)
                continue
            lines = compare(name, found)
            wrong += len(lines)
            print("\n".join(lines) if lines else f"{name}: {sum(map(len, found.values()))} rows are equal", flush=True)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
