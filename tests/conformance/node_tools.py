"""The official conformance suite and the Inspector: exact versions, installed from npm into an ignored folder."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

__all__ = ["FOLDER", "Missing", "conformance", "inspector", "install"]

FOLDER = Path(__file__).resolve().parents[2] / ".conformance"
PACKAGES = {
    "node": "22.23.3",
    "@modelcontextprotocol/conformance": "0.2.0-alpha.12",
    "@modelcontextprotocol/inspector": "2.12.0",
}
"""Both tools need Node 22, whatever the system has."""
_MODULES = FOLDER / "node_modules"
_NODE = _MODULES / "node" / "bin" / "node"


class Missing(Exception):
    """The tools cannot be had here; the text says why."""


def install() -> None:
    """Install what is not there in its version.

    Raises:
        Missing: There is no npm, or it could not install.
    """
    if all(_version(name) == version for name, version in PACKAGES.items()) and _NODE.is_file():
        return
    npm = shutil.which("npm")
    if npm is None:
        raise Missing("npm is not installed: the conformance suite and the Inspector come from npm")
    FOLDER.mkdir(exist_ok=True)
    (FOLDER / "package.json").write_text('{"private": true}\n')
    wanted = [f"{name}@{version}" for name, version in PACKAGES.items()]
    options = ["--no-save", "--no-package-lock", "--no-audit", "--no-fund", "--loglevel=error"]
    done = subprocess.run(
        [npm, "install", *options, *wanted], cwd=FOLDER, capture_output=True, text=True, timeout=600, check=False
    )
    if done.returncode != 0:
        raise Missing(f"npm could not install {', '.join(wanted)}: {done.stderr.strip()[-600:]}")
    if not _NODE.is_file():
        raise Missing(f"npm installed no node binary at {_NODE}; are install scripts switched off?")


def conformance(*arguments: str) -> list[str]:
    """Command line of the conformance suite."""
    return [str(_NODE), str(_MODULES / "@modelcontextprotocol/conformance/dist/index.js"), *arguments]


def inspector(*arguments: str) -> list[str]:
    """Command line of the Inspector."""
    return [str(_NODE), str(_MODULES / "@modelcontextprotocol/inspector/clients/launcher/build/index.js"), "--cli", *arguments]


def _version(name: str) -> str | None:
    described = _MODULES / name / "package.json"
    return str(json.loads(described.read_text())["version"]) if described.is_file() else None
