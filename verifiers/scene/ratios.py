"""Ratios of specified sizes of related nodes (R88): defaults by kind of relation, and the finding about one relation."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...worlds.errors import EvidenceError
from ..rows.corrections import correction, pointer
from ..rows.findings import Finding
from .bounds import SCENERY
from .extents import region_diagonal
from .rescaling import scaled

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.spec import Relation

__all__ = ["RATIOS", "Ratio", "default_ratio", "ratio_finding"]

AMPLE = 1.01
"""[1] Own choice: a suggested scale goes this far past what the ratio asks for."""
LEAST = 1e-150
"""Stands for diagonals that underflow [m], so that ratios stay finite."""


class Ratio(NamedTuple):
    """Default bounds of diagonal a / diagonal b for one kind of relation; None: `limits.scale_ratio`."""

    low: float | None
    high: float | None
    reason: str


RATIOS: dict[str, Ratio] = {
    "supports": Ratio(0.02, None, "a peg of 5 cm under a beam of 2.5 m is about the slightest support; a table carries a pin"),
    "contains": Ratio(
        0.2, None, "what stands in a container may reach out like a pencil out of a cup, five times its size at most"
    ),
    "adjacent": Ratio(None, None, "neighbours need not resemble each other: a coin beside a wardrobe is 1 : 100"),
    "connects": Ratio(None, None, "a door mat leads to a hall of 200 m; more is a unit error in one region"),
    "interacts": Ratio(None, None, "a marble strikes a wrecking ball, 1 : 100; a bird a ship is beyond what is resolved at once"),
    "fastened": Ratio(None, None, "a screw of 1 cm holds a beam of 5 m, 1 : 500"),
}
"""Own choices, the paper gives no numbers (S2). Static entities and regions are scenery; `ratio` of a relation overrides all."""


def default_ratio(candidate: Candidate, relation: Relation) -> tuple[float, float]:
    """Allowed [min, max] of specified diagonals a / b where the relation itself gives none.

    Bounds of the kind within `limits.scale_ratio`. A static entity, or a region beside an entity, is scenery and may be
    `SCENERY` times larger than the other.
    """
    kind = RATIOS[relation.kind]
    low, high = candidate.spec.simulation.limits.scale_ratio
    low = low if kind.low is None else max(low, kind.low)
    high = high if kind.high is None else min(high, kind.high)
    if relation.kind == "connects":
        return low, high
    if _is_scenery(candidate, relation.a):
        high = max(high, SCENERY)
    holds = relation.kind == "contains"
    if _is_scenery(candidate, relation.b) and not holds:
        low = min(low, 1.0 / SCENERY)
    if holds and relation.a in candidate.spec.graph.regions:
        # The centre of what a region contains lies in it; a spot to reach may be smaller than what comes there.
        low = min(low, candidate.spec.simulation.limits.scale_ratio[0])
    return low, high


def _is_scenery(candidate: Candidate, node: str) -> bool:
    entity = candidate.spec.entities.get(node)
    return entity is None or entity.motion == "static"


def _diagonal(candidate: Candidate, node: str) -> float:
    """Specified bounding-box diagonal of an entity or region [m]: the one measure on both sides of a ratio.

    Raises:
        EvidenceError: the scene graph names no such entity or region.
    """
    spec = candidate.spec
    if node in spec.entities:
        return max(LEAST, float(np.linalg.norm(spec.entities[node].dimensions.size)))
    if node in spec.graph.regions:
        return region_diagonal(spec.graph.regions[node])
    raise EvidenceError(f"{node!r} is neither an entity nor a region; declare it or change the relation")


def ratio_finding(candidate: Candidate, relation: Relation) -> Finding:
    """Judge whether the specified diagonals of a relation's nodes are in proportion."""
    entities = candidate.spec.entities
    a, b = (_diagonal(candidate, n) for n in (relation.a, relation.b))
    low, high = relation.ratio or default_ratio(candidate, relation)
    ratio = a / b
    above = ratio > high or (ratio >= low and high / ratio < ratio / low)
    ok = low <= ratio <= high
    odd = relation.b if _is_scenery(candidate, relation.a) and relation.b in entities else relation.a
    factor = (ratio / high if above else ratio / low) if odd == relation.b else (high / ratio if above else low / ratio)
    order = (odd, relation.a if odd == relation.b else relation.b)
    return Finding(
        "pass" if ok else "fail",
        f"{relation.a!r} ({a:.4g} m) is {ratio:.4g} times {relation.b!r} ({b:.4g} m), "
        f"allowed {low:.4g} to {high:.4g} for {relation.kind!r}",
        ratio,
        high if above else low,
        hints=(
            correction(
                "one of the two is given in another unit or at the wrong size",
                "dimensions",
                f"Scale {odd!r} (parts and contract) by at {'least' if factor > 1 else 'most'} {factor:.4g}, "
                f"or check the size of {order[1]!r}.",
                pointers=tuple(
                    pointer("entities", n, "dimensions", "size") if n in entities else pointer("graph", "regions", n)
                    for n in order
                ),
                patch=()
                if ok or odd not in entities
                else scaled(candidate, odd, AMPLE * factor if factor > 1 else factor / AMPLE),
            ),
        ),
        evidence={"diagonal_a_m": a, "diagonal_b_m": b, "allowed": [low, high], "relation": relation.kind},
        comparison="<=" if above else ">=",
        entities=tuple(n for n in order if n in entities),
        frames=(0, 0),
        predicate=f"specified diagonals: {low:.4g} <= {relation.a} / {relation.b} <= {high:.4g} ({relation.kind})",
        extra=[relation.model_dump(mode="json"), a, b, low, high],
    )
