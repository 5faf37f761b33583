"""Write the table of `docs/platforms.md` from the wheels that exist: `python docs/generate_platforms.py`.

It asks uv (`pip install uv`) to resolve the package's dependencies for each system and Python without building
anything, drops what has no wheel, and asks again, until it knows everything that is missing.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGE = Path(__file__).with_name("platforms.md")
BEGIN, END = "<!-- wheels -->\n", "<!-- /wheels -->\n"
PYTHONS = ("3.11", "3.12", "3.13", "3.14")
SYSTEMS = {
    "Linux x86-64 (glibc 2.34 or newer)": "x86_64-manylinux_2_34",
    "Linux arm64 (glibc 2.34 or newer)": "aarch64-manylinux_2_34",
    "Linux x86-64 (musl, Alpine)": "x86_64-unknown-linux-musl",
    "macOS Apple silicon": "aarch64-apple-darwin",
    "macOS Intel": "x86_64-apple-darwin",
    "Windows x86-64": "x86_64-pc-windows-msvc",
    "Windows arm64": "aarch64-pc-windows-msvc",
}


def missing(system: str, python: str, requirements: list[str]) -> list[str]:
    """Distributions without a wheel there, in the order they were found.

    Raises:
        RuntimeError: uv failed for another reason.
    """
    uv = shutil.which("uv")
    if uv is None:
        raise RuntimeError("uv is not on the PATH: pip install uv")
    left, found = list(requirements), []
    for _ in range(len(requirements)):
        with tempfile.TemporaryDirectory() as folder:
            asked = Path(folder) / "requirements.in"
            asked.write_text("\n".join(left))
            command = [uv, "pip", "compile", "--quiet", "--no-build", "--python-platform", system, "--python-version", python]
            child = subprocess.run(
                [*command, "--constraint", str(ROOT / "constraints.txt"), str(asked)], capture_output=True, text=True, check=False
            )
        if child.returncode == 0:
            return found
        named = re.findall(r"([A-Za-z0-9_.-]+)==[^ ]+ has no (?:usable )?wheels", child.stderr)
        if not named:
            raise RuntimeError(child.stderr)
        found.append(named[0])
        kept = [line for line in left if re.split(r"[<>=!~\[ ]", line)[0].lower().replace("_", "-") != named[0]]
        if kept == left:  # a dependency of a dependency: whoever needs it is what can't be installed
            blamed = re.findall(r"([A-Za-z0-9_.-]+)(?:[=<>]+[^ ]+)? depends on", child.stderr)
            kept = [line for line in left if not any(line.lower().startswith(name.lower()) for name in blamed)]
            if kept == left:
                raise RuntimeError(child.stderr)
        left = kept
    return found


def table() -> str:
    """Rows of systems, columns of Pythons."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    rows = [f"| system | {' | '.join(PYTHONS)} |", f"|---|{'---|' * len(PYTHONS)}"]
    for name, system in SYSTEMS.items():
        cells = []
        for python in PYTHONS:
            lacking = missing(system, python, project["dependencies"])
            cells.append("all" if not lacking else "no " + ", ".join(lacking))
        rows.append(f"| {name} | {' | '.join(cells)} |")
    date = time.strftime("%Y-%m-%d")
    return "\n".join(
        [f"worldagent {project.get('version', '')}".strip() + f", versions of constraints.txt, {date}:", "", *rows, ""]
    )


def main() -> int:
    """Replace the table of the page."""
    made = table()
    text = PAGE.read_text(encoding="utf-8")
    before, _, rest = text.partition(BEGIN)
    _, _, after = rest.partition(END)
    PAGE.write_text(f"{before}{BEGIN}{made}{END}{after}", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
