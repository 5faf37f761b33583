"""A review from the pictures to the ledger: what is asked is written to the world folder, a configured model is asked, answers are kept.

reviews/<first 16 digits of the digest>/  account.txt, questions.json, picture_<k>.<png or jpeg>
reviews/current.json                      which of them is of the newest bake
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from ...worlds.errors import EvidenceError, InputError, RefusedError
from ...worlds.folder import WorldFolder, write_atomically
from ...worlds.provenance import recipes
from ...worlds.reviews import NONE, Answer, Asked, Review, read_by, summary
from .endpoint import Endpoint, ReaderError, configured, say
from .pictures import ReviewPicture
from .questions import Answers, Questions, asked_of, parse_answers, parse_choice, prompts_to_choose
from .rivals import rival_prompts

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Row
    from ...worlds.spec import WorldSpec
    from ..session import Session

__all__ = ["Current", "answered", "asked_model", "current", "place_of", "prepare", "read_world", "readers_of", "rows_of_reviews"]

T = TypeVar("T")
ATTEMPTS = 2
"""Own choice: times that a model is asked where its answer cannot be read; the second time it is told what was wrong."""


class Current:
    """Questions about a bake, with their pictures."""

    def __init__(self, folder: WorldFolder, name: str, questions: Questions) -> None:
        self.folder, self.name, self.questions = folder, name, questions

    @property
    def place(self) -> str:
        """Its folder, relative to the world's."""
        return f"reviews/{self.name}"

    def pictures(self) -> list[ReviewPicture]:
        """The pictures, as they were when the questions were written.

        Raises:
            EvidenceError: one is missing, or not the one that was asked about.
        """
        paths = [self.picture_path(k) for k in range(1, len(self.questions.pictures) + 1)]
        return [ReviewPicture(k, path.read_bytes(), path.suffix[1:]) for k, path in enumerate(paths)]

    def picture_path(self, number: int) -> Path:
        """File of a picture, by its number from 1; errors as `pictures`."""
        root = self.folder.root / "reviews" / self.name
        for kind in ("png", "jpeg"):
            path = root / f"picture_{number}.{kind}"
            if path.is_file() and hashlib.sha256(path.read_bytes()).hexdigest() == self.questions.pictures[number - 1]:
                return path
        raise EvidenceError(f"picture {number} of {self.place} is missing or altered; call run_checks(scope='review') again")


def place_of(digest: str) -> str:
    """Name of the folder of a digest."""
    return digest[:16]


def prepare(folder: WorldFolder, candidate: Candidate) -> Current:
    """Write what readers of a candidate are asked, unless it is there, and make it the current one.

    Raises:
        EvidenceError: a channel of the candidate is missing or damaged.
        RefusedError: nothing of the prompt can be asked about.
    """
    from ...verifiers.account.text import account_of
    from .pictures import pictures_of

    spec = candidate.spec
    spans, left_out = asked_of(spec)
    if not spans:
        raise RefusedError(
            "nothing of the prompt is claimed, so that a reader can be asked about nothing; mark it with edit_spec first"
        )
    account = account_of(candidate)
    prompts, right = prompts_to_choose(spec.prompt, account.digest, rival_prompts(spec))
    there = _there(folder, candidate)
    if there is not None and there.questions.but_pictures() == (account.text, spans, left_out, prompts, right):
        return there
    pictures = pictures_of(candidate)
    digests = tuple(hashlib.sha256(p.data).hexdigest() for p in pictures)
    questions = Questions(account.text, digests, spans, left_out, prompts, right)
    name = place_of(questions.digest)
    root = folder.root / "reviews" / name
    for k, picture in enumerate(pictures, 1):
        write_atomically(root / f"picture_{k}.{picture.format}", picture.data)
    write_atomically(root / "account.txt", account.text.encode())
    write_atomically(root / "questions.json", json.dumps(asdict(questions), indent=1).encode())
    about = {"name": name, "digest": questions.digest, **_about(spec, candidate.digest)}
    write_atomically(folder.root / "reviews" / "current.json", json.dumps(about).encode())
    return Current(folder, name, questions)


def _there(folder: WorldFolder, candidate: Candidate) -> Current | None:
    """Questions that are written already, with their pictures: plates that came since would make them others, and answers void."""
    try:
        found = current(folder, candidate.spec, candidate.digest)
        if found is not None:
            found.pictures()
        return found
    except EvidenceError:
        return None


def _about(spec: WorldSpec, cache_digest: str) -> dict[str, str]:
    """Digests of the subject: all of the specification that a film depends on, and the caches."""
    return {"recipe": recipes(spec)["final"], "cache_digest": cache_digest}


