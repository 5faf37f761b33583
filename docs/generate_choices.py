"""Write the named bounds of the checks into `docs/choices.md`: `python docs/generate_choices.py`. A test fails while they are stale.

The bounds are read from the source of every `verifiers/**/bounds.py`: constants, each with a docstring `[unit] reason or source`.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

PAGE = Path(__file__).with_name("choices.md")
VERIFIERS = PAGE.parents[1] / "verifiers"
MARK = "<!-- written by generate_choices.py from here on -->"
HEAD = """
## Named bounds of the checks

Fields of the specification are changed per world; these are the same for every world, and changed in the module that the heading names.
"""
DOCSTRING = re.compile(r"\[([^\]]+)\]\s+(\S.*)", re.DOTALL)


class Bound(NamedTuple):
    """A named bound."""

    name: str
    value: str
    unit: str
    reason: str


def tables() -> list[Path]:
    """Modules that hold named bounds."""
    return sorted(VERIFIERS.rglob("bounds.py"))


def bounds_of(module: Path) -> Iterator[Bound]:
    """Named bounds of a module, in the order of its source.

    Raises:
        ValueError: it holds something else, or a bound lacks its unit or reason.
    """
    lines = iter(ast.parse(module.read_text()).body[1:])
    for line in lines:
        match line, next(lines, None):
            case (
                ast.Assign(targets=[ast.Name(id=name)], value=value),
                ast.Expr(value=ast.Constant(value=str(text))),
            ) if found := DOCSTRING.fullmatch(text):
                yield Bound(name, ast.unparse(value), found[1], " ".join(found[2].split()))
            case _:
                raise ValueError(f"{module}:{line.lineno}: a bound is a constant with a docstring '[unit] reason or source'")


def page() -> str:
    """The whole page: the part written by hand as it is, then the tables."""
    by_hand = PAGE.read_text().partition(MARK)[0].rstrip()
    return "\n".join([by_hand, "", MARK, HEAD, *(_section(module) for module in tables())])


def _section(module: Path) -> str:
    title = ast.get_docstring(ast.parse(module.read_text())) or ""
    where = module.relative_to(VERIFIERS.parent).as_posix()
    head = [f"### `{where}`", "", title, "", "| bound | value | unit | reason |", "|---|---|---|---|"]
    lines = ["| " + " | ".join(c.replace("|", "\\|") for c in (f"`{b.name}`", *b[1:])) + " |" for b in bounds_of(module)]
    return "\n".join([*head, *lines, ""])


if __name__ == "__main__":
    PAGE.write_text(page())
    sys.stderr.write(f"{PAGE.name} written\n")
