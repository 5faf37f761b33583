"""Routes of the web page: `/` and `/static/` hold no data of a world, `/api/` needs the token where the server has one."""

from __future__ import annotations

import hashlib
import mimetypes
from collections.abc import Awaitable, Callable
from functools import lru_cache
from pathlib import Path
from typing import Any

import anyio
import anyio.to_thread
import pydantic_core
from mcp.server.auth.middleware.bearer_auth import AuthenticatedUser
from starlette.requests import Request
from starlette.responses import FileResponse, Response, StreamingResponse
from starlette.routing import BaseRoute, Route

from ... import __version__
from ...execution import JobStore
from ...workflow.standing import film_of
from ...worlds.errors import EvidenceError, InputError, LimitError, RefusedError, WorldAgentError
from ...worlds.folder import WorldFolder, safe_join
from ...worlds.quoting import shown
from .claims import corrected
from .data import MAX_PAGE, PageData, QueryError, job_view
from .events import MOST_LISTENERS, EventHub
from .pictures import PICTURE_TYPES, picture_path, thumbnail
from .reviews import Reading

__all__ = ["STATIC", "page_routes"]

STATIC = Path(__file__).parent / "static"
READERS = 8
"""Requests of the page that read files at a time; more wait."""
KEPT_THUMBNAILS = 600
FILM_TYPES = {".webm": "video/webm", ".mp4": "video/mp4"}
PROOF_TYPES = {".html": "text/html; charset=utf-8", ".zip": "application/zip"}
PROOF_POLICY = "sandbox; default-src 'none'; img-src data:; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'"
"""A report is a file that anybody with a shell may have written: it runs nothing and reaches nobody."""
FRESH = {"Cache-Control": "no-store"}
KEPT = {"Cache-Control": "private, max-age=604800, immutable"}

Endpoint = Callable[[Request], Awaitable[Response]]


