"""Resources, which a client reads without calling a tool: schema, capabilities, worlds and their matrices, pictures, skills."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import anyio.to_thread
import pydantic_core
from mcp.server import MCPServer
from mcp.server.mcpserver.exceptions import ResourceError, ResourceNotFoundError
from mcp.types import Completion, CompletionArgument, CompletionContext, PromptReference, ResourceTemplateReference

from ..worlds.errors import EvidenceError, InputError, WorldAgentError
from ..worlds.folder import WorldFolder, safe_join, world_ids
from ..worlds.quoting import json_visible, visible
from ..worlds.storage import storage_failure
from .completions import complete
from .limits import MAX_FILE_BYTES
from .report import world_report
from .skill_files import SKILLS, skill_files, skill_frontmatter, skill_names
from .workspace_jobs import WorkspaceJobs

if TYPE_CHECKING:
    from ..worlds.ledger import Ledger

__all__ = ["add_resources"]

JSON = "application/json"
_SHOWN_NAMES = 40
_WORLD = "worldagent://worlds/{world}"


def add_resources(server: MCPServer[Any], workspace: Path, jobs: WorkspaceJobs) -> None:
    """Register all resources, templates and completions on a server."""
    _add_general(server, workspace)
    _add_standing(server, workspace)
    _add_parts(server, workspace)
    _add_jobs(server, jobs)
    _add_skills(server)

    async def completion(
        ref: PromptReference | ResourceTemplateReference, argument: CompletionArgument, context: CompletionContext | None
    ) -> Completion | None:
        given = (context.arguments or {}) if context else {}
        template = ref.uri if isinstance(ref, ResourceTemplateReference) else None
        work = partial(complete, workspace, jobs, argument.name, argument.value, given, template=template)
        return await anyio.to_thread.run_sync(work)

    server.completion()(completion)  # type: ignore[no-untyped-call]


def _add_general(server: MCPServer[Any], workspace: Path) -> None:
    @server.resource(
        "worldagent://schema/world",
        name="world-schema",
        title="Schema of a world",
        description="JSON Schema of a world's specification (world.json): every field with unit, range and default",
        mime_type="application/schema+json",
    )
    def schema() -> str:
        from ..worlds.spec import WorldSpec

        return _json(WorldSpec.model_json_schema())

    @server.resource(
        "worldagent://schema/{part}",
        name="schema-part",
        title="Part of the schema",
        description="One part of a specification in short lines: World for the index, then Entity, Shape, Predicate, ... as named there",
        mime_type=JSON,
    )
    def schema_part(part: str) -> str:
        from ..worlds.schema_words import described

        with _told():
            return _json(described(part))

    @server.resource(
        "worldagent://capabilities",
        name="capabilities",
        title="What this server can do",
        description="Engines with versions, categories of physics that are available, renderer variant, caps",
        mime_type=JSON,
    )
    def about() -> str:
        from .capabilities import capabilities

        return _json(capabilities())

    @server.resource(
        "worldagent://worlds",
        name="worlds",
        title="Worlds",
        description="Ids of the worlds in this workspace",
        mime_type=JSON,
    )
    def worlds() -> str:
        return _json({"worlds": world_ids(workspace)})


def _add_standing(server: MCPServer[Any], workspace: Path) -> None:
    """A world as a whole: its specification, and the rows, edits and report of its ledger."""

    @server.resource(
        f"{_WORLD}/spec",
        name="world-spec",
        title="Specification",
        description="The current world.json of a world",
        mime_type=JSON,
    )
    def spec(world: str) -> str:
        with _opened(workspace, world) as folder:
            return json_visible(_file(folder.root, folder.spec_path.name, []).decode("utf-8", "replace"))

    @server.resource(
        f"{_WORLD}/matrix",
        name="world-matrix",
        title="Requirements matrix",
        description="All rows of the requirements matrix with measurements and evidence, failing rows first",
        mime_type=JSON,
    )
    def matrix(world: str) -> str:
        with _opened(workspace, world) as folder:
            ledger = _ledger(folder)
            if ledger is None:
                return _json({"world": world, "revision": 0, "rows": []})
            with ledger.looking():
                rows = [row.model_dump(mode="json") for row in ledger.rows()]
                return _json({"world": world, "revision": ledger.revision(), "rows": rows})

    @server.resource(
        f"{_WORLD}/revisions",
        name="world-revisions",
        title="Revisions",
        description="Edits of the specification, newest first: patch, hypothesis, parameter groups, weakenings with reasons",
        mime_type=JSON,
    )
    def revisions(world: str) -> str:
        with _opened(workspace, world) as folder:
            ledger = _ledger(folder)
            return _json({"world": world, "revisions": [] if ledger is None else ledger.revisions(limit=200)})

    @server.resource(
        f"{_WORLD}/report",
        name="world-report",
        title="Report",
        description="A world at a glance: prompt, counts of verdicts, failing rows with corrections, weakenings, acceptance",
        mime_type="text/markdown",
    )
    def report(world: str) -> str:
        with _opened(workspace, world) as folder:
            ledger = _ledger(folder)
            with nullcontext() if ledger is None else ledger.looking():
                return world_report(folder, ledger)


def _add_parts(server: MCPServer[Any], workspace: Path) -> None:
    """Single things of a world: an entity, a picture, a proof of acceptance, the film."""

    def listed(folder: Path, name: str) -> bytes:
        return _file(folder, name, sorted(p.name for p in folder.iterdir() if p.is_file()) if folder.is_dir() else [])

    @server.resource(
        f"{_WORLD}/entities/{{entity}}",
        name="world-entity",
        title="Entity",
        description="Contract of one entity in the current specification: role, dimensions, material, parts, motion",
        mime_type=JSON,
    )
    def entity_contract(world: str, entity: str) -> str:
        with _opened(workspace, world) as folder:
            entities = folder.read_json(folder.spec_path).get("entities", {})
            if entity not in entities:
                raise InputError(f"world {world!r} has no entity {entity!r}; known: {sorted(entities)[:_SHOWN_NAMES]}")
            return _json({"world": world, "entity": entity, "contract": entities[entity]})

    @server.resource(
        f"{_WORLD}/pictures/{{name}}",
        name="world-picture",
        title="Picture",
        description="A preview, contact sheet, plot or plan that render_shot wrote",
        mime_type="application/octet-stream",
    )
    def picture(world: str, name: str) -> bytes:
        with _opened(workspace, world) as folder:
            return listed(folder.pictures, name)

    @server.resource(
        f"{_WORLD}/acceptance/{{name}}",
        name="world-proof",
        title="Report or bundle",
        description="The matrix report (one HTML page with pictures) or the acceptance bundle (zip) that acceptance wrote",
        mime_type="application/octet-stream",
    )
    def proof(world: str, name: str) -> bytes:
        with _opened(workspace, world) as folder:
            return listed(folder.acceptance, name)

    @server.resource(
        f"{_WORLD}/film",
        name="world-film",
        title="Film",
        description="The newest film that render_shot(kind='final') rendered",
        mime_type="video/webm",
    )
    def film(world: str) -> bytes:
        with _opened(workspace, world) as folder:
            films = sorted(folder.root.glob("candidates/*/final/final.*"), key=lambda p: p.stat().st_mtime)
            if not films:
                raise ResourceNotFoundError(f"world {world!r} has no film; render_shot(kind='final') makes one after acceptance")
            return _file(folder.root, folder.relative(films[-1]), [])


def _add_jobs(server: MCPServer[Any], jobs: WorkspaceJobs) -> None:
    def listed(world: str | None) -> str:
        from ..workflow.waiting import job_data

        store = jobs.present()
        return _json({"jobs": [] if store is None else [job_data(job, store) for job in store.list(world, limit=50)]})

    @server.resource(
        "worldagent://jobs",
        name="jobs",
        title="Jobs",
        description="The newest jobs of this workspace with state, progress and running time",
        mime_type=JSON,
    )
    def all_jobs() -> str:
        return listed(None)

    @server.resource(
        "worldagent://jobs/{job_id}",
        name="job",
        title="Job",
        description="One job: state, progress, running time, and its result once it is done",
        mime_type=JSON,
    )
    def one_job(job_id: str) -> str:
        from ..workflow.waiting import job_data

        with _told():
            store = jobs.present()
            if store is None:
                raise InputError(f"there is no job {job_id!r}: this workspace has had none")
            found = store.get(job_id)
            return _json(job_data(found, store) | ({"result": found.result} if found.state == "done" else {}))

    @server.resource(
        "worldagent://worlds/{world}/jobs",
        name="world-jobs",
        title="Jobs of a world",
        description="The newest jobs of one world with state, progress and running time",
        mime_type=JSON,
    )
    def world_jobs(world: str) -> str:
        with _opened(jobs.workspace, world):
            return listed(world)


def _add_skills(server: MCPServer[Any]) -> None:
    for name in skill_names():
        _add_skill(server, name, skill_frontmatter(name).get("description", f"Skill {name}"))

    @server.resource(
        "skill://{name}/{+path}",
        name="skill-file",
        title="File of a skill",
        description=f"SKILL.md and the other files of a skill. Skills: {', '.join(skill_names()) or 'none'}",
        mime_type="text/markdown",
    )
    def skill_file(name: str, path: str) -> str:
        if name not in skill_names():
            raise ResourceNotFoundError(f"there is no skill {name!r}; known skills: {skill_names()}")
        with _told():
            return _file(SKILLS / name, path, skill_files(name)).decode()


def _add_skill(server: MCPServer[Any], name: str, description: str) -> None:
    @server.resource(
        f"skill://{name}/SKILL.md",
        name=f"skill-{name}",
        title=f"Skill {name}",
        description=description,
        mime_type="text/markdown",
    )
    def skill() -> str:
        return (SKILLS / name / "SKILL.md").read_text()


@contextmanager
def _told() -> Iterator[None]:
    """Turns errors of the world floor into resource errors, whose text the client sees."""
    try:
        yield
    except (InputError, EvidenceError) as error:
        raise ResourceNotFoundError(visible(str(error))) from error
    except WorldAgentError as error:
        raise ResourceError(visible(str(error))) from error
    except (OSError, ValueError, sqlite3.Error) as error:
        raise ResourceError(visible(str(storage_failure(error) or f"it is damaged: {error}"))) from error


@contextmanager
def _opened(workspace: Path, world: str) -> Iterator[WorldFolder]:
    with _told():
        yield WorldFolder.of(workspace, world)


def _ledger(folder: WorldFolder) -> Ledger | None:
    """The ledger, or None: reading never creates one."""
    if not folder.ledger_path.is_file():
        return None
    from ..worlds.ledger import Ledger

    return Ledger(folder.ledger_path)


def _file(base: Path, relative: str, known: list[str]) -> bytes:
    """Bytes of a file under `base`.

    Raises:
        InputError: It leads out of `base`, is missing, or is too large.
    """
    path = safe_join(base, relative)
    if not path.is_file():
        raise InputError(f"there is no {relative!r}; known: {known[-_SHOWN_NAMES:]}")
    size = path.stat().st_size
    if size > MAX_FILE_BYTES:
        raise InputError(f"{relative!r} has {size} bytes, at most {MAX_FILE_BYTES} are sent; read it from the world folder")
    return path.read_bytes()


def _json(value: Any) -> str:
    return json_visible(pydantic_core.to_json(value, inf_nan_mode="null").decode())
