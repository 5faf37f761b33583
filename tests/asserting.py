"""Finds tests that can pass without having asserted anything, by reading their source.

A function asserts surely when an assertion stands where no data decides whether it is reached: not inside an `if`, not after an early
`return` or `continue`, not in a loop over what may be empty, and when what it claims does not hold of nothing (`all(...)` over what may be
empty, `x or True`, a tuple). A call of a function that asserts surely is an assertion too, wherever in the tests it is defined.
"""

from __future__ import annotations

import ast
from functools import cached_property
from pathlib import Path

__all__ = ["Sources", "unsure_tests"]

RAISING = frozenset({"raises", "warns", "deprecated_call"})
"""Functions of pytest whose block fails if it does not raise or warn."""
FAILING = frozenset({"fail", "AssertionError"})
"""Calls at the end of an `if` that is an assertion in other words."""
ENDING = frozenset({"fail", "skip", "xfail"})
"""Functions of pytest that end a test which has not passed."""
SAME_LENGTH = frozenset(
    {"enumerate", "sorted", "reversed", "list", "tuple", "set", "items", "keys", "values", "dict", "array", "asarray"}
)
"""Functions and methods whose result has elements when the argument has."""


Function = ast.FunctionDef | ast.AsyncFunctionDef
Inner = dict[str, Function]
"""Functions defined inside another one, by name."""


def _called(node: ast.expr) -> str:
    """The last name of what is called: `raises` of `pytest.raises`."""
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""


def _ends(statement: ast.stmt) -> bool | None:
    """True if a path that ends in a statement has failed or been skipped, for all to see; None if it does not end there."""
    if isinstance(statement, ast.Raise):
        return True
    if isinstance(statement, ast.Return | ast.Continue | ast.Break):
        return False
    value = statement.value if isinstance(statement, ast.Expr) else None
    return True if isinstance(value, ast.Call) and _called(value.func) in ENDING else None


