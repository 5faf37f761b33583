"""Bodies that no claim speaks of and that have the form of one of which a claim says that something never happens to it (R2, R156).

Who sees the film cannot tell the two apart by their form: what is denied of the one may happen to the other. The verdict warns; where the two
look the same, `claim:negation` asks it of both (`verifiers/claims/negations.py`).
"""

from __future__ import annotations

from collections.abc import Iterator

from .bound_fields import spoken_of
from .claim_targets import named_in
from .predicates import entities_of
from .spec import WorldSpec

__all__ = ["SPEAK", "decoy_warnings", "unspoken"]

SPEAK = ("thing", "count", "property", "place")
"""Types of claims that say of a body which words it stands for."""
FORM = 0.1
"""Own choice: share by which each extent may differ between bodies of one form."""


def unspoken(spec: WorldSpec) -> list[str]:
    """Solid bodies that no claim speaks of."""
    known = spoken_of(spec, types=SPEAK)
    return [n for n, e in spec.entities.items() if n not in known and e.physics.shape == "solid"]


def decoy_warnings(spec: WorldSpec) -> Iterator[str]:
    """A line for each negation of a body beside which an unclaimed one of its form stands."""
    rest = unspoken(spec)
    for name, claim in spec.claims.items():
        if claim.type != "negation" or claim.waived is not None or not rest:
            continue
        asked = [spec.story.requirements[r] for r in named_in(spec, name, "story/requirements") if r in spec.story.requirements]
        denied = dict.fromkeys(n for r in asked for n in entities_of(r.predicate) if n in spec.entities)
        for body in denied:
            found = [n for n in rest if n not in denied and _one_form(spec, body, n)]
            if found:
                yield (
                    f"{claim.quote!r} is denied of {body!r}, and {', '.join(found[:3])} has its form and no claim speaks of it: claim it too, deny it of "
                    "both, or take it away"
                )


def _one_form(spec: WorldSpec, one: str, other: str) -> bool:
    sizes = [sorted(spec.entities[n].dimensions.size) for n in (one, other)]
    kinds = [sorted(p.shape.kind for p in spec.entities[n].parts.values()) for n in (one, other)]
    return kinds[0] == kinds[1] and all(abs(a - b) <= FORM * max(a, b) for a, b in zip(*sizes, strict=True))
