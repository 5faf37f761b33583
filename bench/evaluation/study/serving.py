"""The page of a study on this machine alone: a small HTTP server that shows films under names that tell nothing."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs

from ....worlds.errors import InputError
from .answers import CHOICES, CRITERIA, AnswerFile, Rater
from .design import Step
from .films import StudyFilms
from .pages import POLICY, consent_page, end_page, pair_page, rate_page, words_page

__all__ = ["StudyPage", "study_server"]

HOST = "127.0.0.1"
MOST_FORM = 20_000
"""Bytes of an answer."""
CHUNK, MOST_RANGE = 1 << 18, 1 << 20
"""Bytes of a film that are read at a time; of one answer to a player, who asks for more. Browsers have six connections, and a paused player
that waits on an open one would keep the form from being sent."""


@dataclass(frozen=True)
class StudyPage:
    """Films, and where answers about them go."""

    films: StudyFilms
    answers: AnswerFile

    def shown(self, rater: Rater, *, kept: dict[str, str] | None = None, problem: str = "") -> str:
        """The next page of a rater."""
        study, next_step = self.answers.study, self.answers.next_step(rater)
        if next_step is None:
            return end_page()
        number, step = next_step
        prompt, of = self.films.tasks[step.task], len(study.steps(rater.number))
        tokens = [self.answers.token(rater, number, place) for place in range(len(step.methods))]
        if step.kind == "pair":
            return pair_page(prompt, tokens, number=number, of=of, problem=problem)
        return rate_page(prompt, tokens, number=number, of=of, kept=kept, problem=problem)

    def film(self, rater: Rater, token: str) -> Path | None:
        """The film of that name on the page that the rater sees now; None where there is none."""
        next_step = self.answers.next_step(rater)
        if next_step is None:
            return None
        number, step = next_step
        places = {self.answers.token(rater, number, place): method for place, method in enumerate(step.methods)}
        return self.films.paths[places[token], step.task] if token in places else None

    def take(self, rater: Rater, form: dict[str, str]) -> str:
        """Keep an answer; words about what is missing, or nothing. An answer to a page that has one is let pass: a browser sent it again."""
        next_step = self.answers.next_step(rater)
        if next_step is None or form.get("step") != str(next_step[0]):
            return ""
        number, step = next_step
        answer, problem = _answer_of(step, form)
        if answer is not None:
            self.answers.keep(rater, number, answer)
        return problem


def _answer_of(step: Step, form: dict[str, str]) -> tuple[dict[str, Any] | None, str]:
    """The answer to a page, or what is missing."""
    if step.kind == "pair":
        choice = form.get("choice", "")
        return ({"choice": choice}, "") if choice in CHOICES else (None, "Choose one of the three answers.")
    scores = [{key: form.get(f"{key}-{place}", "") for key in CRITERIA} for place in range(len(step.methods))]
    missing = sum(value not in ("1", "2", "3", "4", "5") for of in scores for value in of.values())
    if missing:
        return None, f"{missing} of {len(scores) * len(CRITERIA)} ratings are missing; what you chose is still there."
    return {"scores": [{key: int(value) for key, value in of.items()} for of in scores]}, ""


class _Handler(BaseHTTPRequestHandler):
    """One request. The cookie of a page holds the rater's random word, as does the page's own address."""

    protocol_version = "HTTP/1.1"
    server_version, sys_version = "study", ""
    page: StudyPage

    def do_GET(self) -> None:
        """A page, or a film."""
        if not self._from_here():
            return
        if self.path == "/":
            self._consent()
        elif found := re.fullmatch(r"/r/([\w-]{1,40})", self.path):
            rater = self.page.answers.rater(found[1])
            if rater is None:
                self._send(HTTPStatus.NOT_FOUND, words_page("No such page", "Begin at the first page."))
            else:
                self._send(HTTPStatus.OK, self.page.shown(rater), cookie=rater.id)
        elif found := re.fullmatch(r"/film/([0-9a-f]{24})", self.path):
            rater = self.page.answers.rater(self._cookie())
            path = None if rater is None else self.page.film(rater, found[1])
            if path is None:
                self._send(HTTPStatus.NOT_FOUND, words_page("No such film", "It belongs to another page."))
            else:
                self._film(path)
        else:
            self._send(HTTPStatus.NOT_FOUND, words_page("No such page", "Begin at the first page."))

    def do_POST(self) -> None:
        """Consent, or an answer."""
        form = self._form() if self._from_here() else None
        if form is None:
            return
        if self.path == "/":
            if form.get("consent") != "yes":
                self._consent("Tick the box to take part.")
            else:
                self._onward(self.page.answers.enrol())
            return
        found = re.fullmatch(r"/r/([\w-]{1,40})", self.path)
        rater = self.page.answers.rater(found[1]) if found else None
        if rater is None:
            self._send(HTTPStatus.NOT_FOUND, words_page("No such page", "Begin at the first page."))
        elif problem := self.page.take(rater, form):
            self._send(HTTPStatus.UNPROCESSABLE_ENTITY, self.page.shown(rater, kept=form, problem=problem), cookie=rater.id)
        else:
            self._onward(rater)

    def _consent(self, problem: str = "") -> None:
        study = self.page.answers.study
        text = consent_page(min(study.tasks_each, len(study.tasks)), len(study.methods), study.pairs_each, problem=problem)
        self._send(HTTPStatus.UNPROCESSABLE_ENTITY if problem else HTTPStatus.OK, text)

    def _from_here(self) -> bool:
        """Refuse requests under another name, or sent by a page of another site."""
        port = self.connection.getsockname()[1]
        here = {f"{name}:{port}" for name in (HOST, "localhost")}
        origin = self.headers.get("Origin")
        if self.headers.get("Host") in here and (origin is None or origin.removeprefix("http://") in here):
            return True
        self.close_connection = True
        self._send(HTTPStatus.FORBIDDEN, words_page("Not from here", f"This page is at http://{HOST}:{port}/ alone."))
        return False

    def _form(self) -> dict[str, str] | None:
        length = self.headers.get("Content-Length", "")
        if not length.isdigit() or int(length) > MOST_FORM:
            self.close_connection = True
            self._send(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, words_page("Too long", f"An answer has at most {MOST_FORM} bytes."))
            return None
        told = parse_qs(self.rfile.read(int(length)).decode("utf-8", "replace"), max_num_fields=400)
        return {key: values[0] for key, values in told.items()}

    def _cookie(self) -> str:
        found = re.search(r"(?:^|;\s*)rater=([\w-]{1,40})", self.headers.get("Cookie", ""))
        return found[1] if found else ""

    def _headers(self, status: int, media_type: str, length: int, **more: str) -> None:
        self.send_response(status)
        told = {
            "Content-Type": media_type,
            "Content-Length": str(length),
            "Cache-Control": "no-store",
            "X-Content-Type-Options": "nosniff",
        }
        for name, value in {**told, **{k.replace("_", "-"): v for k, v in more.items()}}.items():
            self.send_header(name, value)
        self.end_headers()

    def _send(self, status: int, text: str, *, cookie: str = "") -> None:
        data = text.encode()
        told = {"Set_Cookie": f"rater={cookie}; Path=/; HttpOnly; SameSite=Strict"} if cookie else {}
        self._headers(
            status, "text/html; charset=utf-8", len(data), Content_Security_Policy=POLICY, Referrer_Policy="same-origin", **told
        )
        self.wfile.write(data)

    def _onward(self, rater: Rater) -> None:
        self._headers(HTTPStatus.SEE_OTHER, "text/plain", 0, Location=f"/r/{rater.id}")

    def _film(self, path: Path) -> None:
        """A film, whole or the one range that a player asks for."""
        size, media_type = path.stat().st_size, self.page.films.media_type
        asked = re.fullmatch(r"bytes=(\d*)-(\d*)", self.headers.get("Range", ""))
        if asked is None or not any(asked.groups()):
            self._headers(HTTPStatus.OK, media_type, size, Accept_Ranges="bytes")
            first, last = 0, size - 1
        else:
            first = int(asked[1]) if asked[1] else max(0, size - int(asked[2]))
            last = min(int(asked[2]) if asked[1] and asked[2] else size, size - 1, first + MOST_RANGE - 1)
            if first > last:
                self._headers(HTTPStatus.REQUESTED_RANGE_NOT_SATISFIABLE, media_type, 0, Content_Range=f"bytes */{size}")
                return
            self._headers(
                HTTPStatus.PARTIAL_CONTENT,
                media_type,
                last - first + 1,
                Accept_Ranges="bytes",
                Content_Range=f"bytes {first}-{last}/{size}",
            )
        try:
            for chunk in _chunks(path, first, last):
                self.wfile.write(chunk)
        except (BrokenPipeError, ConnectionResetError):
            self.close_connection = True  # players leave as soon as they have what they want

    def log_message(self, format: str, *args: Any) -> None:  # noqa: A002 - the signature of the class
        """Say nothing: a line per request would show the rater's word on the terminal."""


class _Server(ThreadingHTTPServer):
    daemon_threads = True

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Pass over a browser that left in the middle of a request."""
        if not isinstance(sys.exception(), ConnectionError):
            super().handle_error(request, client_address)


def _chunks(path: Path, first: int, last: int) -> Iterator[bytes]:
    with path.open("rb") as stream:
        stream.seek(first)
        left = last - first + 1
        while left and (data := stream.read(min(CHUNK, left))):
            left -= len(data)
            yield data


@contextmanager
def study_server(page: StudyPage, port: int = 0) -> Iterator[ThreadingHTTPServer]:
    """A server of the page on the loopback address; whoever gets it calls `serve_forever`.

    Raises:
        InputError: the port is taken.
    """
    handler = type("Handler", (_Handler,), {"page": page})
    try:
        server = _Server((HOST, port), handler)
    except OSError as error:
        raise InputError(f"port {port} on {HOST} cannot be had: {error.strerror}; name another with --port") from error
    try:
        yield server
    finally:
        server.server_close()
