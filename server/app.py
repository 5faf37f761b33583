"""The MCP server of one workspace: tools, resources and prompts joined from explicit lists."""

from __future__ import annotations

import difflib
import mimetypes
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import anyio
import anyio.to_thread
from mcp.server import CacheHint, MCPServer
from mcp.server.extension import Extension
from mcp.server.lowlevel.helper_types import ReadResourceContents
from mcp.server.mcpserver import Context
from mcp.server.mcpserver.exceptions import ResourceNotFoundError
from mcp.server.subscriptions import InMemorySubscriptionBus
from mcp.shared.exceptions import MCPError
from mcp.types import INVALID_PARAMS, CallToolResult, GetPromptResult, InputRequiredResult, Resource, Tool, ToolAnnotations
from pydantic import AnyUrl

from .. import __version__
from ..execution import JobStore
from ..workflow.answers import HEAD_SCHEMA
from ..workflow.context import ToolBinding, ToolContext
from ..workflow.heard import Heard
from ..workflow.table_entries import entry_of
from ..worlds.bounds import shown
from ..worlds.errors import InputError
from ..worlds.folder import world_ids
from .arguments import Arguments
from .calls import error_result, error_text, run_in_thread
from .client_review import with_client
from .extensions.skills import Skills
from .extensions.tasks import HANDOVER, Tasks
from .icons import SERVER_ICON, icon_of
from .page.mcp_app import add_world_page, world_app
from .prompts import add_prompts
from .resources import add_resources
from .states import ResourceStates
from .watching import ResourceWatch
from .wire import stdio_streams
from .workspace_jobs import WorkspaceJobs

__all__ = ["INSTRUCTIONS", "WorldServer", "create_server"]

INSTRUCTIONS = """\
worldagent turns one prompt into a verified physical world. You write the specification; the server builds, \
simulates, measures and judges, and no call can set a verdict. Evidence that is missing or stale never passes.

The loop, for one world id:
1. edit_spec: create the world from the prompt, verbatim (it never changes), then edit by JSON Patch. Say in claims \
what its words mean. Each reply holds the audit.
2. build_terrain and place_object: geometry on its support, at real-world scale; they run the static checks.
3. run_checks(scope='static'): nothing may fail before physics starts.
4. probe_sim: a run through all phases; a pass freezes the settings.
5. bake_sim: the whole sequence with the frozen settings. Long work answers with a job_id: job(action='wait').
6. run_checks(scope='acceptance'): a fresh process judges the candidate, read-only. One open row refuses it.
7. render_shot(kind='final'): only after acceptance. Previews and contact sheets work as soon as the audit passes, \
maps of a landscape as soon as it is built.

After a failed row: state one hypothesis, change one parameter group with edit_spec, repeat from the first stale step. \
Bounds are no way out: weakening edits are refused or recorded. Trust the numbers of rows and inspect_world over \
pictures.

Units are SI, Z is up, quaternions are (w, x, y, z), frame k is the state at k / fps. Angles are in degrees only where a \
name says so.

Read first inspect_world(part='guide', prompt=...): what the skills say of your prompt. More as resource or by \
part='guide', pointer=...: skill://world-building/SKILL.md, skill://outdoor-terrain/SKILL.md for land outdoors. \
Then parts of the schema as you need them: inspect_world(part='schema', pointer='Shot'). worldagent://schema/world is all of it \
(over 280 kB), worldagent://capabilities tells engines, species and caps."""
"""Text about this server that a client shows its model; clients cut it at 2 KB."""

TOOLS_AT_A_TIME = 16
"""Calls that answer at once; more of them queue."""
WAITING_AT_A_TIME = 48
"""Calls that may wait for a job hold a thread each. They have threads of their own: however many wait, others are answered."""
DAY_MS = 86_400_000
MOST_LISTED_WORLDS = 200
"""Worlds whose reports are listed; all ids stand in `worldagent://worlds`."""


