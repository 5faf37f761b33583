"""A client reads: what its model, or the user behind it, is asked where nobody else has read, and its answers. It counts as `client`."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from ...worlds.errors import InputError, WorldAgentError
from ...worlds.reviews import ANSWERS, Review
from ..session import Session
from .conduct import answered, current, readers_of
from .endpoint import configured
from .questions import parse_answers, parse_choice

if TYPE_CHECKING:
    from .pictures import ReviewPicture
    from .questions import Questions

__all__ = ["ClientAsked", "asked_of_client", "form_of", "recorded"]

MOST_FIELDS = 40
"""Own choice: most parts that a form asks about; nobody fills in more."""


class ClientAsked(NamedTuple):
    """Questions for a client, with what is needed to record its answers."""

    session: Session
    questions: Questions
    pictures: list[ReviewPicture]


def asked_of_client(workspace: Path, world: str) -> ClientAsked | None:
    """Questions for a client; None where a model is named, somebody has read the world, or nothing is asked."""
    try:
        session = Session.open(workspace, world)
        found = current(session.folder, session.spec)
        if found is None or configured() is not None or readers_of(session, found)[1] != "nobody":
            return None
        return ClientAsked(session, found.questions, found.pictures())
    except WorldAgentError:  # the call that comes before has told it
        return None


def form_of(asked: ClientAsked) -> tuple[str, dict[str, Any]]:
    """Text and schema of a form about the parts of the prompt; without the choice, which the parts would give away."""
    spans = asked.questions.spans[:MOST_FIELDS]
    message = (
        f"Compare what happens with the prompt {json.dumps(asked.questions.prompts[asked.questions.right - 1], ensure_ascii=False)}. "
        f"Is each part shown, contradicted, or not shown?\n\n{asked.questions.account}"
    )
    fields = {
        f"part_{k}": {"type": "string", "title": f"{s.quote} ({s.type})"[:200], "enum": list(ANSWERS)}
        for k, s in enumerate(spans, 1)
    }
    return message, {"type": "object", "properties": fields, "required": list(fields)}


def recorded(asked: ClientAsked, name: str, choice: str | None, spans: str | Mapping[str, Any]) -> Review:
    """Record answers of a client.

    Args:
        asked: what it was asked.
        name: of the model, or of the client.
        choice: reply about the prompts; None where it was not asked.
        spans: reply about the parts, or the content of the form.

    Raises:
        InputError: something is missing or out of range.
    """
    questions = asked.questions
    chosen = None if choice is None else parse_choice(choice, len(questions.prompts))
    if isinstance(spans, str):
        answers = parse_answers(spans, len(questions.spans))
    else:
        told = {str(k).removeprefix("part_"): v for k, v in spans.items()}
        answers = parse_answers(json.dumps({"answers": told}), min(len(questions.spans), MOST_FIELDS))
    if not answers.answers:
        raise InputError("nothing is answered")
    review = answered(questions, "client", name.strip()[:80] or "client", answers, chosen)
    asked.session.ledger.add_review(review)
    return review