class Page:
    """Endpoints over one workspace."""

    def __init__(self, workspace: Path, jobs: Callable[[], JobStore]) -> None:
        self.data = PageData(workspace, jobs)
        self.events = EventHub(self.data)
        self.reading = Reading(workspace, jobs)
        self._jobs = jobs
        self._readers: anyio.CapacityLimiter | None = None
        self._thumbnail = lru_cache(maxsize=KEPT_THUMBNAILS)(lambda path, stamp: thumbnail(path))

    async def read(self, work: Callable[[], Any]) -> Any:
        """Do file work in a thread."""
        if self._readers is None:
            self._readers = anyio.CapacityLimiter(READERS)
        return await anyio.to_thread.run_sync(work, limiter=self._readers)

    def answering(self, read: Callable[[Request], Any]) -> Endpoint:
        """Endpoint that answers with the JSON of what `read` finds."""

        async def endpoint(request: Request) -> Response:
            return _json(await self.read(lambda: read(request)))

        return _told(endpoint)

    async def session(self, request: Request) -> Response:
        """Who the caller is to the server."""
        return _json({"version": __version__, "scope": "write" if _may_write(request) else "read", "token": _has_token(request)})

    async def cancel(self, request: Request) -> Response:
        """Ask a job to end."""
        refused = _unasked(request, "cancelling")
        if refused is not None:
            return refused
        if self.data.store() is None:
            raise InputError("this workspace has no jobs")
        name = request.path_params["job"]

        def ask() -> dict[str, Any]:
            store = self._jobs()
            store.request_cancel(name)
            return job_view(store.wait(name, 3.0), store)

        return _json(await self.read(ask))

    async def stream(self, request: Request) -> Response:
        """Events as they happen."""
        if self.events.full:
            return _problem(
                503, f"{MOST_LISTENERS} pages listen already, the most that are served; close one", {"Retry-After": "30"}
            )
        events = self.events.listen(request.headers.get("last-event-id", ""))
        return StreamingResponse(events, media_type="text/event-stream", headers={**FRESH, "X-Accel-Buffering": "no"})

    async def picture(self, request: Request) -> Response:
        """A picture, or its thumbnail."""
        folder = self._folder(request)
        path = await self.read(lambda: picture_path(folder, request.path_params["name"]))
        kept = KEPT if "v" in request.query_params else FRESH
        if "thumbnail" not in request.query_params:
            return FileResponse(path, media_type=PICTURE_TYPES[path.suffix.lower()], headers=kept)
        small = await self.read(lambda: self._thumbnail(path, path.stat().st_mtime_ns))
        return Response(small, media_type="image/jpeg", headers=kept)

    async def plate(self, request: Request) -> Response:
        """Picture of a plate."""
        world, number = request.path_params["world"], request.path_params["number"]
        data, kind = await self.read(lambda: self.data.plate(world, number))
        return Response(data, media_type=f"image/{kind}", headers=KEPT if "v" in request.query_params else FRESH)

    async def film(self, request: Request) -> Response:
        """The film, whole or by ranges."""
        folder = self._folder(request)
        found = await self.read(lambda: film_of(folder))
        if found is None or found.suffix not in FILM_TYPES:
            raise InputError("this world has no film; render_shot(kind='final') makes one after acceptance")
        path = safe_join(folder.root, found.relative_to(folder.root).as_posix())
        return FileResponse(path, media_type=FILM_TYPES[found.suffix], headers=FRESH)

    async def proof(self, request: Request) -> Response:
        """The matrix report or the bundle of an acceptance."""
        folder, name = self._folder(request), request.path_params["name"]
        path = safe_join(folder.acceptance, name)
        if path.suffix not in PROOF_TYPES or not path.is_file():
            raise InputError(f"there is no {name!r}; the page names what acceptance wrote")
        headers = FRESH | {"Content-Security-Policy": PROOF_POLICY}
        saved = f"{folder.id}_{path.name}" if path.suffix == ".zip" else None
        return FileResponse(path, media_type=PROOF_TYPES[path.suffix], headers=headers, filename=saved)

    async def review_picture(self, request: Request) -> Response:
        """A picture that readers are asked about."""
        path = await self.read(lambda: self.reading.picture(request))
        return FileResponse(path, media_type=f"image/{path.suffix[1:]}", headers=FRESH)

    async def review(self, request: Request) -> Response:
        """Answers of a person."""
        refused = _unasked(request, "answering")
        if refused is not None:
            return refused
        body = await request.body()
        return _json(await self.read(lambda: self.reading.answer(request, body)))

    async def correct(self, request: Request) -> Response:
        """A person's correction of a claim."""
        refused = _unasked(request, "correcting")
        if refused is not None:
            return refused
        body = await request.body()
        return _json(await self.read(lambda: corrected(self.data.workspace, request, body)))

    def _folder(self, request: Request) -> WorldFolder:
        return WorldFolder.of(self.data.workspace, request.path_params["world"])


def page_routes(workspace: Path, jobs: Callable[[], JobStore]) -> list[BaseRoute]:
    """Routes of the page over one workspace; they check no token and no origin themselves.

    Args:
        workspace: Root of all worlds.
        jobs: Opens the jobs of the workspace.
    """
    page = Page(workspace, jobs)
    data = page.data
    world = "/api/worlds/{world}"

    def get(path: str, read: Callable[[Request], Any]) -> Route:
        return Route(path, page.answering(read), methods=["GET"])

    def name(request: Request) -> str:
        return str(request.path_params["world"])

    return [
        Route("/", _static("index.html"), methods=["GET"]),
        Route("/static/{name}", _static(), methods=["GET"]),
        Route("/api/session", _told(page.session), methods=["GET"]),
        Route("/api/events", _told(page.stream), methods=["GET"]),
        get("/api/jobs", lambda r: data.jobs(world=r.query_params.get("world"), **_slice(r, 50))),
        get("/api/jobs/active", lambda r: {"jobs": data.active()}),
        Route("/api/jobs/{job}/cancel", _told(page.cancel), methods=["POST"]),
        get("/api/worlds", lambda r: data.worlds(query=_word(r, "q"), **_slice(r, 50))),
        get(world, lambda r: data.world(name(r))),
        get(
            f"{world}/matrix",
            lambda r: data.matrix(
                name(r), status=_word(r, "status"), group=_word(r, "group"), query=_word(r, "q"), **_slice(r, 100)
            ),
        ),
        get(f"{world}/row", lambda r: data.row(name(r), r.query_params.get("id", ""))),
        get(f"{world}/revisions", lambda r: data.revisions(name(r), **_slice(r, 25))),
        get(f"{world}/pictures", lambda r: data.pictures(name(r), **_slice(r, 24))),
        get(f"{world}/charts", lambda r: data.charts(name(r))),
        get(f"{world}/review", page.reading.questions),
        Route(f"{world}/review", _told(page.review), methods=["POST"]),
        Route(f"{world}/claims", _told(page.correct), methods=["POST"]),
        Route(f"{world}/review/pictures/{{number}}", _told(page.review_picture), methods=["GET"]),
        Route(f"{world}/pictures/{{name}}", _told(page.picture), methods=["GET"]),
        Route(f"{world}/plates/{{number}}", _told(page.plate), methods=["GET"]),
        Route(f"{world}/film", _told(page.film), methods=["GET"]),
        Route(f"{world}/proof/{{name}}", _told(page.proof), methods=["GET"]),
    ]


