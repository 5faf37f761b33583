"""Measures of the code that `test_habits.py` holds to ceilings."""

from __future__ import annotations

import ast
import functools
import itertools
import subprocess
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PRODUCT = (
    "physics",
    "worlds",
    "execution",
    "geometry",
    "construction",
    "simulation",
    "verifiers",
    "rendering",
    "workflow",
    "tools",
    "server",
)
"""Folders that the ceilings hold for; benchmarks, examples and test worlds are data more than code."""
WRITTEN = (*PRODUCT, "testing", "bench", "examples", "packaging", "docs", "skills", "tests")
"""Folders whose docstrings are measured."""
RIDDLES = ("What ", "Whether ", "How ", "Of ")
"""Beginnings of docstrings that name no thing."""
MODULE, FUNCTION, PARAMETERS = 400, 60, 8
"""Lines of a module, lines of a function, parameters of a function."""

Function = ast.FunctionDef | ast.AsyncFunctionDef


@functools.cache
def modules(folders: tuple[str, ...] = PRODUCT) -> dict[str, ast.Module]:
    """Syntax tree by path of every tracked module in some folders."""
    tracked = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard", "--", *(f"{p}/*.py" for p in folders)],
        cwd=ROOT, capture_output=True, text=True, check=False,
    ).stdout.split()  # fmt: skip
    found = tracked or [p.relative_to(ROOT).as_posix() for name in folders for p in (ROOT / name).rglob("*.py")]
    return {p: ast.parse((ROOT / p).read_text()) for p in sorted(found) if (ROOT / p).exists()}


def is_kernel(path: str) -> bool:
    """Kernels are exempt: what they call is inlined, and they take their arrays one by one."""
    return path.endswith("kernels.py")


def functions(tree: ast.Module) -> Iterator[Function]:
    """All functions and methods of a module."""
    return (n for n in ast.walk(tree) if isinstance(n, Function))


def parameter_count(function: Function) -> int:
    """Parameters of a function; `self` and `cls` are none."""
    given = [*function.args.posonlyargs, *function.args.args]
    bound = bool(given) and given[0].arg in ("self", "cls")
    return len(given) - bound + len(function.args.kwonlyargs)


def over_ceiling() -> dict[str, list[str]]:
    """By measure: `path` or `path::function` of all that is over its ceiling."""
    found: dict[str, list[str]] = defaultdict(list)
    for path, tree in modules().items():
        if (ROOT / path).read_text().count("\n") > MODULE:
            found["module"].append(path)
        for function in () if is_kernel(path) else functions(tree):
            if (function.end_lineno or 0) - function.lineno + 1 > FUNCTION:
                found["function"].append(f"{path}::{function.name}")
            if parameter_count(function) > PARAMETERS:
                found["parameters"].append(f"{path}::{function.name}")
    return {kind: sorted(set(names)) for kind, names in found.items()}


def docstrings(tree: ast.Module) -> Iterator[tuple[str, str]]:
    """Name and docstring of a module (named ""), its classes and functions, and of all assignments that a string follows."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | Function) and (text := ast.get_docstring(node)):
            yield getattr(node, "name", ""), text
        body = getattr(node, "body", None)
        for first, second in itertools.pairwise(body if isinstance(body, list) else ()):
            if (
                isinstance(first, ast.Assign | ast.AnnAssign)
                and isinstance(second, ast.Expr)
                and isinstance(second.value, ast.Constant)
            ):
                target = first.targets[0] if isinstance(first, ast.Assign) else first.target
                yield ast.unparse(target), str(second.value.value).strip()


def riddles() -> list[str]:
    """`path::name` of every docstring with one of the beginnings `RIDDLES`, tests and attributes included."""
    return sorted(
        f"{path}::{name}"
        for path, tree in modules(WRITTEN).items()
        for name, text in docstrings(tree)
        if text.startswith(RIDDLES)
    )


def imports(*, loaded: bool = False) -> dict[str, set[str]]:
    """Modules that each module imports, lazily and under TYPE_CHECKING too; `loaded`: those that run when it is imported first.

    Of those, the packages around what a module imports are some: their `__init__` runs before.
    """
    trees = modules()
    names = {path.removesuffix(".py").removesuffix("/__init__").replace("/", "."): path for path in trees}
    found: dict[str, set[str]] = {name: set() for name in names}
    for name, path in names.items():
        package = name if path.endswith("__init__.py") else name.rpartition(".")[0]
        for node in trees[path].body if loaded else ast.walk(trees[path]):
            if not isinstance(node, ast.ImportFrom) or not node.level:
                continue
            parts = package.split(".")
            base = ".".join([*parts[: len(parts) - node.level + 1], *([node.module] if node.module else [])])
            for alias in node.names:
                target = f"{base}.{alias.name}".lstrip(".")
                target = target if target in names else base
                if target in names and target != name:
                    found[name].add(target)
                    found[name] |= set(_around(target, name) if loaded else ()) & names.keys()
    return found


def _around(target: str, name: str) -> list[str]:
    """Packages around a module that are not around another one."""
    parts = target.split(".")
    packages = [".".join(parts[:k]) for k in range(1, len(parts))]
    return [p for p in packages if not f"{name}.".startswith(f"{p}.")]


def cycles(*, loaded: bool = False) -> list[list[str]]:
    """Groups of modules that import each other, each sorted (Tarjan 1972, without recursion); `loaded` as of `imports`."""
    graph, order, low, stack, on, out = imports(loaded=loaded), {}, {}, [], set(), []  # type: ignore[var-annotated]
    for root in sorted(graph):
        if root in order:
            continue
        work = [(root, iter(sorted(graph[root])))]
        order[root] = low[root] = len(order)
        stack.append(root)
        on.add(root)
        while work:
            node, rest = work[-1]
            following = next((n for n in rest if n not in order or n in on), None)
            if following is None:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[node])
                if low[node] == order[node]:
                    at = stack.index(node)
                    group = stack[at:]
                    del stack[at:]
                    on -= set(group)
                    if len(group) > 1:
                        out.append(sorted(group))
            elif following in on:
                low[node] = min(low[node], order[following])
            else:
                order[following] = low[following] = len(order)
                stack.append(following)
                on.add(following)
                work.append((following, iter(sorted(graph[following]))))
    return sorted(out)
