"""Reviews in a verdict: the acceptance takes them in, `verify` shows them and compares digests. They cannot be replayed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ...worlds.ablation import ABLATED
from ...worlds.errors import EvidenceError
from ...worlds.requirements import Row
from ...worlds.reviews import Review, summary
from .conduct import current, readers_of, rows_of_reviews

if TYPE_CHECKING:
    from ...worlds.built import BuiltEntity
    from ...worlds.folder import WorldFolder
    from ...worlds.ledger import Ledger
    from ..session import Session

__all__ = ["not_of_reviews", "reviewed", "shown_reviews"]

PREFIX = "review"


def reviewed(session: Session, built: Mapping[str, BuiltEntity], freeze: str, record: dict[str, Any]) -> list[Row]:
    """Rows of an acceptance with those of the reviews of this very bake; the record is completed in place.

    A contradiction that nobody overruled makes the verdict `incomplete`. `read_by` is `nobody` where no review is of it.
    """
    from ...verifiers.acceptance import verdict_of
    from ...worlds.candidate import open_candidate

    rows = [Row.model_validate(r) for r in record["rows"]]
    record |= {"read_by": "nobody", "reviews": [], "earlier_contradictions": 0}
    known = session.ledger.reviews()
    found = current(session.folder, session.spec, record["cache_digest"])
    if found is not None:
        candidate = open_candidate(session.folder, freeze, "full", built)
        rows += rows_of_reviews(session, candidate, found)
        reviews, reader = readers_of(session, found)
        record |= {"read_by": reader, "reviews": summary(reviews)}
        known = [r for r in known if r.digest != found.questions.digest]
        record["rows"] = [r.model_dump(mode="json") for r in rows]
        if record["verdict"] in ("accepted", ABLATED):
            record["verdict"] = verdict_of(rows)
    # Of other pictures, motions or words: who edits until a reader is content leaves these behind.
    record["earlier_contradictions"] = sum(r.contradicts for r in known)
    if "prompt" in record:
        record["prompt"]["read_by"] = record["read_by"]
    return rows


def not_of_reviews(rows: Iterable[Any]) -> list[Any]:
    """Rows of a record without those of reviews, which no installation can judge again."""
    return [r for r in rows if not (isinstance(r, Mapping) and str(r.get("id")).partition(":")[0] == PREFIX)]


def shown_reviews(folder: WorldFolder, ledger: Ledger, freeze: str) -> list[dict[str, Any]]:
    """Reviews in a ledger, each with what its digest says here: of this very bake, or of another.

    The account is written again from the caches; pictures are compared with the digests that the reader was asked about.
    """
    from ...verifiers.account.text import account_of
    from ...worlds.candidate import open_candidate

    reviews = ledger.reviews()
    if not reviews:
        return []
    candidate = open_candidate(folder, freeze, "full")
    try:
        found = current(folder, candidate.spec, candidate.digest)
        told = "of another bake, or of questions that are not there" if found is None else ""
        if found is not None and found.questions.account != account_of(candidate).text:
            told = "of an account that this installation does not get from these caches"
        elif found is not None:
            found.pictures()
    except EvidenceError as error:
        found, told = None, str(error)
    return [
        {**line, "standing": _standing(review, found.questions.digest if found else "", told)} for line, review in _lines(reviews)
    ]


def _lines(reviews: Sequence[Review]) -> Iterable[tuple[dict[str, Any], Review]]:
    return zip(summary(reviews), reviews, strict=True)


def _standing(review: Review, digest: str, told: str) -> str:
    """Words for what a review is worth: whether it is of the present account, pictures and spans."""
    if told:
        return told
    return "of this very bake" if review.digest == digest else "of another bake, or of other parts of the prompt"
