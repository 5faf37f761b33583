"""Golden rows: every row of seeded worlds as data, and what differs from them today.

python -m worldagent.bench.golden record [--only CHECK] [--worlds]   # write tests/golden/<check>.json
python -m worldagent.bench.golden record --processor                 # write rows that only this processor rounds otherwise
python -m worldagent.bench.golden compare [--only CHECK] [--worlds]  # print each difference; 1 where there is one

Of every mechanism of every suite the first world picked by hand is judged by the suite's check; a broken one that is not found, or a sound
one that is refused, is told before its rows are looked at. `--worlds` takes the accepted worlds and those that the skills record instead,
built and baked anew, with the rows of their acceptance.

What breaks or folds multiplies rounding: a processor with AVX-512 sums in another order than one with AVX2, and the pieces fly
elsewhere. `tests/golden/processors/<check>.json` holds such rows as other processors measured them, of the same status and bound. A row that
three processors measure differently is noise beyond its status: from then on its status, bound and unit are compared alone.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any, NamedTuple

from ..execution.processes import core_count
from ..testing.defects.accepted import recorded, rejudge, specifications
from ..testing.defects.judge import judge_one
from ..testing.defects.suites import CHECKS, suite_of
from ..worlds.requirements import Row

__all__ = ["FIELDS", "GOLDEN", "Found", "compare", "differences", "main", "rows_of_suite", "write"]

GOLDEN = Path(__file__).parents[1] / "tests" / "golden"
FIELDS = ("id", "status", "measured", "bound", "unit", "first_failing_entity", "first_failing_frame")
CLOSE = 1e-6
"""Relative: numbers of other processors differ by rounding."""
PROCESSORS = GOLDEN / "processors"
NOISE = 2
"""Number of other processors that measured a row differently from the recorded one, from which on its numbers tell nothing."""
TINY = 1e-9
"""Absolute: differences of numbers that are zero but for rounding."""
SHARE_OF_BOUND: Mapping[str, float] = {"gas": 0.01}
"""[1] By suite: difference of a row's number over its bound, or over itself where it is beyond that, that is forgiven. Cells of gas are of single precision, and a processor or
compiler that fuses multiplications rounds each otherwise: balances differ by 1e-7 to 1e-6, a hundredth of their bounds of 1e-4."""
SEED = 1

JUDGED = [FIELDS.index(name) for name in ("id", "status", "bound", "unit")]
"""Fields that no processor may change."""

World = list[list[Any]]
"""Rows of one world, in the order of `FIELDS`, sorted by id."""


def data_of(rows: Iterable[Row]) -> World:
    """The kept fields of rows, sorted by id."""
    return sorted(([getattr(row, name) for name in FIELDS] for row in rows), key=lambda r: str(r[0]))


class Found(NamedTuple):
    """Rows of worlds, and what is wrong with their verdicts."""

    rows: dict[str, World]
    misjudged: list[str]
    """Lines about broken worlds that are not found and sound ones that are refused."""


def rows_of_suite(check: str) -> Found:
    """Rows of the first hand-picked world of every mechanism of a suite, by mechanism."""
    suite, found = suite_of(check), Found({}, [])
    for mechanism in suite.mechanisms:
        verdict = judge_one(suite.check, mechanism, mechanism.hand_picked[0], SEED)
        found.rows[mechanism.name] = data_of(verdict.rows)
        if not (verdict.detected if mechanism.broken else not verdict.alarm):
            found.misjudged.append(
                f"{check}: {mechanism.name} is {'broken and not found' if mechanism.broken else 'sound and refused'}"
            )
    return found


def rows_of_worlds() -> Found:
    """Rows of the acceptance of every accepted world and every one that a skill records."""
    return Found({name: data_of(rejudge(name, spec).rows) for name, spec in (*specifications(), *recorded())}, [])


def _same(a: Any, b: Any) -> bool:
    if isinstance(a, float) and isinstance(b, float | int):
        return math.isclose(a, b, rel_tol=CLOSE, abs_tol=TINY) or (math.isnan(a) and math.isnan(b))
    return bool(a == b)


def _near(a: Any, b: Any, share: float, row: list[Any]) -> bool:
    bound = row[FIELDS.index("bound")]
    return all(isinstance(v, float) for v in (a, b, bound)) and abs(a - b) <= share * max(abs(bound), abs(b))


def _equal(one: list[Any], other: list[Any], fields: Iterable[int] = range(len(FIELDS))) -> bool:
    return all(_same(one[i], other[i]) for i in fields)


def differences(
    before: dict[str, World], now: dict[str, World], elsewhere: dict[str, World] | None = None, *, share: float = 0.0
) -> Iterator[str]:
    """Lines about worlds and rows that are gone, new or other.

    Args:
        before: recorded rows.
        now: present ones.
        elsewhere: rows as other processors measured them.
        share: of a row's bound by which its number may differ [1].
    """
    for world in sorted({*before, *now}):
        if world not in now or world not in before:
            yield f"{world}: {'gone' if world not in now else 'new'}"
            continue
        old, new = ({str(r[0]): r for r in side[world]} for side in (before, now))
        for row in sorted({*old, *new}):
            if row not in new or row not in old:
                yield f"{world}: {row} is {'gone' if row not in new else 'new'}"
                continue
            known = [k for k in (elsewhere or {}).get(world, ()) if _equal(k, old[row], JUDGED) and not _equal(k, old[row])]
            if any(_equal(k, new[row]) for k in known) or (len(known) >= NOISE and _equal(old[row], new[row], JUDGED)):
                continue
            for name, a, b in zip(FIELDS, old[row], new[row], strict=True):
                if not _same(a, b) and not (name == "measured" and _near(a, b, share, old[row])):
                    yield f"{world}: {row}: {name} was {a!r}, is {b!r}"


def compare(name: str, now: dict[str, World]) -> list[str]:
    """Lines about rows that differ from those kept under a name; none where all are equal."""
    path = GOLDEN / f"{name}.json"
    if not path.exists():
        return [f"{name}: nothing is recorded; run `python -m worldagent.bench.golden record`"]
    # Through JSON, as the recorded ones went.
    fresh = json.loads(json.dumps(now))
    return [
        f"{name}: {line}"
        for line in differences(json.loads(path.read_text()), fresh, _elsewhere(name), share=SHARE_OF_BOUND.get(name, 0.0))
    ]


def _elsewhere(name: str) -> dict[str, World]:
    path = PROCESSORS / f"{name}.json"
    found: dict[str, World] = json.loads(path.read_text()) if path.exists() else {}
    return found


def rounded_otherwise(name: str, now: dict[str, World]) -> dict[str, World]:
    """Recorded rows of other processors, and those of `now` that differ from all recorded ones in measured fields alone."""
    kept, known = json.loads((GOLDEN / f"{name}.json").read_text()), _elsewhere(name)
    for world, rows in now.items():
        old = {str(row[0]): row for row in kept.get(world, [])}
        known[world] = [row for row in known.get(world, []) if not _equal(row, old.get(str(row[0]), row))]
        for row in rows:
            same = old.get(str(row[0]))
            if same and _equal(same, row, JUDGED) and not any(_equal(one, row) for one in (same, *known.get(world, []))):
                known.setdefault(world, []).append(row)
    return {world: rows for world, rows in known.items() if rows}


def write(name: str, found: dict[str, World], folder: Path | None = None) -> None:
    """Keep the rows of a suite in `tests/golden`, or in another folder, one row a line."""
    folder = folder or GOLDEN
    folder.mkdir(parents=True, exist_ok=True)
    worlds = ",\n".join(
        f" {json.dumps(world)}: [\n" + ",\n".join(f"  {json.dumps(row)}" for row in rows) + "\n ]"
        for world, rows in found.items()
    )
    (folder / f"{name}.json").write_text(f"{{\n{worlds}\n}}\n")


def _judge(name: str) -> Found:
    return rows_of_worlds() if name == "worlds" else rows_of_suite(name)


def main(arguments: Sequence[str] | None = None) -> int:
    """The command; 0 where nothing differs and every world is judged rightly."""
    parser = argparse.ArgumentParser(prog="golden", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("record", "compare"))
    parser.add_argument("--only", action="append", choices=CHECKS, help="only this suite (repeatable)")
    parser.add_argument("--worlds", action="store_true", help="accepted and recorded worlds instead of the suites")
    parser.add_argument("--processor", action="store_true", help="record only rows that this processor rounds otherwise")
    options = parser.parse_args(arguments)
    names = ["worlds"] if options.worlds else list(options.only or CHECKS)
    wrong = 0
    with ProcessPoolExecutor(min(core_count(), len(names)), mp_context=get_context("spawn")) as pool:
        for name, (found, misjudged) in zip(names, pool.map(_judge, names), strict=True):
            wrong += len(misjudged)
            for line in misjudged:
                print(line, flush=True)
            if options.what == "record" and options.processor:
                if others := rounded_otherwise(name, json.loads(json.dumps(found))):
                    write(name, others, PROCESSORS)
                    print(f"{name}: {sum(map(len, others.values()))} rows are other on other processors", flush=True)
            elif options.what == "record":
                write(name, found)
                print(f"{name}: {sum(map(len, found.values()))} rows of {len(found)} worlds", flush=True)
            else:
                lines = compare(name, found)
                wrong += len(lines)
                print("\n".join(lines) if lines else f"{name}: {sum(map(len, found.values()))} rows are equal", flush=True)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
