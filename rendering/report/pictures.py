"""Pictures of the matrix report: contact sheet, ledgers, and the first failing frame of rows that do not pass."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from ...worlds.accounts import Account
from ...worlds.candidate import Candidate
from ...worlds.errors import EvidenceError
from ..highlight import highlight
from ..plots.account import plot_account
from ..plots.ledger import plot_ledger
from ..preview import PreviewRenderer, preview
from ..sheet import contact_sheet, encode
from .page import ReportPictures

__all__ = ["report_pictures"]

SHEET_FRAMES = 12
MAX_ROW_PICTURES = 8
SHEET_BYTES, LEDGER_BYTES, ROW_BYTES = 350_000, 200_000, 70_000
"""Upper limits of the single pictures, so that a page stays below 2 MB."""


def report_pictures(candidate: Candidate, rows: Iterable[Mapping[str, Any]], *, account: Account | None = None) -> ReportPictures:
    """Draw a candidate for its report.

    Args:
        candidate: what was judged, of any stage.
        rows: its rows; failing ones get a picture first, at most `MAX_ROW_PICTURES` in all.
        account: the verifiers' ledgers; without one the solver's bare records are plotted.
    """
    renderer = PreviewRenderer(candidate)
    fps = candidate.spec.simulation.fps
    frames = sorted(set(np.linspace(0, candidate.last_frame, SHEET_FRAMES).round().astype(int).tolist()))
    tiles = [preview(candidate, k, width=440, height=248, renderer=renderer) for k in frames]
    columns = min(4, len(tiles))
    sheet = contact_sheet(tiles, [f"frame {k}  {k / fps:.2f} s" for k in frames], columns=columns, max_bytes=SHEET_BYTES)
    try:
        plotted = plot_ledger(candidate, width=1000, height=620) if account is None else plot_account(candidate, account)
        ledger = encode(plotted, LEDGER_BYTES).data
    except EvidenceError:  # nothing recorded: the rows say so
        ledger = None
    found: dict[str, tuple[str, bytes]] = {}
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
    return ReportPictures(sheet, ledger, found)
