"""Those of whom a beat counts how many do something, beside its subject: which of them no shot shows when it comes true.

The beat's row is about its subject; who watches the film counts all of them, so the row tells of the others.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...worlds.predicate_base import predicates_in
from ...worlds.predicates import Count
from .plan import shots_at

if TYPE_CHECKING:
    from ...worlds.spec import Beat
    from .sight import Sight

__all__ = ["unseen_members"]

MOST = 24
"""Own choice: members that are looked at; each look casts the rays of a picture."""


def unseen_members(sight: Sight, beat: Beat, frame: int) -> dict[str, str]:
    """Members of counts besides the subject that no shot at a frame shows as limits ask, and why, in words."""
    candidate = sight.candidate
    limits, shots = candidate.spec.simulation.limits, shots_at(candidate, frame)
    counts = [p for p in predicates_in(beat.predicate) if isinstance(p, Count)]
    members = dict.fromkeys(n for p in counts for n in p.entities if n != beat.subject)
    found: dict[str, str] = {}
    for name in list(members)[:MOST]:
        looks = [sight.seen(name, shot, frame) for shot in shots]
        if any(s.share >= limits.visible_pixels and s.unoccluded >= limits.visible_share for s in looks):
            continue
        best = max(looks, key=lambda s: (s.share, s.unoccluded), default=None)
        if best is None or not best.in_picture:
            found[name] = "outside the picture"
        elif best.unoccluded < limits.visible_share:
            found[name] = f"behind {best.hidden_by or 'others'}"
        else:
            found[name] = f"{best.share:.2%} of the picture"
    return found
