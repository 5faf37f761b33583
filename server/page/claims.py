"""The route by which a person corrects a claim of the prompt."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from starlette.requests import Request

from ...workflow.correcting import correct_claim
from ...workflow.session import Session
from ...worlds.errors import InputError
from .data import QueryError

__all__ = ["corrected"]

MOST_BYTES = 40_000
"""Most bodies in a correction; a claim may name 500."""


def corrected(workspace: Path, request: Request, body: bytes) -> dict[str, Any]:
    """Record a correction, as `correct_claim` does; which revision it made.

    Raises:
        QueryError: it is no JSON, too long, or something in it is missing or out of range.
        RefusedError: see `correct_claim`.
    """
    session = Session.open(workspace, str(request.path_params["world"]))
    if len(body) > MOST_BYTES:
        raise QueryError(f"the correction has {len(body)} bytes, at most {MOST_BYTES} are read")
    try:
        return correct_claim(session, json.loads(body))
    except ValueError as error:
        raise QueryError(f"the correction is no JSON: {error}") from None
    except InputError as error:
        raise QueryError(str(error)) from None
