"""Contact sheets of films, for the eyes of whoever reads a report."""

from __future__ import annotations

from pathlib import Path

from ....rendering.sheet import contact_sheet
from ..metrics.film import Film
from .runs import Run

__all__ = ["film_sheet", "sheets_beside"]

PICTURES, COLUMNS = 12, 4
"""On a sheet."""
LARGEST = 300_000
"""Most bytes of a sheet's file."""


def film_sheet(film: Film) -> bytes:
    """Twelve frames from first to last with their times, as JPEG."""
    count = film.count
    wanted = sorted({round(k * (count - 1) / (PICTURES - 1)) for k in range(PICTURES)})
    pictures = {k: frame for k, frame in enumerate(film.frames()) if k in set(wanted)}
    return contact_sheet([pictures[k] for k in wanted], [f"{k / film.fps:.2f} s" for k in wanted], columns=COLUMNS, max_bytes=LARGEST)


def sheets_beside(run: Run, folder: Path) -> dict[str, bytes]:
    """Contact sheets that lie beside the report of a run, by name; names that lead elsewhere are passed over."""
    names = {s.sheet for s in run.samples if s.sheet and Path(s.sheet).name == s.sheet}
    return {name: (folder / name).read_bytes() for name in sorted(names) if (folder / name).is_file()}
