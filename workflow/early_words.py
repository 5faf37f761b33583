"""Words of place of the prompt at frame 0, told before anything moves: the probe judges them at frames of its own."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .heard import AT_START

if TYPE_CHECKING:
    from ..worlds.spec import ClaimType
    from .session import Session

__all__ = ["unmet_at_start"]

PLACES: tuple[ClaimType, ...] = ("place",)
NAMED = 4
"""Words that a reply names."""


def unmet_at_start(session: Session) -> list[str]:
    """Warnings about claims of place that are not so as the bodies stand; none while the audit leaves something open."""
    from ..construction import build_world
    from ..verifiers.claims.described.check import check
    from ..worlds.candidate import Candidate

    if not session.audit().passed:
        return []
    built, _ = build_world(session.folder, session.spec)
    rows = check(Candidate(session.folder.root, session.spec, built, "static"), PLACES)
    failing = [r for r in rows if r.status == "fail"]
    told = [
        f"{AT_START}: {r.id}: {r.evidence['explanation']}; mend it now, unless it comes to be so later" for r in failing[:NAMED]
    ]
    return [*told, *([f"and {len(failing) - NAMED} more words of place"] if len(failing) > NAMED else [])]
