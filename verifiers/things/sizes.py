"""Rows about sizes: seats, tops, steps, leaves and lengths of things against the bounds of their kind, measured on what is built (R87, R88).

The kind is told by the generator that made a thing, or by the last word of its role; never a size. A role that says toy, child's or
giant makes another kind of it, with the same measures times the shares of that variant: the row and the register name it.
"""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

from ...worlds.errors import EvidenceError
from ...worlds.spec import RigidPhysics, Supports
from ..rows.answers import guarded, row_of
from ..rows.corrections import correction, pointer
from ..rows.findings import Finding
from ..scene.rescaling import scaled
from .kinds import KINDS, Kind, Limit, Variant, kind_of, variant_of
from .measures import measured, thing_of
from .questions import KIND

if TYPE_CHECKING:
    from ...worlds.candidate import Candidate
    from ...worlds.requirements import Correction, Row

__all__ = ["check", "variant_lines"]

ROUNDED = 1e-6
"""[m] Facets and files round lengths by less."""


SLAB = 3.0
"""Own choice: what is carried and so many times too low is the upper part of a thing rather than a small one."""


class _Judged(NamedTuple):
    limit: Limit
    low: float
    high: float
    value: float

    @property
    def excess(self) -> float:
        """Logarithm of its factor beyond a bound, negative within."""
        value = max(self.value, 1e-9)
        above = math.log(value / self.high) if math.isfinite(self.high) else -math.inf
        below = math.log(self.low / value) if self.low > 0.0 else -math.inf
        return max(above, below)

    @property
    def ok(self) -> bool:
        """True within the bounds."""
        return self.low - ROUNDED <= self.value <= self.high + ROUNDED


@guarded(KIND)
def check(candidate: Candidate) -> list[Row]:
    """One row per thing whose kind is known."""
    rows = []
    for name, kind in _asked(candidate).items():
        rows.append(row_of(candidate, KIND, (name,), partial(_finding, candidate, name, kind), entities=(name,)))
    return rows


def _asked(candidate: Candidate) -> dict[str, Kind]:
    """Entities of known kinds: those that generators made, and rigid ones by their roles, but no bodies of others."""
    spec = candidate.spec
    bodies = {b for e in spec.entities.values() if e.asset is not None for b in e.asset.bodies}
    hung = {j.child for j in spec.simulation.joints.values() if j.parent is not None}
    found = {}
    for name, entity in spec.entities.items():
        if name in bodies or not isinstance(entity.physics, RigidPhysics) or entity.generator is not None:
            continue
        generator = entity.asset.generator if entity.asset is not None else None
        kind = kind_of(generator, entity.role) if generator is not None or name not in hung else None
        if kind is not None:
            found[name] = kind
    return found


def _finding(candidate: Candidate, name: str, kind: Kind) -> Finding:
    entity, variant = candidate.spec.entities[name], variant_of(candidate.spec.entities[name].role)
    judged = [j for j in (_judge(candidate, name, limit, variant) for limit in kind.limits) if j is not None]
    if not judged:
        asked = " and ".join(dict.fromkeys(limit.called for limit in kind.limits))
        raise EvidenceError(f"{name!r} has nothing on which the measures of a {kind.name} are taken: {asked}")
    worst = max(judged, key=lambda j: (not j.ok, j.excess))
    above = worst.value > worst.high or (worst.value >= worst.low and not _nearer_low(worst))
    said = f"{variant.name} {kind.name}" if variant is not None else kind.name
    measures = ", ".join(f"{j.limit.called} {j.value:.4g} m" for j in judged)
    bounds = f"{worst.low:.4g} to {worst.high:.4g} m" if math.isfinite(worst.high) else f"at least {worst.low:.4g} m"
    text = f"{name!r} is a {said}: {measures}"
    if not worst.ok:
        text = f"{name!r} is a {said}: {worst.limit.called} {worst.value:.4g} m, of the kind {bounds} ({worst.limit.source})"
    return Finding(
        "pass" if worst.ok else "fail",
        text,
        worst.value,
        worst.high if above else worst.low,
        hints=() if worst.ok else _hints(candidate, name, kind, worst, variant),
        evidence={
            "kind": kind.name,
            "variant": None if variant is None else variant.name,
            "measures_m": {j.limit.measure: j.value for j in judged},
            "source": worst.limit.source,
        },
        comparison="<=" if above else ">=",
        frames=(0, 0),
        predicate=f"{worst.limit.called} of {name} is that of a {said}: {bounds}",
        extra=[kind.name, entity.role, [limit.model_dump() for limit in kind.limits]],
    )


