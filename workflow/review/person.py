"""A person reads: what the page shows of the present questions, and what a person answers."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...execution import JobStore, Terms, memory_cap, wall_cap
from ...worlds.errors import InputError, RefusedError
from ...worlds.limits import CAPS
from ...worlds.reviews import NONE, Review, standing_of, summary
from ..job_kinds import ENTRIES, KINDS
from .conduct import Current, answered, current, readers_of
from .questions import parse_answers

if TYPE_CHECKING:
    from ..session import Session

__all__ = ["answer_of_person", "picture_file", "rows_anew", "to_read"]

KEYS = {"digest", "name", "choice", "answers", "because"}
MOST_NAME = 80


def _current(session: Session) -> Current:
    """Questions about the present bake.

    Raises:
        RefusedError: nothing is.
    """
    found = current(session.folder, session.spec)
    if found is None:
        raise RefusedError("nothing is to be read yet: bake the world, then call run_checks(scope='review')")
    return found


def to_read(session: Session) -> dict[str, Any]:
    """All that a person gets to read, and what stands so far, as JSON.

    Raises:
        RefusedError: nothing is asked yet.
        EvidenceError: what was written is damaged.
    """
    found = _current(session)
    questions = found.questions
    reviews, reader = readers_of(session, found)
    return {
        "digest": questions.digest,
        "account": questions.account,
        "pictures": len(questions.pictures),
        "prompts": list(questions.prompts),
        "right": questions.right,
        "spans": [
            {"number": k, "quote": s.quote, "type": s.type, **_standing(reviews, s.id)} for k, s in enumerate(questions.spans, 1)
        ],
        "left_out": questions.left_out,
        "read_by": reader,
        "reviews": summary(reviews),
    }


def _standing(reviews: list[Review], claim: str) -> dict[str, Any]:
    found = standing_of(reviews, claim)
    if found is None:
        return {}
    because = found.review.because.get(claim, "")
    return {"answer": found.answer, "by": f"{found.review.reader} {found.review.name}".strip(), "because": because}


def picture_file(session: Session, number: str) -> Path:
    """File of a picture, by its number from 1.

    Raises:
        InputError: there is none of this number.
    """
    found = _current(session)
    if not (number.isascii() and number.isdecimal() and 1 <= int(number) <= len(found.questions.pictures)):
        raise InputError(f"there is no picture {number[:20]!r}; there are 1 to {len(found.questions.pictures)}")
    return found.picture_path(int(number))


def answer_of_person(session: Session, document: Any) -> Review:
    """Record what a person answered; a part is enough to overrule a model, all of it makes the world read by a person.

    Args:
        session: of the world.
        document: `digest` of what was read, `name` of the person, `choice` of the prompt (0 for none), `answers` and `because` by number.

    Raises:
        InputError: something is missing or out of range.
        RefusedError: the questions are others now.
    """
    if not isinstance(document, Mapping) or set(document) - KEYS:
        raise InputError(f"a review is a JSON object with the keys {', '.join(sorted(KEYS))}")
    found = _current(session)
    questions = found.questions
    if document.get("digest") != questions.digest:
        raise RefusedError("the world was baked or edited since this was read; load the page again")
    name = str(document.get("name") or "").strip()
    if not 1 <= len(name) <= MOST_NAME:
        raise InputError(f"the name has {len(name)} characters; give 1 to {MOST_NAME}, it stands beside the answers")
    told = {"answers": document.get("answers", {}), "because": document.get("because", {})}
    answers = parse_answers(json.dumps(told), len(questions.spans), partly=True)
    choice = document.get("choice")
    if choice is not None and (not isinstance(choice, int) or isinstance(choice, bool)):
        raise InputError(
            f"the choice is {choice!r}; it must be a whole number from {NONE} to {len(questions.prompts)}, or left out"
        )
    if not answers.answers and choice is None:
        raise InputError("nothing is answered; give answers about at least one part")
    review = answered(questions, "person", name, answers, choice)
    session.ledger.add_review(review)
    return review


def rows_anew(session: Session, jobs: JobStore) -> str:
    """Start the job that writes the rows of the answers into the matrix; its id. No model is asked in it."""
    kind = KINDS["review"]
    count = len(session.ledger.reviews())
    job = jobs.submit(
        "review",
        session.folder.id,
        {"folder": str(session.folder.root), "revision": session.revision, "ask": False},
        entry=f"{ENTRIES}:review",
        terms=Terms(
            key=f"review:person:{session.stamp()}:{count}",
            exclusive=True,
            priority=kind.priority,
            wall_s=wall_cap("review", min(kind.wall_s, CAPS["job_seconds"].value)),
            memory_bytes=memory_cap(CAPS["job_memory_bytes"].value),
            warm=True,
        ),
    )
    return job.id
