"""An engine that gave up, on record beside the frames that it had written: where, when, and with which bodies."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path

from .folder import write_atomically

__all__ = ["GaveUp", "forget", "note", "noted"]

FILE = "gave_up.json"


@dataclass(frozen=True)
class GaveUp:
    """The end that an engine made of a run."""

    solver: str
    """The instance."""
    frame: int
    """That was to be reached."""
    text: str
    """Sentence of the error, with what to change."""
    entities: tuple[str, ...] = ()
    """Whose motion it was, that first, then what touched it; none where nobody knows."""
    place: tuple[float, float, float] | None = None
    """Where it was in the last whole step [m]."""


def note(run: Path, ended: GaveUp) -> None:
    """Write it into the folder of a run."""
    write_atomically(run / FILE, json.dumps(asdict(ended)).encode())


def noted(run: Path, solver: str, reached: int) -> GaveUp | None:
    """The end of an instance's run, where it stands at an earlier frame than that; None of one that went on.

    Args:
        run: its folder.
        solver: the instance.
        reached: last whole frame.
    """
    try:
        data = json.loads((run / FILE).read_bytes())
        place = data["place"]
        found = GaveUp(
            str(data["solver"]), int(data["frame"]), str(data["text"]), tuple(map(str, data["entities"])), place and tuple(place)
        )
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return found if found.solver == solver and reached < found.frame else None


def forget(run: Path) -> None:
    """Take it away: the run begins again."""
    (run / FILE).unlink(missing_ok=True)
