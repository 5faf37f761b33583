"""Capabilities of this installation: engines and versions, categories of physics, renderer, caps."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from .. import __version__
from ..worlds.errors import EngineError
from ..worlds.foreign import MOST_ENTRIES
from ..worlds.limits import CAPS, Cap

__all__ = ["PACKAGES", "all_caps", "capabilities", "categories", "package_version"]

PACKAGES = (
    "mcp", "pydantic", "numpy", "scipy", "mujoco", "warp-lang", "trimesh", "python-fcl", "coacd", "mitsuba", "drjit", "pyoidn",
    "opencv-python-headless", "jsonpatch", "regex", "rfc8785", "uvicorn",
)  # fmt: skip
"""Distributions that the server is built on."""


def package_version(name: str) -> str | None:
    """Version of an installed distribution, without importing it."""
    try:
        return version(name)
    except PackageNotFoundError:
        return None


def categories() -> dict[str, dict[str, Any]]:
    """Categories of physics a specification can name; one that is not available is refused before a probe."""
    from ..worlds.categories.registry import CATEGORIES

    found: dict[str, dict[str, Any]] = {}
    instances = [instance for category in CATEGORIES.values() for instance in category.instances]
    for name, category in CATEGORIES.items():
        engines = [i.engine_name() for i in instances if name in i.moves]
        if category.physics is not None:
            told = {"engine": ", ".join(engines), "covers": category.covers} if engines else {}
            found[name] = {"available": bool(engines), **told}
    return found


def all_caps() -> list[Cap]:
    """Every declared cap: of worlds, of the queue of jobs, of messages and connections."""
    from ..execution.queue import QUEUED_PER_WORKSPACE, QUEUED_PER_WORLD
    from .connections import MOST_CONNECTIONS
    from .limits import MAX_FILE_BYTES, MAX_SESSIONS
    from .messages import MESSAGE_BYTES
    from .tokens import MOST_TOKENS

    ended = "wait for jobs to end, or cancel some with the job tool"
    return [
        *CAPS.values(),
        Cap("world_files", MOST_ENTRIES, "files", "delete old candidates from the world's folder"),
        Cap("queued_jobs_per_world", QUEUED_PER_WORLD, "jobs", ended),
        Cap("queued_jobs", QUEUED_PER_WORKSPACE, "jobs", ended),
        Cap(
            "message_bytes", MESSAGE_BYTES, "bytes", "create the world with a part of the specification, add the rest by patches"
        ),
        Cap("resource_bytes", MAX_FILE_BYTES, "bytes", "read the file from the world folder"),
        Cap("connections", MOST_CONNECTIONS, "connections", "close connections that are not used"),
        Cap("sessions", MAX_SESSIONS, "sessions", "end sessions that are not used (DELETE /mcp)"),
        Cap("tokens", MOST_TOKENS, "tokens", "revoke tokens that are not used: worldagent token revoke NAME"),
    ]


def capabilities() -> dict[str, Any]:
    """Everything a client should know before it writes a specification; proves the renderer's variant on first use."""
    return {
        "worldagent": __version__,
        "python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}",
        "categories": categories(),
        "vegetation": _vegetation(),
        "renderer": _renderer(),
        "caps": {cap.name: {"value": cap.value, "unit": cap.unit, "knob": cap.knob} for cap in all_caps()},
        "versions": {name: package_version(name) for name in PACKAGES},
    }


def _vegetation() -> dict[str, Any]:
    """Species of plants and stones by biome and form; their sizes stand in the guide."""
    from ..construction.terrain.vegetation import species_of
    from ..worlds.spec.terrain import BIOME_NAMES

    found: dict[str, dict[str, list[str]]] = {}
    for biome in BIOME_NAMES:
        for species in species_of(biome):
            found.setdefault(biome, {}).setdefault(species.form, []).append(species.name)
    return {"sizes": "skill://outdoor-terrain/plants.md", "species": found}


def _renderer() -> dict[str, Any]:
    from ..rendering.tracer.variant import choose_variant

    try:
        chosen = choose_variant()
    except EngineError as error:
        return {"engine": "mitsuba", "variant": None, "why": str(error)}
    return {"engine": "mitsuba", "variant": chosen.name, "why": chosen.why}
