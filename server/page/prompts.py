"""The prompt of a world for the page: its spans, what judges them, and the picture that shows each best."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from ...worlds.claim_marks import marked_claims
from ...worlds.claims import prompt_record
from ...worlds.errors import WorldAgentError
from ...worlds.judged_spans import CLAIM_CHECKS, SPAN_SIGNS, JudgedSpan, first_shown, judged_spans, span_words
from ...worlds.patch import parse_spec
from ...worlds.requirements import Row
from ...worlds.spec import WorldSpec

__all__ = ["judged_prompt"]

_VIEWS = ("preview", "still")
"""Kinds of picture of a single frame, as a camera sees it."""
_TOLD = ("claimed", "filler", "waived", "language", "warnings")


def judged_prompt(
    document: Mapping[str, Any],
    rows: Sequence[Row],
    pictures: Sequence[Mapping[str, Any]],
    plates: Callable[[WorldSpec], Sequence[Mapping[str, Any]]] = lambda spec: (),
) -> dict[str, Any] | None:
    """The prompt as JSON, its spans judged by the present matrix; None for a world of version 1, or one that cannot be read.

    Args:
        document: the specification as JSON.
        rows: of the matrix.
        pictures: of the world, the newest first, see `picture_list`.
        plates: of the present bake, see `plate_list`.
    """
    try:
        spec = parse_spec(dict(document))
    except WorldAgentError:
        return None
    if spec.spec_version == "1":
        return None
    told = prompt_record(spec)
    judged = [r.model_dump(mode="json") for r in rows if r.check in CLAIM_CHECKS]
    spans = judged_spans(told, judged)
    views = [p for p in pictures if p["kind"] in _VIEWS and "frame" in p and not p.get("older")]
    true = {str(r["id"]): (r.get("evidence") or {}).get("first_true_frame") for r in judged}
    shown = plates(spec)
    return {
        "spans": [_span(s, _nearest(views, _moment(spec, s, true)), _plate(spec, s, shown, true)) for s in spans],
        "first": first_shown(spans),
        "marked": marked_claims(spec),
        **{k: told[k] for k in _TOLD},
    }


def _span(span: JudgedSpan, picture: Mapping[str, Any] | None, plate: Mapping[str, Any] | None) -> dict[str, Any]:
    if span.claim is None:
        return {"text": span.text, "state": span.state}
    return {
        "text": span.text,
        "state": span.state,
        "sign": SPAN_SIGNS[span.state],
        "claim": span.claim,
        "type": span.type,
        "by": span.by,
        "waived": span.waived,
        "rows": span.rows,
        "words": span_words(span),
        "picture": picture,
        **({} if plate is None else {"plate": plate}),
    }


def _plate(
    spec: WorldSpec, span: JudgedSpan, plates: Sequence[Mapping[str, Any]], true: Mapping[str, Any]
) -> Mapping[str, Any] | None:
    """The plate of a body that a span is about, nearest to its moment."""
    beats = [spec.story.beats[b].subject for b in span.named("/story/beats") if b in spec.story.beats]
    own = [p for p in plates if p["subject"] in (beats or span.named("/entities"))]
    return _nearest(own, _moment(spec, span, true))


def _moment(spec: WorldSpec, span: JudgedSpan, true: Mapping[str, Any]) -> int | None:
    """Frame at which the beat of a span came true, or has to; None where it has no beat."""
    beat = next((b for b in span.named("/story/beats") if b in spec.story.beats), None)
    if beat is None:
        things = span.named("/entities")
        beat = next((b for b in spec.story.beats if spec.story.beats[b].subject in things), None)
    if beat is None:
        return None
    come = true.get(f"beat:{beat}")
    return come if isinstance(come, int) else spec.story.beats[beat].frames[1]


def _nearest(pictures: Sequence[Mapping[str, Any]], frame: int | None) -> Mapping[str, Any] | None:
    """The picture nearest to a frame; the newest of those."""
    if frame is None:
        return pictures[0] if pictures else None
    return min(pictures, key=lambda p: abs(p["frame"] - frame), default=None)
