"""Encoded pictures of a report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

__all__ = ["ReportPictures"]


@dataclass(frozen=True)
class ReportPictures:
    """Encoded pictures (PNG or JPEG) of a candidate."""

    sheet: bytes | None = None
    """Contact sheet over all frames."""
    ledger: bytes | None = None
    """Plots of energy, momentum, gaps and contacts."""
    rows: Mapping[str, tuple[str, bytes]] = field(default_factory=dict)
    """Per row id: caption, and the picture of its first failing frame."""
    shown: Sequence[tuple[str, bytes]] = ()
    """Captions and pictures of what spans of the prompt are about."""
    claims: Mapping[str, int] = field(default_factory=dict)
    """Per claim: which of `shown`."""
