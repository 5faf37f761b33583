"""A wheel holds every package of the product, and the data that its packages read; every extra that documents name is one."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
LEFT_OUT = {"bench/evaluation/drafts", "bench/evaluation/solutions"}
"""Folders whose files no installed program reads: worlds that no agent under evaluation may see."""


def settings() -> dict[str, Any]:
    found: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["setuptools"]
    return found


def files(pattern: str) -> list[Path]:
    """Files of the tree, new ones that are not yet tracked included."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard", pattern]
    names = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()
    return [Path(name) for name in names if (ROOT / name).exists()]


def test_every_package_of_the_tree_is_in_the_wheel() -> None:
    there = {".".join(("worldagent", *p.parent.parts)) for p in files("*__init__.py") if p.parts[0] != "tests"}
    listed = settings()["packages"]
    assert sorted(there - set(listed)) == []
    assert sorted(set(listed) - there) == []
    assert len(listed) == len(set(listed))


def test_every_module_lies_in_a_package() -> None:
    products = {name.split(".")[1] for name in settings()["packages"] if "." in name}
    modules = [p for p in files("*.py") if p.parts[0] in products]
    assert len(modules) > 1000
    assert [str(p) for p in modules if not (ROOT / p.parent / "__init__.py").exists()] == []


def test_data_of_packages_is_in_the_wheel() -> None:
    globs = settings()["package-data"]["worldagent"]
    held = {p.relative_to(ROOT) for pattern in globs for p in ROOT.glob(pattern)}
    products = {name.split(".")[1] for name in settings()["packages"] if "." in name}
    data = [p for p in files("*") if p.parts[0] in products and p.suffix not in (".py", ".md")]
    lost = [p for p in data if p not in held and not any(str(p).startswith(f"{out}/") for out in LEFT_OUT)]
    assert len(data) > 50
    assert [str(p) for p in lost] == []


def project() -> dict[str, Any]:
    found: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return found


def test_every_extra_that_is_told_to_install_exists() -> None:
    told = {name for p in files("*.md") + files("*.py") for name in re.findall(r"worldagent\[(\w+)\]", (ROOT / p).read_text())}
    assert {"eval", "metrics", "review"} <= told
    assert sorted(told - set(project()["optional-dependencies"])) == []


def test_readers_need_nothing_but_the_standard_library_and_the_extra_says_so() -> None:
    assert project()["optional-dependencies"]["review"] == []
    needed = {re.split(r"[<>=!~\[ ]", line)[0].lower().replace("-", "_") for line in project()["dependencies"]}
    modules = [p for p in files("*.py") if p.parts[:2] == ("workflow", "review")]
    assert len(modules) > 5
    for module in modules:
        for node in ast.walk(ast.parse((ROOT / module).read_text(encoding="utf-8"))):
            names = [a.name for a in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) and node.level == 0 else []
            others = {n.partition(".")[0].lower() for n in names} - sys.stdlib_module_names
            assert others <= needed, module
