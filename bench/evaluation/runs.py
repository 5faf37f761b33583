"""Finished runs: their logs, found by folder or file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ...worlds.errors import InputError

if TYPE_CHECKING:
    from inspect_ai.log import EvalLog

__all__ = ["open_run", "run_name"]


def open_run(place: Path) -> EvalLog:
    """The log of a run with its samples.

    Args:
        place: a log; the folder of a run, whose log lies in `logs` beside it; or a folder with a single log.

    Raises:
        InputError: there is none, or more than one.
    """
    from inspect_ai.log import read_eval_log

    if place.is_file():
        return read_eval_log(str(place))
    if not place.is_dir():
        raise InputError(f"no run {str(place)!r}: give its folder, or its log (*.eval) where --log-dir put it elsewhere")
    known = sorted(p for folder in (place, place / "logs", place.parent / "logs") for p in folder.glob("*.eval"))
    if (place / "outputs").is_dir():
        known = [
            p for p in known if (read_eval_log(str(p), header_only=True).eval.metadata or {}).get("run") == str(place.absolute())
        ]
    if len(known) != 1:
        names = ", ".join(p.name for p in known[:5]) or "none"
        raise InputError(f"{str(place)!r} has {len(known)} logs ({names}); name the log itself")
    return read_eval_log(str(known[0]))


def run_name(log: EvalLog) -> str:
    """Short name: that of the run's folder, else of its log."""
    run = (log.eval.metadata or {}).get("run")
    return Path(str(run)).name if run else Path(log.location).stem
