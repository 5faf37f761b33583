"""The view of one world as an MCP App: the page's own files in one document, its data as a resource."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import lru_cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pydantic_core
from mcp.server import MCPServer
from mcp.server.apps import APP_MIME_TYPE, Apps
from mcp.server.mcpserver.exceptions import ResourceError, ResourceNotFoundError
from mcp.server.mcpserver.resources import FunctionResource

from ...workflow.links import WORLD_VIEW
from ...worlds.errors import InputError, WorldAgentError
from ..workspace_jobs import WorkspaceJobs

if TYPE_CHECKING:
    from .data import PageData

__all__ = ["add_world_page", "app_document", "world_app"]

STATIC = Path(__file__).parent / "static"
VIEWS = ("world", "matrix", "row", "revisions", "pictures", "charts", "jobs")
_IMPORT = re.compile(r'^import \{[^}]*\} from "\./([a-z]+)\.js";\n', re.MULTILINE)


def world_app() -> Apps:
    """The extension: one document that hosts show beside the tools that name it."""
    apps = Apps()
    apps.add_resource(
        FunctionResource(
            uri=WORLD_VIEW,
            name="world-app",
            title="A world at work",
            description="Stages, jobs with progress, requirements, pictures and proofs of one world, for hosts that show MCP Apps",
            mime_type=APP_MIME_TYPE,
            meta={"ui": {"prefersBorder": True}},
            fn=app_document,
        )
    )
    return apps


@lru_cache(maxsize=1)
def app_document() -> str:
    """The document: no file beside it, no address in it."""
    shell, style = ((STATIC / name).read_text() for name in ("embedded.html", "style.css"))
    return shell.replace("/* style.css */", style).replace("/* embedded.js */", _joined("embedded"))


def _joined(name: str, seen: set[str] | None = None) -> str:
    """A module after all that it imports, as one script; the modules share no top-level name."""
    seen = {name} if seen is None else seen
    source = (STATIC / f"{name}.js").read_text()
    before = ""
    for needed in _IMPORT.findall(source):
        if needed not in seen:
            seen.add(needed)
            before += _joined(needed, seen)
    return before + re.sub(r"^export ", "", _IMPORT.sub("", source), flags=re.MULTILINE)


def add_world_page(server: MCPServer[Any], jobs: WorkspaceJobs) -> None:
    """Serve what the document shows, as the web page gets it over HTTP."""

    @lru_cache(maxsize=1)
    def data() -> PageData:
        from .data import PageData

        return PageData(jobs.workspace, jobs)

    @server.resource(
        "worldagent://worlds/{world}/page{?view,status,group,q,row,offset,limit}",
        name="world-page",
        title="View of a world",
        description=f"Data of {WORLD_VIEW}. view: {', '.join(VIEWS)}; the other parameters filter and page matrix and lists. "
        "For a model inspect_world is shorter",
        mime_type="application/json",
    )
    def page(
        world: str,
        view: str = "world",
        status: str = "",
        group: str = "",
        q: str = "",
        row: str = "",
        offset: str = "0",
        limit: str = "",
    ) -> str:
        try:
            found = _page(data(), world, view, {"status": status, "group": group, "query": q}, row, _whole(offset), limit)
        except InputError as error:
            raise ResourceNotFoundError(str(error)) from error
        except WorldAgentError as error:
            raise ResourceError(str(error)) from error
        return pydantic_core.to_json(found, inf_nan_mode="null").decode()


def _page(data: PageData, world: str, view: str, filters: dict[str, str], row: str, offset: int, limit: str) -> dict[str, Any]:
    from ...worlds.folder import WorldFolder
    from .data import MAX_PAGE

    place = {"offset": offset} | ({"limit": max(1, min(MAX_PAGE, _whole(limit)))} if limit else {})
    views: dict[str, Callable[[], dict[str, Any]]] = {
        "world": partial(data.world, world),
        "matrix": partial(data.matrix, world, **filters, **place),  # type: ignore[arg-type]
        "row": partial(data.row, world, row),
        "revisions": partial(data.revisions, world, **place),
        "pictures": partial(data.pictures, world, **place),
        "charts": partial(data.charts, world),
        "jobs": partial(data.jobs, world=world, **place),
    }
    if view not in views:
        raise InputError(f"view {view!r} must be one of {', '.join(VIEWS)}")
    WorldFolder.of(data.workspace, world)
    return views[view]()


def _whole(text: str) -> int:
    if not (text.isascii() and text.isdecimal() and len(text) < 10):
        raise InputError(f"offset and limit are whole numbers, not {text[:20]!r}")
    return int(text)
