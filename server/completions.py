"""Values for the arguments of prompts and resource templates: what begins as the user typed, else what contains it."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path

from mcp.types import Completion

from ..worlds.errors import WorldAgentError
from ..worlds.folder import WorldFolder, world_ids
from ..worlds.quoting import quoted
from .skill_files import skill_files, skill_names
from .workspace_jobs import WorkspaceJobs

__all__ = ["complete"]

MOST_VALUES = 100
"""The protocol's cap."""
MOST_JOBS = 1000


def complete(
    workspace: Path, jobs: WorkspaceJobs, argument: str, typed: str, given: Mapping[str, str], *, template: str | None
) -> Completion | None:
    """Values of an argument that fit what was typed; None for free text.

    Args:
        workspace: Root of all worlds.
        jobs: Jobs of the workspace.
        argument: Name of the argument.
        typed: What the user has typed of its value.
        given: Values of arguments that are settled.
        template: URI template that the argument belongs to; None for a prompt.
    """
    known = _known(workspace, jobs, argument, given, template or "")
    if known is None:
        return None
    known = [value for value in known if quoted(value, most=len(value)) == f"'{value}'"]  # names that can be typed and seen
    low = typed.lower()
    fitting = [value for value in known if value.lower().startswith(low)]
    fitting = fitting or [value for value in known if low in value.lower()]
    return Completion(values=fitting[:MOST_VALUES], total=len(fitting), has_more=len(fitting) > MOST_VALUES)


def _known(workspace: Path, jobs: WorkspaceJobs, argument: str, given: Mapping[str, str], template: str) -> Iterable[str] | None:
    if argument == "world":
        return world_ids(workspace)
    if argument == "job_id":
        store = jobs.present()
        return [] if store is None else [job.id for job in store.list(given.get("world"), limit=MOST_JOBS)]
    if argument == "part" and "/schema/" in template:
        from ..worlds.schema_words import known_parts

        return known_parts()
    if argument == "entity":
        return _entities(workspace, given.get("world", ""))
    if argument == "path" and template.startswith("skill://"):
        return skill_files(given["name"]) if given.get("name") in skill_names() else []
    if argument == "name" and template.startswith("skill://"):
        return skill_names()
    if argument == "name":
        return _files(workspace, given.get("world", ""), "acceptance" if "/acceptance/" in template else "pictures")
    return None


def _entities(workspace: Path, world: str) -> list[str]:
    try:
        folder = WorldFolder.of(workspace, world)
        return sorted(json.loads(folder.spec_path.read_text()).get("entities", {}))
    except (WorldAgentError, OSError, ValueError, AttributeError, TypeError, RecursionError):
        return []


def _files(workspace: Path, world: str, folder_name: str) -> list[str]:
    """Files of a world, the newest first."""
    try:
        folder: Path = getattr(WorldFolder.of(workspace, world), folder_name)
        found = [(path.stat().st_mtime_ns, path.name) for path in folder.iterdir() if path.is_file() and not path.is_symlink()]
    except (WorldAgentError, OSError):
        return []
    return [name for _, name in sorted(found, reverse=True)]
