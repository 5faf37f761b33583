"""Routes by which a person reads a world: what there is to read, its pictures, and the answers."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from starlette.requests import Request

from ...execution import JobStore
from ...workflow.review.person import answer_of_person, picture_file, rows_anew, to_read
from ...workflow.session import Session
from ...worlds.errors import InputError
from .data import QueryError

__all__ = ["Reading"]

MOST_BYTES = 60_000
"""Largest reply of a person [bytes]: 60 spans with reasons."""


class Reading:
    """Reviews of the worlds of a workspace, as the page asks for them."""

    def __init__(self, workspace: Path, jobs: Callable[[], JobStore]) -> None:
        self.workspace, self._jobs = workspace, jobs

    def _session(self, request: Request) -> Session:
        return Session.open(self.workspace, str(request.path_params["world"]))

    def questions(self, request: Request) -> dict[str, Any]:
        """Questions, account and standing answers; errors as `to_read`."""
        return to_read(self._session(request))

    def picture(self, request: Request) -> Path:
        """File of a picture; errors as `picture_file`."""
        return picture_file(self._session(request), str(request.path_params["number"]))

    def answer(self, request: Request, body: bytes) -> dict[str, Any]:
        """Record answers, and start the job that writes their rows.

        Raises:
            QueryError: they are no JSON, too long, or something in them is missing or out of range.
            RefusedError: the questions are others now.
        """
        session = self._session(request)
        if len(body) > MOST_BYTES:
            raise QueryError(f"the answers have {len(body)} bytes, at most {MOST_BYTES} are read; shorten the reasons")
        try:
            review = answer_of_person(session, json.loads(body))
        except ValueError as error:
            raise QueryError(f"the answers are no JSON: {error}") from None
        except InputError as error:
            raise QueryError(str(error)) from None
        return {"recorded": len(review.answers), "job_id": rows_anew(session, self._jobs())}
