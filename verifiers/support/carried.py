"""Rows of `supports` relations in which one side is a liquid (R66, R92)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.errors import EvidenceError
from ...worlds.requirements import Correction, RowId
from ..rows.guards import pointer
from ..rows.verdicts import make_row
from .afloat import LIFT, afloat, carriers, lift

if TYPE_CHECKING:
    from ...worlds.requirements import Row
    from ...worlds.spec import Supports
    from .graph import SupportGraph

__all__ = ["MOST", "carried_row"]

MOST = 0.5
"""Own choice: a liquid carries a body when it bears this share of its weight over the interval."""


def carried_row(graph: SupportGraph, name: str, relation: Supports, frames: tuple[int, int]) -> Row:
    """A liquid carries a body: it lies in it at frame 0, and pushes it up over the interval.

    Raises:
        EvidenceError: the relation says that something carries a liquid.
    """
    candidate, (a, b) = graph.surfaces.candidate, (relation.a, relation.b)
    if b in candidate.liquids:
        raise EvidenceError(
            f"{b!r} is a liquid: say that {a!r} contains it (`contains`), or ask for a level or volume in a region"
        )
    common: dict[str, Any] = {
        "row_id": RowId("support", name, b),
        "predicate": f"{a} carries {b} over frames {frames[0]}..{frames[1]}: it bears at least {MOST:g} of its weight",
        "frames": frames,
        "entities": (b, a),
        "extra": [relation.model_dump(mode="json"), frames, sorted(carriers(candidate, b))],
    }
    solver = carriers(candidate, b).get(a)
    if solver is None:
        couple = Correction(
            cause=f"{a!r} and {b!r} do not act on each other",
            edit_class="solver",
            group="drivers",
            action=f"Couple the instances of {a!r} and {b!r} both ways.",
            pointers=("/simulation/couplings",),
        )
        text = f"no two-way coupling lets {a!r} push {b!r}"
        return make_row(
            candidate, status="fail", explanation=text, first_failing_frame=frames[0], corrections=(couple,), **common
        )
    lower = Correction(
        cause=f"{b!r} is not in {a!r}, too heavy for it, or held by something else",
        edit_class="scene",
        group="placement",
        action=f"Place {b!r} at its draft in {a!r}: density of {b!r} / density of {a!r} of its height under the surface.",
        pointers=(pointer("entities", b, "pose"), pointer("entities", b, "material")),
    )
    if candidate.stage == "static":
        inside = a in afloat(candidate, b)
        text = f"{b!r} {'touches' if inside else 'does not touch'} the initial volume of {a!r}"
        corrections = () if inside else (lower,)
        return make_row(candidate, status="pass" if inside else "fail", explanation=text, corrections=corrections, **common)
    share = lift(candidate, b, solver)[frames[0] : frames[1] + 1]
    mean = float(share.mean())
    ok = mean >= MOST
    dry = np.flatnonzero(share < LIFT)
    return make_row(
        candidate,
        status="pass" if ok else "fail",
        explanation=f"{a!r} bears {mean:.3g} of the weight of {b!r} over {len(share)} frames, {len(dry)} of them hardly",
        measured=mean,
        bound=MOST,
        comparison=">=",
        unit="1",
        first_failing_frame=None if ok else frames[0] + int(dry[0] if len(dry) else 0),
        corrections=() if ok else (lower,),
        evidence={"least_share": float(share.min()), "largest_share": float(share.max())},
        **common,
    )
