"""Questions of reviews: of each claim, and of the choice among prompts."""

from __future__ import annotations

from ..rows.questions import Question

__all__ = ["CHOICE", "CLAIM", "QUESTIONS"]

CLAIM = Question(
    "review:claim",
    "a reader who did not make the world finds what the prompt says in {0} shown, and not contradicted",
    subject=("claim",),
    order="review:{0}",
)
CHOICE = Question(
    "review:choice", "a reader who did not make the world takes its prompt for the world's, among others", order="review"
)

QUESTIONS = (CLAIM, CHOICE)