class WorldServer(MCPServer[Any]):
    """An `MCPServer` that runs tools by their `ToolBinding`."""

    def __init__(self, jobs: WorkspaceJobs, tools: Sequence[ToolBinding], *, extensions: Sequence[Extension]) -> None:
        public = CacheHint(ttl_ms=DAY_MS, scope="public")
        bus = InMemorySubscriptionBus()
        super().__init__(
            "worldagent",
            title="WorldAgent",
            description="Builds, simulates, verifies and renders physical worlds from a prompt",
            instructions=INSTRUCTIONS,
            icons=[SERVER_ICON],
            version=__version__,
            log_level="WARNING",
            cache_hints={"tools/list": public, "prompts/list": public, "resources/templates/list": public},
            extensions=extensions,
            subscriptions=bus,
        )
        self.workspace = jobs.workspace
        self._jobs = jobs
        self._bindings: dict[str, tuple[ToolBinding, Arguments]] = {}
        for binding in tools:
            if binding.name in self._bindings:
                raise ValueError(f"two tools are named {binding.name!r}")
            self._bindings[binding.name] = (binding, Arguments(binding))
        self._heard: Heard | None = None
        """Warnings that the only client was told; None where there may be several, whom the protocol does not tell apart."""
        self._replies = {kind: reply for binding in tools for kind, reply in binding.jobs.items()}
        self._described = [_described(*pair) for pair in self._bindings.values()]
        self._quick, self._waiting = anyio.CapacityLimiter(TOOLS_AT_A_TIME), anyio.CapacityLimiter(WAITING_AT_A_TIME)
        self.watch = ResourceWatch(ResourceStates(jobs.workspace, jobs), bus)
        self.watch.serve_handshake_era(self._lowlevel_server)
        self.middleware.append(self.watch)

    @property
    def jobs(self) -> JobStore:
        """Jobs of the workspace; opened at the first call, which makes the workspace."""
        return self._jobs()

    async def list_tools(self) -> list[Tool]:
        """Descriptions of all tools, in the order of the list that the server was made from; then those of extensions."""
        return [*self._described, *await super().list_tools()]

    async def call_tool(
        self, name: str, arguments: dict[str, Any], context: Context[Any, Any] | None = None
    ) -> CallToolResult | InputRequiredResult:
        """Run a tool; what goes wrong comes back as an error result that its caller can act on."""
        if name not in self._bindings:
            others = [tool.name for tool in await super().list_tools()]
            if name in others:
                return await super().call_tool(name, arguments, context)
            known = [*self._bindings, *others]
            close = difflib.get_close_matches(name, known, n=1)
            hint = f"; did you mean {close[0]!r}?" if close else "."
            return error_result(f"invalid: there is no tool {shown(name)}{hint} Tools: {', '.join(known)}")
        binding, accepted = self._bindings[name]
        try:
            parsed = accepted.parse(arguments)
        except InputError as error:
            return error_result(error_text(error))

        async def send(done: float, total: float | None, message: str | None) -> None:
            if context is not None:
                await context.report_progress(done, total, message)

        limiter = self._waiting if parsed.get("wait_s", 0.0) > 0 and _waits(name, parsed) else self._quick

        async def run() -> CallToolResult:
            return await run_in_thread(binding, parsed, self._context_of, send, limiter)

        if context is not None and name == "run_checks" and parsed.get("scope") == "review":
            return await with_client(context, self.workspace, str(parsed["world"]), run)
        return await run()

    async def get_prompt(
        self, name: str, arguments: dict[str, Any] | None = None, context: Context[Any, Any] | None = None
    ) -> GetPromptResult | InputRequiredResult:
        """A prompt; an unknown name or a missing argument is the caller's fault, which the SDK answers as the server's."""
        try:
            return await super().get_prompt(name, arguments, context)
        except ValueError as error:
            known = ", ".join(prompt.name for prompt in await self.list_prompts())
            raise MCPError(INVALID_PARAMS, f"{error}. Prompts: {known}") from error

    async def run_stdio_async(self) -> None:
        """Serve one client over stdin and stdout until stdin ends."""
        self.serve_one()
        async with stdio_streams() as (read, write):
            await self._lowlevel_server.run(read, write, self._lowlevel_server.create_initialization_options())

    def serve_one(self) -> None:
        """All calls from now on are of one client: what it was told once need not be told again."""
        self._heard = Heard()

    def _context_of(self, progress: Callable[[float, float | None, str], None], cancelled: Callable[[], bool]) -> ToolContext:
        return ToolContext(
            workspace=self.workspace,
            jobs=self.jobs,
            progress=progress,
            cancelled=cancelled,
            handover=HANDOVER.get(),
            replies=self._replies,
            heard=self._heard or Heard(),
        )

    async def list_resources(self) -> list[Resource]:
        """Resources without parameters, and the report of each world, so that a user finds worlds in a list."""
        worlds = await anyio.to_thread.run_sync(world_ids, self.workspace)
        reports = [
            Resource(
                uri=f"worldagent://worlds/{world}/report",
                name=f"world-report-{world}",
                title=f"Report of {world}",
                description=f"World {world} at a glance: prompt, counts of verdicts, failing rows with corrections, acceptance",
                mime_type="text/markdown",
            )
            for world in worlds[:MOST_LISTED_WORLDS]
        ]
        return [*await super().list_resources(), *reports]

    async def read_resource(
        self, uri: AnyUrl | str, context: Context[Any, Any] | None = None
    ) -> Iterable[ReadResourceContents] | InputRequiredResult:
        """Read a resource; files of several kinds behind one template get the MIME type of their own name."""
        file, _, entry = str(uri).partition("#") if str(uri).startswith("skill://") else (uri, "", "")
        found = await super().read_resource(file, context)
        if isinstance(found, InputRequiredResult):
            return found
        if entry:
            found = [replace(item, content=_entry(item.content, entry)) for item in found]
        return [
            ReadResourceContents(content=item.content, mime_type=_mime_type(str(uri)) or item.mime_type, meta=item.meta)
            for item in found
        ]


