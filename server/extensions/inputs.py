"""Questions of a running job and their answers, as files beside the jobs, so that they outlive the server.

<workspace>/.worldagent/inputs/<job>/questions.json   id -> request (`method` and `params`), written by the job
<workspace>/.worldagent/inputs/<job>/<id>.json        the answer, written by whoever got it from the client
"""

from __future__ import annotations

import json
import re
import secrets
import shutil
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ...execution import JobContext
from ...execution.schema import FOLDER
from ...worlds.errors import InputError
from ...worlds.folder import write_atomically

__all__ = ["ask", "give_answers", "open_questions"]

_NAME = re.compile(r"[a-z][a-z0-9_]{0,63}")
_POLL_S = 0.05


def ask(context: JobContext, questions: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """From inside a job: park until the client has answered every question; the answers by the questions' names.

    Args:
        context: The job's own context, which knows its workspace.
        questions: Requests to the client, e.g. `{"confirm": {"method": "elicitation/create", "params": {...}}}`.

    Raises:
        Cancelled: The job was cancelled meanwhile.
        InputError: A name is malformed, or the job has no workspace.
    """
    if context.workspace is None:
        raise InputError("a job without a workspace cannot ask its client")
    bad = [name for name in questions if not _NAME.fullmatch(name)]
    if bad or not questions:
        raise InputError(f"names of questions must match {_NAME.pattern}, got {bad or 'none'}")
    # An id never comes twice in a job's life, so that a late answer meets no other question.
    ids = {name: f"{name}-{secrets.token_hex(4)}" for name in questions}
    folder = _folder(Path(context.workspace), context.job_id)
    try:
        asked = {ids[name]: request for name, request in questions.items()}
        write_atomically(folder / "questions.json", json.dumps(asked).encode())
        while open_questions(Path(context.workspace), context.job_id):
            context.check()
            time.sleep(_POLL_S)
        return {name: json.loads((folder / f"{ids[name]}.json").read_bytes()) for name in questions}
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def open_questions(workspace: Path, job_id: str) -> dict[str, Any]:
    """Requests of a job that wait for an answer, by id; empty if there are none."""
    folder = _folder(workspace, job_id)
    try:
        questions: dict[str, Any] = json.loads((folder / "questions.json").read_bytes())
    except FileNotFoundError:
        return {}
    return {name: request for name, request in questions.items() if not (folder / f"{name}.json").is_file()}


def give_answers(workspace: Path, job_id: str, answers: Mapping[str, Any]) -> list[str]:
    """Hand answers to a job; ids that it does not wait for are left out. Returns the ids that were taken."""
    taken = [name for name in open_questions(workspace, job_id) if name in answers]
    for name in taken:
        write_atomically(_folder(workspace, job_id) / f"{name}.json", json.dumps(answers[name]).encode())
    return taken


def _folder(workspace: Path, job_id: str) -> Path:
    return workspace / FOLDER / "inputs" / job_id
