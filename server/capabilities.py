"""What this installation can do: engines and versions, categories of physics, renderer, caps."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from .. import __version__
from ..worlds.errors import EngineError
from ..worlds.limits import CAPS

__all__ = ["CATEGORIES", "PACKAGES", "capabilities", "package_version"]

CATEGORIES: dict[str, dict[str, Any]] = {
    "rigid": {"available": True, "engine": "mujoco", "covers": "rigid bodies, joints, ropes of links, drivers"},
    "elastic": {"available": False},
    "cloth": {"available": False},
    "liquid": {"available": False},
    "gas": {"available": False},
    "particles": {"available": False},
}
"""Categories of physics a specification can name; one that is not available is refused before a probe."""

PACKAGES = (
    "mcp", "pydantic", "numpy", "scipy", "mujoco", "warp-lang", "trimesh", "python-fcl", "coacd", "mitsuba", "drjit", "pyoidn",
    "opencv-python-headless", "jsonpatch", "rfc8785", "uvicorn",
)  # fmt: skip
"""Distributions that the server is built on."""


def package_version(name: str) -> str | None:
    """Version of an installed distribution, without importing it."""
    try:
        return version(name)
    except PackageNotFoundError:
        return None


def capabilities() -> dict[str, Any]:
    """Everything a client should know before it writes a specification; proves the renderer's variant on first use."""
    return {
        "worldagent": __version__,
        "python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}",
        "categories": CATEGORIES,
        "renderer": _renderer(),
        "caps": {cap.name: {"value": cap.value, "unit": cap.unit, "knob": cap.knob} for cap in CAPS.values()},
        "versions": {name: package_version(name) for name in PACKAGES},
    }


def _renderer() -> dict[str, Any]:
    from ..rendering.variant import choose_variant

    try:
        chosen = choose_variant()
    except EngineError as error:
        return {"engine": "mitsuba", "variant": None, "why": str(error)}
    return {"engine": "mitsuba", "variant": chosen.name, "why": chosen.why}
