"""Answers to single words of a claim, and the finding that they make together."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, NamedTuple

from ...rows.corrections import correction
from ...rows.findings import Finding

if TYPE_CHECKING:
    from ...rows.questions import Comparison

__all__ = ["Answer", "finding_of"]


_TOLD = "run it again with probe_sim and bake_sim, so that its frames tell who bears it, or let one rigid body have that posture there"
"""Next step where no record tells of a posture."""


class Answer(NamedTuple):
    """Measurement for one word, and what it came to."""

    word: str
    ok: bool | None
    """None where no record tells."""
    text: str
    """A sentence with numbers."""
    measured: float | None = None
    bound: float | None = None
    comparison: Comparison = ">="
    unit: str = "1"


def finding_of(
    quote: str, answers: Sequence[Answer], *, group: str, action: str, pointers: Iterable[str], entities: Iterable[str] = ()
) -> Finding:
    """The finding of a claim: every word must hold; numbers are those of the first that does not, or of which nothing tells.

    Args:
        quote: of the claim.
        answers: one per word at least.
        group: parameter group of what mends it.
        action: what mends it.
        pointers: places of it.
        entities: what was looked at.
    """
    missed = next((a for a in answers if a.ok is False), None)
    worst = missed or next((a for a in answers if a.ok is None), answers[0])
    ok = all(a.ok for a in answers)
    said = f"{quote!r}: " + "; ".join(a.text for a in (answers if ok else [worst]))
    hints = () if ok else (correction(said, group, action if missed else _TOLD, pointers=tuple(pointers)),)
    return Finding(
        "pass" if ok else "fail" if missed else "unverified",
        said,
        worst.measured,
        worst.bound,
        worst.unit if worst.measured is not None else "",
        hints=hints,
        comparison=worst.comparison,
        entities=tuple(dict.fromkeys(entities)),
        evidence={"quote": quote, "words": [a.word for a in answers]},
    )
