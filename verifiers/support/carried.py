"""Rows of `supports` relations in which one side is a liquid (R66, R92)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...worlds.errors import EvidenceError
from ..rows.corrections import correction, couple_both_ways, pointer
from ..rows.findings import Finding
from .afloat import afloat, carriers, lift
from .bounds import BEARS, HELPS
from .moved import support_interval

if TYPE_CHECKING:
    from ...worlds.spec import Supports
    from .graph import SupportGraph

__all__ = ["carried"]


def carried(graph: SupportGraph, relation: Supports, frames: tuple[int, int]) -> Finding:
    """A liquid carries a body: it lies in it at frame 0, and pushes it up over the interval, on the mean.

    A mean that is too low before the interval's end decides nothing.

    Raises:
        EvidenceError: the relation says that something carries a liquid.
    """
    candidate, (a, b) = graph.surfaces.candidate, (relation.a, relation.b)
    if b in candidate.liquids:
        raise EvidenceError(
            f"{b!r} is a liquid: say that {a!r} contains it (`contains`), or ask for a level or volume in a region"
        )
    common: dict[str, Any] = {
        "predicate": f"{a} carries {b} over frames {frames[0]}..{frames[1]}: it bears at least {BEARS:g} of its weight",
        "frames": frames,
        "extra": [relation.model_dump(mode="json"), frames, sorted(carriers(candidate, b))],
    }
    solver = carriers(candidate, b).get(a)
    if solver is None:
        one, other = (next((n for n, s in candidate.spec.simulation.solvers.items() if e in s.members), "") for e in (a, b))
        couple = couple_both_ways(one, other, f"{a!r} and {b!r} do not act on each other")
        text = f"no two-way coupling lets {a!r} push {b!r}"
        return Finding("fail", text, frame=frames[0], hints=(couple,), **common)
    lower = correction(
        f"{b!r} is not in {a!r}, too heavy for it, or held by something else",
        "placement",
        f"Place {b!r} at its draft in {a!r}: density of {b!r} / density of {a!r} of its height under the surface.",
        pointers=(pointer("entities", b, "pose"), pointer("entities", b, "material")),
    )
    if candidate.stage == "static":
        inside = a in afloat(candidate, b)
        text = f"{b!r} {'touches' if inside else 'does not touch'} the initial volume of {a!r}"
        return Finding("pass" if inside else "fail", text, hints=(lower,), **common)
    share = lift(candidate, b, solver)[frames[0] : frames[1] + 1]
    mean = float(share.mean())
    dry = np.flatnonzero(share < HELPS)
    end = support_interval(candidate.spec, relation)[1]
    open_yet = mean < BEARS and frames[1] < end
    later = f"; frames {frames[1] + 1}..{end} can still raise it" if open_yet else ""
    return Finding(
        "pass" if mean >= BEARS else "unverified" if open_yet else "fail",
        f"{a!r} bears {mean:.3g} of the weight of {b!r} over {len(share)} frames, {len(dry)} of them hardly{later}",
        mean,
        BEARS,
        "1",
        frame=frames[0] + int(dry[0] if len(dry) else 0),
        hints=(lower,),
        evidence={"least_share": float(share.min()), "largest_share": float(share.max())},
        comparison=">=",
        **common,
    )