def create_server(
    workspace: Path,
    *,
    tools: Sequence[ToolBinding] | None = None,
    store: JobStore | None = None,
    extensions: Sequence[Extension] = (),
    conformance: bool = False,
) -> WorldServer:
    """The server of a workspace. Nothing is written and no heavy library is loaded before the first call.

    Args:
        workspace: Root of all worlds; made at the first tool call.
        tools: Tools to serve; default: all of `worldagent.tools`.
        store: Jobs of the workspace; default: opened at the first tool call.
        extensions: Further extensions of the protocol, besides tasks and skills.
        conformance: Whether to serve the fixtures of the official conformance suite too.
    """
    if tools is None:
        from ..tools import TOOLS

        tools = TOOLS
    required: Sequence[str] = ()
    if conformance:
        from .conformance.task_tools import FIXTURE_TOOLS, REQUIRE_TASKS

        tools, required = (*tools, *FIXTURE_TOOLS), REQUIRE_TASKS
    jobs = WorkspaceJobs(workspace.expanduser().absolute(), store)
    tasks = Tasks(jobs, tools, required=required)
    server = WorldServer(jobs, tools, extensions=(tasks, Skills(), world_app(), *extensions))
    server.middleware.append(tasks.check_listening)
    add_resources(server, server.workspace, jobs)
    add_world_page(server, jobs)
    add_prompts(server)
    if conformance:
        from .conformance.fixtures import add_fixtures

        add_fixtures(server)
    return server


def _waits(name: str, arguments: dict[str, Any]) -> bool:
    """True if a call may wait for a job: `job` only waits when it is told to, pictures only for the film."""
    if name == "job":
        return bool(arguments.get("action") == "wait")
    return not (name == "render_shot" and arguments.get("kind") != "final")


def _entry(content: str | bytes, entry: str) -> str:
    """The entry of a skill's table that a row cites behind `#`."""
    try:
        return entry_of(content if isinstance(content, str) else content.decode(), entry)
    except InputError as error:
        raise ResourceNotFoundError(str(error)) from error


def _described(binding: ToolBinding, arguments: Arguments) -> Tool:
    return Tool(
        name=binding.name,
        title=binding.title,
        description=binding.description,
        input_schema=arguments.schema,
        output_schema=None if binding.pictures else HEAD_SCHEMA,
        annotations=ToolAnnotations(
            title=binding.title,
            read_only_hint=binding.read_only,
            destructive_hint=binding.destructive,
            idempotent_hint=binding.idempotent,
            open_world_hint=binding.open_world,
        ),
        icons=[icon_of(binding.name)],
        _meta=dict(binding.meta) or None,
    )


def _mime_type(uri: str) -> str | None:
    if not any(part in uri for part in ("/pictures/", "/acceptance/")) and not uri.startswith("skill://"):
        return None
    return "text/markdown" if uri.endswith(".md") else mimetypes.guess_type(uri)[0]