class Module:
    """One source file: its functions, what it imports, and the constants that have elements."""

    def __init__(self, path: Path, sources: Sources) -> None:
        self.path, self.sources = path, sources
        self.tree = ast.parse(path.read_text())
        self.imported: dict[str, tuple[str, str]] = {}
        self.full: set[str] = set()
        self.functions: dict[str, ast.FunctionDef | ast.AsyncFunctionDef] = {}
        self.verdicts: dict[str, bool] = {}
        for node in self.tree.body:
            self._read(node)

    def _read(self, node: ast.stmt) -> None:
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            self.functions[node.name] = node
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            self.imported |= {a.asname or a.name: (node.module, a.name) for a in node.names}
        elif isinstance(node, ast.Assign) and self.has_elements(node.value, self.full):
            self.full |= {t.id for t in node.targets if isinstance(t, ast.Name)}
        elif isinstance(node, ast.AnnAssign) and node.value is not None and self.has_elements(node.value, self.full):
            self.full |= {node.target.id} if isinstance(node.target, ast.Name) else set()

    def asserts(self, name: str) -> bool:
        """True if calling the function of this name asserts surely; a name that is no function of the tests does not."""
        if name in self.verdicts:
            return self.verdicts[name]
        self.verdicts[name] = False  # of a function that calls itself
        if name in self.functions:
            function = self.functions[name]
            self.verdicts[name] = self.sure(function.body, self.full | self._parametrised(function), {})
        elif name in self.imported:
            module, original = self.imported[name]
            source = self.sources.module(module)
            self.verdicts[name] = source is not None and source.asserts(original)
        return self.verdicts[name]

    def is_full(self, name: str) -> bool:
        """True if a name that this module imports is a constant with elements."""
        module, original = self.imported.get(name, ("", ""))
        source = self.sources.module(module)
        return source is not None and (original in source.full or source.is_full(original))

    def _parametrised(self, function: ast.FunctionDef | ast.AsyncFunctionDef) -> set[str]:
        """Arguments whose every value, by `pytest.mark.parametrize`, is a literal with elements."""
        found: set[str] = set()
        for decorator in function.decorator_list:
            if not (isinstance(decorator, ast.Call) and _called(decorator.func) == "parametrize" and len(decorator.args) > 1):
                continue
            first = decorator.args[0]
            names = str(first.value).replace(" ", "").split(",") if isinstance(first, ast.Constant) else []
            rows = decorator.args[1].elts if isinstance(decorator.args[1], ast.List | ast.Tuple) else []
            for index, name in enumerate(names):
                cells = [r.elts[index] if len(names) > 1 and isinstance(r, ast.Tuple) else r for r in rows]
                if cells and all(self.has_elements(c, self.full) for c in cells):
                    found.add(name)
        return found

    def sure(self, body: list[ast.stmt], full: set[str], inner: Inner) -> bool:
        """True if a block asserts surely. `full`: names with elements; `inner`: functions defined around it, by name."""
        full, inner = set(full), dict(inner)
        for index, statement in enumerate(body):
            if isinstance(statement, ast.FunctionDef | ast.AsyncFunctionDef):
                inner[statement.name] = statement
                continue
            if self._asserts(statement, full, inner):
                return True
            rest = body[index + 1 :]
            if isinstance(statement, ast.If):
                return self.sure(statement.body + rest, full, inner) and self.sure(statement.orelse + rest, full, inner)
            if isinstance(statement, ast.Try):
                ways = [[*statement.body, *statement.orelse], *(h.body for h in statement.handlers)]
                return all(self.sure([*way, *statement.finalbody, *rest], full, inner) for way in ways)
            if _ends(statement) is not None:
                return bool(_ends(statement))
            if isinstance(statement, ast.For | ast.While | ast.With) and any(
                isinstance(n, ast.Return) for n in ast.walk(statement)
            ):
                return False
            if isinstance(statement, ast.Assign) and self.has_elements(statement.value, full):
                full |= {t.id for t in statement.targets if isinstance(t, ast.Name)}
        return False

    def _asserts(self, node: ast.stmt, full: set[str], inner: Inner) -> bool:
        """True if one statement asserts surely."""
        if isinstance(node, ast.Assert):
            return not self._holds_of_nothing(node.test, full) or self._calls(node.test, full, inner)
        if isinstance(node, ast.With | ast.AsyncWith):
            heads = [i.context_expr for i in node.items]
            names = {_called(h.func) for h in heads if isinstance(h, ast.Call)}
            if names & RAISING or any(self._calls(h, full, inner) for h in heads):
                return True
            return "suppress" not in names and self.sure(node.body, full, inner)
        if isinstance(node, ast.For | ast.AsyncFor):
            if self._calls(node.iter, full, inner):
                return True
            return self.has_elements(node.iter, full) and self.sure(node.body, full, inner)
        if isinstance(node, ast.If):
            last = node.body[-1]
            raised = last.exc if isinstance(last, ast.Raise) else last.value if isinstance(last, ast.Expr) else None
            failing = isinstance(raised, ast.Call) and _called(raised.func) in FAILING
            return failing or self._calls(node.test, full, inner)
        if isinstance(node, ast.While):
            return isinstance(node.test, ast.Constant) and self.sure(node.body, full, inner)
        return not isinstance(node, ast.Try) and self._calls(node, full, inner)

    def _calls(self, node: ast.AST, full: set[str], inner: Inner) -> bool:
        """True if an expression calls, or hands on, a function that asserts surely."""
        for part in ast.walk(node):
            if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Load):
                if part.id in inner:
                    if self.sure(inner[part.id].body, full, {k: v for k, v in inner.items() if k != part.id}):
                        return True
                elif self.asserts(part.id):
                    return True
            elif isinstance(part, ast.Attribute) and isinstance(part.value, ast.Name) and part.value.id in self.imported:
                module, name = self.imported[part.value.id]
                source = self.sources.module(f"{module}.{name}")
                if source is not None and source.asserts(part.attr):
                    return True
            elif isinstance(part, ast.Call) and (_called(part.func).startswith("assert_") or _called(part.func) in RAISING):
                return True
        return False

    def has_elements(self, node: ast.expr, full: set[str]) -> bool:
        """True if a collection surely has elements, as its expression says."""
        if isinstance(node, ast.List | ast.Tuple | ast.Set):
            return any(not isinstance(e, ast.Starred) or self.has_elements(e.value, full) for e in node.elts)
        if isinstance(node, ast.Dict):
            return any(k is not None or self.has_elements(v, full) for k, v in zip(node.keys, node.values, strict=True))
        if isinstance(node, ast.Constant):
            return isinstance(node.value, str | bytes) and bool(node.value)
        if isinstance(node, ast.Name):
            return node.id in full or self.is_full(node.id)
        if isinstance(node, ast.ListComp | ast.SetComp | ast.GeneratorExp | ast.DictComp):
            return all(self.has_elements(g.iter, full) and not g.ifs for g in node.generators)
        if isinstance(node, ast.BinOp):
            sides = self.has_elements(node.left, full), self.has_elements(node.right, full)
            return any(sides) if isinstance(node.op, ast.Add | ast.BitOr) else sides[0] and isinstance(node.op, ast.Mult)
        return isinstance(node, ast.Call) and self._yields(node, full)

    def _yields(self, node: ast.Call, full: set[str]) -> bool:
        """True if the result of a call surely has elements."""
        name = _called(node.func)
        if any(k.arg in ("size", "shape") and isinstance(k.value, ast.Constant | ast.Tuple) for k in node.keywords):
            return True
        if name == "range":
            if len(node.args) == 1 and isinstance(node.args[0], ast.Call) and _called(node.args[0].func) == "len":
                return self.has_elements(node.args[0].args[0], full)
            bounds = [a.value for a in node.args if isinstance(a, ast.Constant) and isinstance(a.value, int)]
            return len(bounds) == len(node.args) and len(range(*bounds)) > 0
        if name in ("linspace", "logspace", "geomspace", "eye", "split"):
            return True
        if name == "arange":
            return all(isinstance(a, ast.Constant) for a in node.args)
        if name in ("zip", "product", "chain"):
            each = [self.has_elements(a, full) for a in node.args]
            strict = any(k.arg == "strict" and isinstance(k.value, ast.Constant) and k.value.value is True for k in node.keywords)
            return bool(each) and (any(each) if name == "chain" or (name == "zip" and strict) else all(each))
        if name == "get_args":
            return True
        if name in SAME_LENGTH:
            of = node.args[0] if node.args else node.func.value if isinstance(node.func, ast.Attribute) else None
            return of is not None and self.has_elements(of, full)
        return False

    def _holds_of_nothing(self, test: ast.expr, full: set[str]) -> bool:
        """True if a claim holds whatever the data, or of a collection without elements."""
        if isinstance(test, ast.Constant):
            return bool(test.value)
        if isinstance(test, ast.Tuple):
            return bool(test.elts)
        if isinstance(test, ast.BoolOp):
            each = [self._holds_of_nothing(v, full) for v in test.values]
            return any(each) if isinstance(test.op, ast.Or) else all(each)
        if isinstance(test, ast.Call) and isinstance(test.func, ast.Name) and test.func.id == "all" and len(test.args) == 1:
            return isinstance(test.args[0], ast.GeneratorExp | ast.ListComp) and not self.has_elements(test.args[0], full)
        if isinstance(test, ast.Compare) and len(test.ops) == 1:
            if isinstance(test.ops[0], ast.LtE) and isinstance(test.left, ast.SetComp):
                return not self.has_elements(test.left, full)
            again = isinstance(test.ops[0], ast.Eq) and ast.dump(test.left) == ast.dump(test.comparators[0])
            return again and not any(isinstance(n, ast.Call) for n in ast.walk(test))  # the same call twice asks for determinism
        return False

    @cached_property
    def unsure(self) -> list[str]:
        """Names of the tests of this file that can pass without having asserted."""
        found = [n for n in self.functions if n.startswith("test_") and not self.asserts(n)]
        for node in self.tree.body:
            if isinstance(node, ast.ClassDef) and node.name.startswith("Test"):
                methods = [
                    m for m in node.body if isinstance(m, ast.FunctionDef | ast.AsyncFunctionDef) and m.name.startswith("test_")
                ]
                found += [f"{node.name}.{m.name}" for m in methods if not self.sure(m.body, self.full, {})]
        return found


class Sources:
    """The source files below a root, read once each, by the name that a test imports."""

    def __init__(self, root: Path, package: str = "worldagent") -> None:
        self.root, self.package = root, package
        self.known: dict[str, Module | None] = {}

    def module(self, name: str) -> Module | None:
        """The module of a dotted name, if it is a helper of the tests: in `tests/` or in `bench/`, where small worlds are made."""
        if name not in self.known:
            parts = name.split(".")
            path = self.root.joinpath(*parts[1:]).with_suffix(".py")
            inside = parts[0] == self.package and parts[1:2] in (["tests"], ["bench"]) and path.is_file()
            self.known[name] = Module(path, self) if inside else None
        return self.known[name]


def unsure_tests(root: Path) -> list[str]:
    """`path::name` of every test below `root/tests` that can pass without having asserted anything."""
    sources = Sources(root)
    found = []
    for path in sorted((root / "tests").rglob("test_*.py")):
        parts = path.relative_to(root).with_suffix("").parts
        module = sources.module(".".join((sources.package, *parts)))
        found += [f"{path.relative_to(root)}::{n}" for n in module.unsure] if module is not None else []
    return found
