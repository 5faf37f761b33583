"""Account of a call that a defect ended: which revisions and jobs of its world are kept, and what is not done."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ..worlds.folder import WorldFolder
from .answers import call

if TYPE_CHECKING:
    from .context import ToolContext

__all__ = ["UNKNOWN", "left_behind"]

SHOWN = 6
"""Places of an edit that are named."""
UNKNOWN = "What it stored is not known. Look at the world with inspect_world before you go on"


def left_behind(context: ToolContext, arguments: Mapping[str, Any], began: float) -> str:
    """Sentences on what a call left behind in its world, for an error that tells of a defect; never raises.

    Args:
        context: of the call.
        arguments: it was called with.
        began: when it began, as `time.time()` tells [s].
    """
    world = arguments.get("world")
    try:
        return _kept(context, world, began) if isinstance(world, str) else "Nothing was stored by this call"
    except Exception:  # the account of a defect must not be a second one
        return UNKNOWN


def _kept(context: ToolContext, world: str, began: float) -> str:
    from ..worlds.ledger import Ledger  # listing tools loads no numpy

    path = WorldFolder(context.workspace / world).ledger_path
    if not path.is_file():
        return f"Nothing was stored: there is no world {world!r}"
    newest = Ledger(path).revisions(20)
    stored = [r for r in newest if float(r["created"]) >= began]
    jobs = [j for j in context.jobs.list(world, limit=20, pump=False) if j.created >= began]
    told = []
    if stored:
        places = list(dict.fromkeys(str(o.get("path", "")) for r in stored for o in r["patch"] if isinstance(o, Mapping)))
        named = ", ".join(places[:SHOWN]) + (f" and {len(places) - SHOWN} more" if len(places) > SHOWN else "")
        numbers = " and ".join(str(r["n"]) for r in reversed(stored))
        told.append(f"Its edit is stored, as revision {numbers} of {world!r}" + (f" ({named})" if named else ""))
        told.append("what follows an edit (building, checks, the reply) was cut short: do not send the edit again")
        told.append(f"{call('place_object', world=world)} builds and judges what is there")
    else:
        now = f"it is still at revision {newest[0]['n']}" if newest else "it has no revision"
        told.append(f"No edit of {world!r} was stored: {now}")
    if jobs:
        told.append(f"jobs that it started go on: {', '.join(j.id for j in jobs)}")
    return "; ".join(told)