def _nearer_low(judged: _Judged) -> bool:
    """True if the lower bound is the nearer one, in proportion."""
    if not math.isfinite(judged.high):
        return True
    return judged.low > 0.0 and judged.value / judged.low < judged.high / max(judged.value, 1e-9)


def _judge(candidate: Candidate, name: str, limit: Limit, variant: Variant | None) -> _Judged | None:
    thing = candidate.memo(("thing", name), lambda: thing_of(candidate, name))
    value = measured(thing, limit.measure)
    if value is None:
        return None
    least, most = (1.0, 1.0) if variant is None else (variant.least, variant.most)
    low = 0.0 if limit.low is None else limit.low * least
    return _Judged(limit, low, math.inf if limit.high is None else limit.high * most, value)


def _hints(candidate: Candidate, name: str, kind: Kind, worst: _Judged, variant: Variant | None) -> tuple[Correction, ...]:
    """Mend the size, the whole where that does, and else the parts; or say what else it is."""
    parts = pointer("entities", name, "parts")
    bound = worst.high if worst.value > worst.high else worst.low
    if worst.limit.measure in ("rise", "rises", "going"):
        action = f"Put every tread of {name!r} where steps are alike, or make it again by its generator (place_object)"
        action += f": {worst.limit.called} {worst.value:.4g} m, bound {bound:.4g} m."
        return (correction("a step is malformed", "shape", action, pointers=(parts,)),)
    middle = math.sqrt(max(worst.low, 1e-9) * worst.high) if math.isfinite(worst.high) else bound
    factor = middle / max(worst.value, 1e-9)
    said = kind.name if variant is None else f"{variant.name} {kind.name}"
    several = candidate.spec.entities[name].asset is not None and bool(candidate.spec.entities[name].asset.bodies)  # type: ignore[union-attr]
    hints = [
        correction(
            "lengths are given in another unit than metres" if not 1 / 30 < factor < 30 else f"it is not of the size of a {said}",
            "dimensions",
            f"Scale {name!r} by {factor:.4g}, so that the {worst.limit.called} is {middle:.3g} m"
            + (", or make it again with other parameters (place_object)." if several else "."),
            pointers=(parts, pointer("entities", name, "dimensions", "size")),
            patch=() if several else scaled(candidate, name, factor),
        )
    ]
    carriers = [r.a for r in candidate.spec.graph.relations.values() if isinstance(r, Supports) and r.b == name]
    if carriers and factor > SLAB:
        action = f"If {name!r} is the board or slab alone and {carriers[0]!r} its base, end its role in that word ('oak slab'), with a weakening_reason; or make both one entity."
        part = correction(
            f"it is a part of a {said}, which stands on another entity",
            "text",
            action,
            pointers=(pointer("entities", name, "role"),),
        )
        hints.insert(0, part)
    for other in _kin(kind, worst):
        action = f"If {name!r} is a {other}, say so in its role, with {other!r} as its last word and a weakening_reason: then it is measured as one."
        hints.append(correction(f"it is a {other}", "text", action, pointers=(pointer("entities", name, "role"),)))
    if variant is None:
        word = "toy" if worst.value < worst.low else "giant"
        hints.append(
            correction(
                f"it is no ordinary {kind.name}",
                "text",
                f"If the prompt asks for a {word} one, say so in the role of {name!r}, with a weakening_reason: '{word} {kind.name}'; the register names it.",
                pointers=(pointer("entities", name, "role"),),
            )
        )
    return tuple(hints)


def _kin(kind: Kind, worst: _Judged) -> list[str]:
    """Nouns of other kinds that end in a noun of this one and are as large as was measured: a workbench, of a bench."""
    return [
        noun
        for other in KINDS.values()
        for noun in other.nouns
        if other.name != kind.name and any(noun.endswith(own) and noun != own for own in kind.nouns)
        if any(
            limit.measure == worst.limit.measure
            and (limit.low is None or limit.low <= worst.value)
            and (limit.high is None or worst.value <= limit.high)
            for limit in other.limits
        )
    ]


def variant_lines(candidate: Candidate) -> list[dict[str, str]]:
    """Lines of the register: things that are measured as toys, for children or for giants, since their roles say so."""
    lines = []
    for name, kind in _asked(candidate).items():
        variant = variant_of(candidate.spec.entities[name].role)
        if variant is not None:
            lines.append(
                {
                    "what": f"{name!r} is measured as a {variant.name} {kind.name}, since its role says so",
                    "effect": f"it may have {variant.least:g} to {variant.most:g} times the size of others ({variant.source})",
                }
            )
    return lines
