"""`python -m worldagent.tests.physics.liquid_cases [case ...] [--engine dfsph] [--level 0]`: measured against gates."""

from __future__ import annotations

import argparse
import sys

from .table import CASES, rows


def main() -> None:
    """Print the table of the cases asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("cases", nargs="*", help=f"of {', '.join(CASES)}; all by default; a prefix names several")
    parser.add_argument("--engine", action="append", choices=("dfsph", "flip"))
    parser.add_argument("--level", action="append", type=int, choices=(0, 1), help="0 coarse (default), 1 fine")
    told = parser.parse_args()
    names = [n for n in CASES if not told.cases or any(n == c or n.startswith(c) for c in told.cases)]
    for line in rows(names, told.engine or ("dfsph", "flip"), told.level or (0,)):
        sys.stdout.write(line + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
