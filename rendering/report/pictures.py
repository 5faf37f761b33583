"""Pictures of the matrix report: contact sheet, ledgers, and the first failing frame of rows that do not pass."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from ...worlds.accounts import Account
from ...worlds.arrays import U8
from ...worlds.candidate import Candidate
from ...worlds.errors import EvidenceError
from ...worlds.judged_spans import SPAN_STATES, JudgedSpan, judged_spans
from ...worlds.plates import View as PlateView
from ...worlds.plates import plate_pictures
from ...worlds.predicates import entities_of
from ..highlight import highlight
from ..plots.account import plot_account
from ..plots.ledger import plot_ledger
from ..preview import PreviewRenderer, preview
from ..sheet import contact_sheet, encode
from .encoded import ReportPictures

__all__ = ["report_pictures", "report_sheet"]

SHEET_FRAMES = 12
MAX_ROW_PICTURES = 8
MAX_SHOWN = 12
"""Pictures of what spans of the prompt are about; several spans may share one."""
SHEET_BYTES, LEDGER_BYTES, ROW_BYTES, SHOWN_BYTES = 320_000, 200_000, 60_000, 32_000
"""Upper limits of the single pictures, so that a page stays below 2 MB."""


def report_sheet(candidate: Candidate, renderer: PreviewRenderer | None = None) -> bytes:
    """Contact sheet over all frames of a candidate, as JPEG; whoever waits for a verdict may draw it meanwhile."""
    renderer, fps = renderer or PreviewRenderer(candidate), candidate.spec.simulation.fps
    frames = sorted(set(np.linspace(0, candidate.last_frame, SHEET_FRAMES).round().astype(int).tolist()))
    tiles = [preview(candidate, k, width=440, height=248, renderer=renderer) for k in frames]
    labels = [f"frame {k}  {k / fps:.2f} s" for k in frames]
    return contact_sheet(tiles, labels, columns=min(4, len(tiles)), max_bytes=SHEET_BYTES)


def report_pictures(
    candidate: Candidate,
    rows: Iterable[Mapping[str, Any]],
    *,
    sheet: Callable[[], bytes] | None = None,
    account: Account | None = None,
    record: Mapping[str, Any] | None = None,
) -> ReportPictures:
    """Draw a candidate for its report.

    Args:
        candidate: what was judged, of any stage.
        rows: its rows; failing ones get a picture first, at most `MAX_ROW_PICTURES` in all.
        sheet: gives the contact sheet where it was drawn before.
        record: of the judgement; with it the spans of the prompt get pictures, at most `MAX_SHOWN`.
        account: the verifiers' ledgers; without one the solver's bare records are plotted.
    """
    renderer = PreviewRenderer(candidate)
    fps = candidate.spec.simulation.fps
    drawn = report_sheet(candidate, renderer) if sheet is None else sheet()
    try:
        plotted = plot_ledger(candidate, width=1000, height=620) if account is None else plot_account(candidate, account)
        ledger = encode(plotted, LEDGER_BYTES).data
    except EvidenceError:  # nothing recorded: the rows say so
        ledger = None
    rows, found = list(rows), dict[str, tuple[str, bytes]]()
    for row in sorted(rows, key=lambda r: (r["status"] != "fail", not r["mandatory"], r["id"])):
        concerned = dict.fromkeys((row.get("first_failing_entity"), *(row.get("entities") or ())))
        names = [n for n in concerned if n in candidate.built][:2]
        if row["status"] not in ("fail", "unverified") or not names or len(found) >= MAX_ROW_PICTURES:
            continue
        frame = min(max(int(row.get("first_failing_frame") or 0), 0), candidate.last_frame)
        image = highlight(candidate, frame, names, renderer=renderer)
        found[row["id"]] = (
            f"{', '.join(names)} at frame {frame} ({frame / fps:.2f} s)",
            encode(image, ROW_BYTES).data,
        )
    return ReportPictures(drawn, ledger, found, *_spans(candidate, record or {}, rows, renderer))


# ---------------------------------------------------------------- spans of the prompt

View = tuple[int, tuple[str, ...]]
"""Frame, and the entities to mark."""


def _spans(
    candidate: Candidate, record: Mapping[str, Any], rows: Sequence[Mapping[str, Any]], renderer: PreviewRenderer
) -> tuple[list[tuple[str, bytes]], dict[str, int]]:
    """Pictures of what the spans of a prompt are about, plates where there are any, and which of them shows which claim; the worst judged first."""
    spans = [s for s in judged_spans(record.get("prompt") or {}, rows) if s.claim is not None]
    shown: dict[View, int] = {}
    pictures: list[tuple[str, bytes]] = []
    claims: dict[str, int] = {}
    plates = plate_pictures(candidate)
    fps, size = candidate.spec.simulation.fps, {"width": 480, "height": 270}
    for span in sorted(spans, key=lambda s: (SPAN_STATES.index(s.state), s.type != "event")):
        view = _view(candidate, span, (record.get("events") or {}).get("beats") or {})
        plate = _plate(plates, *view)
        view = view if plate is None else (plate.frame, (plate.subject,))
        if view not in shown:
            if len(pictures) == MAX_SHOWN:
                continue
            frame, names = view
            told = f"frame {frame} ({frame / fps:.2f} s)"
            if plate is not None:
                image, told = plates[plate], f"{told}, {plate.subject} in the light of the film"
            else:
                image = highlight(candidate, frame, names, renderer=renderer, **size)
                told += f", {' and '.join(names)} marked" if names else ""
            shown[view] = len(pictures)
            pictures.append((told, encode(image, SHOWN_BYTES).data))
        claims[str(span.claim)] = shown[view]
    return pictures, claims


def _plate(plates: Mapping[PlateView, U8], frame: int, names: Sequence[str]) -> PlateView | None:
    """The plate of the first of some bodies, nearest to a frame; None where there is none."""
    own = [v for v in plates if v.subject in names[:1]]
    return min(own, key=lambda v: abs(v.frame - frame), default=None)


def _view(candidate: Candidate, span: JudgedSpan, true: Mapping[str, int | None]) -> View:
    """The moment and the bodies that show a span best: its beat as it comes true, its things in a beat of their own."""
    story, last = candidate.spec.story, candidate.last_frame
    beat = next((b for b in span.named("/story/beats") if b in story.beats), None)
    asked = next((r for r in span.named("/story/requirements") if r in story.requirements), None)
    things = [n for n in span.named("/entities") if n in candidate.built]
    frame = 0
    if beat is not None:
        things = [story.beats[beat].subject, *entities_of(story.beats[beat].predicate)]
    elif asked is not None:
        things, frame = list(entities_of(story.requirements[asked].predicate)), last
    else:
        beat = next((b for b in story.beats if story.beats[b].subject in things), None)
    if beat is not None:
        come = true.get(beat)
        frame = story.beats[beat].frames[1] if come is None else come
    names = tuple(dict.fromkeys(n for n in things if n in candidate.built))[:2]
    return min(max(frame, 0), last), names
