"""A person corrects a claim on the page: the same way as an agent's edit, at one revision, audited and recorded (R2, R155)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ..worlds.audits.claims import claim_problems
from ..worlds.claim_marks import target_pointer
from ..worlds.errors import InputError, RefusedError
from ..worlds.limits import check_limits
from ..worlds.patch import apply_patch
from ..worlds.spec import CLAIM_TYPES

if TYPE_CHECKING:
    from ..worlds.spec import Claim
    from .session import Session

__all__ = ["DEEDS", "correct_claim"]

DEEDS = ("judge", "waive", "remove")
"""Actions of a person on a claim: say what it means and where it is judged, waive it, or make its words filler."""
KEYS = {"revision", "claim", "deed", "type", "by", "because", "reason"}
MOST_TOLD = 4
"""Problems of the audit that a refusal names."""


def correct_claim(session: Session, document: Any) -> dict[str, Any]:
    """Make a person's correction of a claim the next revision; its number, and what became stale.

    Args:
        session: of the world.
        document: `revision` that was read, id of the `claim`, `deed`; to judge it `type` and `by` (pointers or ids, apart by blanks), to
            waive it `because`; `reason` where a row has failed and the correction asks for less.

    Raises:
        InputError: something is missing or out of range.
        RefusedError: the world changed meanwhile, the audit finds something that it did not find before, or a reason is wanted.
        SpecError: the claim does not validate.
    """
    if not isinstance(document, Mapping) or set(document) - KEYS:
        raise InputError(f"a correction is a JSON object with the keys {', '.join(sorted(KEYS))}")
    if document.get("revision") != session.revision:
        raise RefusedError(f"the world is at revision {session.revision} by now; read the prompt again, then correct it")
    name = str(document.get("claim"))
    claim = session.spec.claims.get(name)
    if claim is None:
        raise InputError(f"there is no claim {name[:64]!r}; the prompt on the page has them")
    operation = _operation(session, name, claim, document)
    after = apply_patch(session.spec, [operation])
    check_limits(after)
    known = {(p.pointer, p.text) for p in claim_problems(session.spec)}
    fresh = [p for p in claim_problems(after) if (p.pointer, p.text) not in known]
    if fresh:
        more = f"\nand {len(fresh) - MOST_TOLD} more" if len(fresh) > MOST_TOLD else ""
        raise RefusedError("the audit would fail: " + "\n".join(p.text for p in fresh[:MOST_TOLD]) + more)
    hypothesis = f"a person corrected the claim of {claim.quote[:100]!r} on the page"
    outcome = session.commit(
        after, patch=[operation], hypothesis=hypothesis, weakening_reason=str(document.get("reason") or "").strip()
    )
    report = session.audit()
    return {"revision": outcome["revision"], "rows_now_stale": outcome["rows_now_stale"], "audit_passes": report.passed}


def _operation(session: Session, name: str, claim: Claim, document: Mapping[str, Any]) -> dict[str, Any]:
    """The operation of a JSON Patch that does what is asked."""
    deed, path = document.get("deed"), f"/claims/{name}"
    if deed not in DEEDS:
        raise InputError(f"the deed is {str(deed)[:40]!r}; it must be one of {', '.join(DEEDS)}")
    if deed == "remove":
        return {"op": "remove", "path": path}
    kind = document.get("type", claim.type)
    if kind not in CLAIM_TYPES:
        raise InputError(f"the type is {str(kind)[:40]!r}; it must be one of {', '.join(CLAIM_TYPES)}")
    kept: dict[str, Any] = {"quote": claim.quote, "nth": claim.nth, "type": kind}
    if deed == "waive":
        return {"op": "replace", "path": path, "value": {**kept, "waived": str(document.get("because") or "").strip()}}
    targets = str(document.get("by") or "").split()
    if targets:
        kept["by"] = [target_pointer(session.spec, t, kind=kind, quote=claim.quote) for t in targets]
    if claim.same_as is not None:
        kept["same_as"] = claim.same_as
    return {"op": "replace", "path": path, "value": kept}
