"""Reviews: answers of somebody who did not make the world about what its prompt says, and who they are (R155).

A review cannot be replayed. It is about one digest: of the account, the pictures, the spans and the prompts to choose among.
"""

from __future__ import annotations

import json
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, Literal, NamedTuple, get_args

from .errors import InputError
from .ledger_file import LedgerFile, check_seal, put_seal

__all__ = [
    "ANSWERS",
    "NONE",
    "READERS",
    "Answer",
    "Asked",
    "Reader",
    "Review",
    "ReviewLedger",
    "Standing",
    "read_by",
    "standing_of",
    "summary",
]

Answer = Literal["shown", "contradicted", "not shown"]
Reader = Literal["client", "model", "person"]
ANSWERS: tuple[str, ...] = get_args(Answer)
READERS: tuple[str, ...] = get_args(Reader)
"""Kinds of reader; a later one outranks an earlier one."""
NONE = 0
"""Choice of a reader who takes none of the prompts for the world's; prompts are numbered from 1."""
MOST_TEXT = 500
"""Characters of a reason, or of a reader's name."""


class Asked(NamedTuple):
    """A span of the prompt that a reader is asked about."""

    id: str
    """Id of its claim; readers see a number instead."""
    quote: str
    type: str


@dataclass(frozen=True)
class Review:
    """Answers of one reader."""

    digest: str
    """Digest of the question."""
    reader: Reader
    name: str
    """Name of the model, or of the client; whatever a person calls themselves."""
    answers: Mapping[str, Answer]
    """By id of the claim; a person may answer a part."""
    choice: int | None = None
    """Number of the prompt that was chosen, `NONE` for none; None where it was not asked."""
    right: int | None = None
    """Number of the world's own prompt among them."""
    because: Mapping[str, str] = field(default_factory=dict)
    """Reasons by id of the claim."""
    at: float = 0.0
    """[s] since 1970."""

    def __post_init__(self) -> None:
        """Refuses what is no review.

        Raises:
            InputError: an answer, a kind of reader or a text is out of range.
        """
        if self.reader not in READERS:
            raise InputError(f"reader {self.reader!r} is none of {', '.join(READERS)}")
        for claim, answer in self.answers.items():
            if answer not in ANSWERS:
                raise InputError(f"answer {str(answer)[:40]!r} about {claim!r} is none of {', '.join(ANSWERS)}")
        longest = max((len(t) for t in (self.name, *self.because.values())), default=0)
        if longest > MOST_TEXT:
            raise InputError(f"a text of a review has {longest} characters, at most {MOST_TEXT} are kept; shorten it")

    @property
    def contradicts(self) -> bool:
        """True where it finds a claim contradicted, or takes another prompt for the world's."""
        return "contradicted" in self.answers.values() or self.choice not in (None, NONE, self.right)


class ReviewLedger(LedgerFile):
    """The table of reviews in a ledger; nothing in it is ever changed."""

    def add_review(self, review: Review) -> None:
        """Append a review."""
        text = json.dumps({**asdict(review), "at": review.at or time.time()}, sort_keys=True)
        with self._write() as db:
            number = db.execute("INSERT INTO reviews (digest, record) VALUES (?,?)", (review.digest, text)).lastrowid
            put_seal(db, f"review:{number}", review.digest, text)

    def reviews(self, digest: str | None = None) -> list[Review]:
        """Reviews of one digest, or all, oldest first."""
        with self._open() as db:
            found = []
            for row in db.execute("SELECT n, digest, record FROM reviews ORDER BY n").fetchall():
                check_seal(db, f"review:{row['n']}", row["digest"], row["record"])
                if digest in (None, row["digest"]):
                    found.append(Review(**json.loads(row["record"])))
        return found


class Standing(NamedTuple):
    """Answer that counts about one claim."""

    answer: Answer
    review: Review
    overruled: Review | None
    """A model or client that had found a contradiction which a person does not see."""


def standing_of(reviews: Sequence[Review], claim: str) -> Standing | None:
    """The answer that counts: a person's latest, else that of models, else the client's; of several, the one that contradicts.

    None where nobody was asked.
    """
    asked = [r for r in reviews if claim in r.answers]
    found: Review | None = None
    for kind in READERS:
        own = [r for r in asked if r.reader == kind]
        if own:
            found = own[-1] if kind == "person" else next((r for r in own if r.answers[claim] == "contradicted"), own[-1])
    if found is None:
        return None
    answer = found.answers[claim]
    against = [r for r in asked if r.reader != "person" and r.answers[claim] == "contradicted"]
    return Standing(answer, found, against[-1] if against and found.reader == "person" and answer != "contradicted" else None)


def read_by(reviews: Iterable[Review], claims: Iterable[str]) -> str:
    """Who has read a world: `person`, `model`, `client`, or `nobody`.

    Args:
        reviews: of the digest that the world has now.
        claims: ids that must be answered, by one reader, to count as read.
    """
    whole = set(claims)
    kinds = {r.reader for r in reviews if whole <= r.answers.keys() and r.answers}
    return next((kind for kind in reversed(READERS) if kind in kinds), "nobody")


def summary(reviews: Sequence[Review]) -> list[dict[str, Any]]:
    """Reviews in short, as acceptance records and replies hold them."""
    return [
        {
            "reader": r.reader,
            "name": r.name,
            "digest": r.digest,
            "at": r.at,
            "counts": {a: sum(v == a for v in r.answers.values()) for a in ANSWERS},
            "contradicted": [c for c, a in r.answers.items() if a == "contradicted"],
            **({} if r.choice is None else {"chose_the_prompt": r.choice == r.right}),
        }
        for r in reviews
    ]
