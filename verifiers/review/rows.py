"""Rows of reviews. Contradicted fails, shown passes; not shown is `unverified` and not mandatory; where nobody read there is no row."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from ...worlds.reviews import NONE, READERS, Answer, Asked, Review, standing_of
from ..rows.answers import row_of
from ..rows.corrections import correction
from ..rows.findings import Finding
from .questions import CHOICE, CLAIM

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Correction, Row, Status

__all__ = ["review_rows"]

STATUS: Mapping[Answer, Status] = {"shown": "pass", "contradicted": "fail", "not shown": "unverified"}


def review_rows(candidate: Candidate, reviews: Sequence[Review], asked: Sequence[Asked], artifact: str) -> list[Row]:
    """One row per claim that a reader was asked about, and one for the choice among prompts.

    Args:
        candidate: what was read about.
        reviews: of its present digest.
        asked: spans of the present specification.
        artifact: folder of the account and the pictures, relative to the world's.
    """
    rows = [row for span in asked for row in _of_claim(candidate, reviews, span, artifact)]
    return rows + _of_choice(candidate, reviews, artifact)


def _said(review: Review) -> dict[str, object]:
    return {"reader": review.reader, "name": review.name, "digest": review.digest, "at": review.at}


def _of_claim(candidate: Candidate, reviews: Sequence[Review], span: Asked, artifact: str) -> list[Row]:
    found = standing_of(reviews, span.id)
    if found is None:
        return []
    who = f"{found.review.reader} {found.review.name!r}"
    reason = found.review.because.get(span.id, "")
    evidence: dict[str, object] = {**_said(found.review), "quote": span.quote, **({"because": reason} if reason else {})}
    text = f"{who} finds {span.quote!r} {found.answer}" + (f": {reason}" if reason else "")
    if found.overruled is not None:
        evidence["overruled"] = {**_said(found.overruled), "because": found.overruled.because.get(span.id, "")}
        text += f"; overrules {found.overruled.reader} {found.overruled.name!r}, who found it contradicted"
    status = STATUS[found.answer]
    hints = () if status == "pass" else _hints(span)
    finding = Finding(status, text, hints=hints, evidence=evidence)
    row = row_of(candidate, CLAIM, (span.id,), finding, extra=found.review.digest, artifact=artifact)
    # A reader that sees nothing proves nothing, for the claim or against it: acceptance does not wait for it.
    return [row.model_copy(update={"mandatory": status != "unverified"})]


def _do_it(cause: str, text: str) -> Correction:
    action = f"read inspect_world(part='account') beside {text}, and make the world do what it says"
    return correction(cause, "story", action, pointers=("/story",))


def _hints(span: Asked) -> tuple[Correction, ...]:
    return (
        _do_it("the world does not do what the prompt says", repr(span.quote)),
        correction("the cameras do not show it", "shots", "show it in a shot, near and unhidden", pointers=("/shots",)),
    )


def _of_choice(candidate: Candidate, reviews: Sequence[Review], artifact: str) -> list[Row]:
    chosen = [r for r in reviews if r.choice is not None]
    if not chosen:
        return []
    best = max(chosen, key=lambda r: READERS.index(r.reader))
    same = [r for r in chosen if r.reader == best.reader]
    wrong = next((r for r in same if r.choice not in (r.right, NONE)), None)
    review = same[-1] if best.reader == "person" else wrong or same[-1]
    right, none = review.choice == review.right, review.choice == NONE
    text = f"{review.reader} {review.name!r} takes {'the prompt' if right else 'no prompt' if none else 'another prompt'} for the world's"
    finding = Finding(
        "pass" if right else "unverified" if none else "fail",
        text,
        hints=(_do_it("the world shows another prompt better than its own", "the prompt"),),
        evidence=_said(review),
    )
    row = row_of(candidate, CHOICE, (), finding, extra=review.digest, artifact=artifact)
    return [row.model_copy(update={"mandatory": not none})]