def _static(fixed: str | None = None) -> Endpoint:
    """Files of the page that ship with the package."""
    files = {path.name: path for path in STATIC.iterdir() if path.is_file()}

    async def endpoint(request: Request) -> Response:
        path = files.get(fixed or request.path_params["name"])
        if path is None:
            return _problem(404, "there is no such file")
        body = await anyio.to_thread.run_sync(path.read_bytes)
        tag = f'"{hashlib.sha256(body).hexdigest()[:32]}"'
        headers = {"Cache-Control": "no-cache", "ETag": tag}
        if request.headers.get("if-none-match") == tag:
            return Response(status_code=304, headers=headers)
        kind = "text/javascript" if path.suffix == ".js" else mimetypes.guess_type(path.name)[0]
        return Response(body, media_type=kind, headers=headers)

    return endpoint


def _has_token(request: Request) -> bool:
    return isinstance(request.scope.get("user"), AuthenticatedUser)


def _may_write(request: Request) -> bool:
    """True if the caller may change something; without tokens everybody on loopback may."""
    return not _has_token(request) or "write" in request.scope["user"].scopes


def _unasked(request: Request, deed: str) -> Response | None:
    """Refusal of a request that changes something, where the token only reads or a form of another site may have sent it."""
    if not _may_write(request):
        return _problem(403, f"this token only reads; {deed} needs one of scope 'write'")
    # No form of another site can send this type unasked.
    if request.headers.get("content-type", "").partition(";")[0].strip() != "application/json":
        return _problem(415, "send Content-Type: application/json")
    return None


def _told(endpoint: Endpoint) -> Endpoint:
    """Errors of the package as JSON with their own text."""

    async def telling(request: Request) -> Response:
        try:
            return await endpoint(request)
        except LimitError as error:
            return _problem(413, str(error))
        except QueryError as error:
            return _problem(400, str(error))
        except InputError as error:  # a world, job or file that is not there
            return _problem(404, str(error))
        except (EvidenceError, RefusedError) as error:
            return _problem(409, str(error))
        except WorldAgentError as error:
            return _problem(500, str(error))

    return telling


def _slice(request: Request, limit: int) -> dict[str, int]:
    return {
        "offset": _number(request, "offset", 0, 0, 10_000_000),
        "limit": _number(request, "limit", limit, 1, MAX_PAGE),
    }


def _number(request: Request, name: str, default: int, least: int, most: int) -> int:
    text = request.query_params.get(name, str(default))
    if not (text.isdecimal() and text.isascii() and len(text) < 10 and least <= int(text) <= most):
        raise QueryError(f"{name} {text[:20]!r} must be a whole number from {least} to {most}")
    return int(text)


def _word(request: Request, name: str) -> str:
    text = request.query_params.get(name, "")
    if len(text) > 200:
        raise QueryError(f"{name} has {len(text)} characters, at most 200 are searched for")
    return text


def _json(value: Any) -> Response:
    return Response(pydantic_core.to_json(shown(value), inf_nan_mode="null"), media_type="application/json", headers=FRESH)


def _problem(status: int, text: str, headers: dict[str, str] | None = None) -> Response:
    body = pydantic_core.to_json({"error": shown(text)})
    return Response(body, status, media_type="application/json", headers=FRESH | (headers or {}))
