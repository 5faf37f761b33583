"""Make the two bundles for hosts that install `.mcpb` files: `python packaging/build_mcpb.py WHEEL OUT`.

`worldagent.mcpb` holds the wheel and has the host make an environment for it; `worldagent-installed.mcpb` starts an
installation. Both are packed by the official tool (`npx @anthropic-ai/mcpb`), which checks the manifests first.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

MCPB = "@anthropic-ai/mcpb@2.1.2"
HERE = Path(__file__).resolve().parent
SOURCE = HERE.parent
BUNDLES = {"worldagent": "mcpb", "worldagent-installed": "mcpb-installed"}


def environment_of(wheel: Path, constraints: str) -> str:
    """`pyproject.toml` of the bundle: the wheel beside it, and every library in the version that was tested."""
    version = wheel.name.split("-")[1]
    pins = [line.strip() for line in constraints.splitlines() if "==" in line]
    return "\n".join(
        [
            "[project]",
            'name = "worldagent-bundle"',
            f'version = "{version}"',
            'requires-python = ">=3.11"',
            f'dependencies = ["worldagent=={version}"]',
            "",
            "[tool.uv]",
            "package = false",
            f"constraint-dependencies = {json.dumps(pins)}",
            "",
            "[tool.uv.sources]",
            f'worldagent = {{ path = "{wheel.name}" }}',
            "",
        ]
    )


def stage(wheel: Path, folder: Path) -> dict[str, Path]:
    """The folders that are packed, by the name of their bundle."""
    staged = {}
    for name, source in BUNDLES.items():
        staged[name] = folder / name
        shutil.copytree(HERE / source, staged[name], ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(wheel, staged["worldagent"])
    (staged["worldagent"] / "pyproject.toml").write_text(environment_of(wheel, (SOURCE / "constraints.txt").read_text()))
    return staged


def main(wheel: Path, out: Path) -> int:
    """Pack both bundles; the exit code of the tool."""
    packer = packing_tool()
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        for name, staged in stage(wheel, Path(folder)).items():
            subprocess.run([*packer, "validate", str(staged / "manifest.json")], check=True)
            subprocess.run([*packer, "pack", str(staged), str((out / f"{name}.mcpb").resolve())], check=True)
    return 0


def packing_tool() -> list[str]:
    """The packing tool: `$MCPB` where it is installed already, otherwise through npx."""
    named = os.environ.get("MCPB")
    return [named] if named else ["npx", "--yes", MCPB]


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2])))