def current(folder: WorldFolder, spec: WorldSpec, cache_digest: str | None = None) -> Current | None:
    """Questions about this specification and these caches (any, without a digest); None where none were written yet.

    Raises:
        EvidenceError: what was written is damaged.
    """
    path = folder.root / "reviews" / "current.json"
    if not path.is_file():
        return None
    about = folder.read_json(path)
    known = str(about.get("cache_digest")) if cache_digest is None else cache_digest
    if any(about.get(k) != v for k, v in _about(spec, known).items()):
        return None
    digest = str(about.get("digest"))
    told = folder.read_json(folder.root / "reviews" / place_of(digest) / "questions.json")
    try:
        questions = Questions(
            str(told["account"]),
            tuple(map(str, told["pictures"])),
            tuple(Asked(*map(str, s)) for s in told["spans"]),
            int(told["left_out"]),
            tuple(map(str, told["prompts"])),
            int(told["right"]),
        )
    except (KeyError, TypeError, ValueError) as error:
        raise EvidenceError(f"questions.json of review {place_of(digest)} is damaged ({error}); ask again") from error
    if questions.digest != digest:
        raise EvidenceError(f"questions.json of review {place_of(digest)} was altered; call run_checks(scope='review') again")
    return Current(folder, place_of(digest), questions)


# ---------------------------------------------------------------- answers


def answered(questions: Questions, reader: str, name: str, answers: Answers, choice: int | None) -> Review:
    """The review that answers by number make.

    Raises:
        InputError: a text or a number is out of range.
    """
    if choice is not None and not NONE <= choice <= len(questions.prompts):
        raise InputError(f"the choice {choice} is none of {NONE} to {len(questions.prompts)}")
    found: dict[str, Answer] = {questions.spans[k - 1].id: v for k, v in answers.answers.items()}
    because = {questions.spans[k - 1].id: v for k, v in answers.because.items()}
    right = None if choice is None else questions.right
    return Review(questions.digest, reader, name, found, choice, right, because)  # type: ignore[arg-type]


def asked_model(current: Current, endpoint: Endpoint, check: Callable[[], None]) -> Review:
    """The review of a model: first which prompt, then every span.

    Raises:
        ReaderError: it gave no answer that can be read.
        InputError: its key cannot be read.
    """
    questions, pictures = current.questions, current.pictures()
    # The spans would give the prompt away.
    choice = _read(endpoint, questions.choice_text(), pictures, check, lambda t: parse_choice(t, len(questions.prompts)))
    answers = _read(endpoint, questions.spans_text(), pictures, check, lambda t: parse_answers(t, len(questions.spans)))
    return answered(questions, "model", endpoint.name, answers, choice)


def _read(
    endpoint: Endpoint, text: str, pictures: Sequence[ReviewPicture], check: Callable[[], None], parse: Callable[[str], T]
) -> T:
    """Parsed reply of the model to a text; asked again where it cannot be read."""
    told, last = "", InputError("")
    for _ in range(ATTEMPTS):
        reply = say(endpoint, text + told, pictures, check)
        try:
            return parse(reply)
        except InputError as error:
            told, last = f"\n\nYour last answer could not be read: {error}", error
    raise ReaderError(f"{endpoint.name} gave {ATTEMPTS} answers that cannot be read: {last}")


def readers_of(session: Session, found: Current) -> tuple[list[Review], str]:
    """Reviews of what is asked now, and who has read it."""
    reviews = session.ledger.reviews(found.questions.digest)
    return reviews, read_by(reviews, [s.id for s in found.questions.spans])


def rows_of_reviews(session: Session, candidate: Candidate, found: Current) -> list[Row]:
    """Rows of all reviews of what is asked now."""
    from ...verifiers.review.rows import review_rows

    return review_rows(candidate, session.ledger.reviews(found.questions.digest), found.questions.spans, found.place)


def read_world(session: Session, candidate: Candidate, check: Callable[[], None], *, ask: bool = True) -> dict[str, Any]:
    """Ask the configured model about a bake, once per digest; without one, or without `ask`, only write what a reader needs.

    Raises:
        EvidenceError: a channel is missing or damaged.
        ReaderError: the model gave no answer that counts; nothing is recorded.
        InputError: the settings of the reader are wrong.
    """
    from ..rows import summary as rows_summary
    from ..standing import is_about_present

    endpoint = configured() if ask else None
    found = prepare(session.folder, candidate)
    reviews, _ = readers_of(session, found)
    # Asking until the answer suits would make every world read: the first answer about a digest stands.
    if endpoint is not None and not any(r.reader == "model" and r.name == endpoint.name for r in reviews):
        session.ledger.add_review(asked_model(found, endpoint, check))
    rows = rows_of_reviews(session, candidate, found)
    session.record(rows, stage="full", checks=("review",))
    reviews, reader = readers_of(session, found)
    known = session.ledger.acceptance()
    about = known is not None and known["record"].get("cache_digest") == candidate.digest
    about = about and known is not None and is_about_present(session.ledger, known, session.revision)
    return {
        "scope": "review",
        "read_by": reader,
        "accepted": about and known is not None and known["verdict"] == "accepted",
        "reviews": summary(reviews),
        "earlier_reviews": len(session.ledger.reviews()) - len(reviews),
        "asked": {"spans": len(found.questions.spans), "left_out": found.questions.left_out, "folder": found.place},
        **rows_summary(rows),
    }
