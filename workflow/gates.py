"""Gates between the steps. Each derives its verdict again from stored rows; no stored word of a verdict opens one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ..worlds.ablation import ABLATED, ablation
from ..worlds.built import BuiltEntity
from ..worlds.errors import EvidenceError, InputError, LimitError, RefusedError
from ..worlds.requirements import Row
from .session import Session

__all__ = ["bake_opens", "require_acceptance", "require_probe", "require_true_geometry", "stored_rows"]

_NAMED = 8
"""Open rows that a refusal names."""
_NOT_ACCEPTED = "this very candidate is not accepted"
_ACCEPT = "call run_checks(world, scope='acceptance')"


def stored_rows(rows: Sequence[Row], last: int) -> dict[str, Any]:
    """Rows of a probe as its record keeps them, for its verdict to be derived again.

    Last frame, (status, last frame needed) of mandatory rows by id, and ids of the others, which may be open.
    """
    needed = {r.id: (r.status, None if r.frames is None else r.frames[1]) for r in rows if r.mandatory}
    return {"last": last, "mandatory": needed, "optional": [r.id for r in rows if not r.mandatory]}


def require_probe(session: Session, freeze: str) -> dict[str, Any]:
    """The record of the probe of exactly these settings, if its rows pass.

    Raises:
        RefusedError: there is none, or rows of it, or of the matrix at the probe, are open or missing.
    """
    from ..simulation.freeze import solver_changed
    from ..verifiers.stored import open_in_probe

    known = session.ledger.freeze(freeze)
    if known is None and solver_changed():
        raise RefusedError(
            "the program was changed or updated while this server ran, so it and its jobs are of two versions; restart the server, then "
            "call probe_sim"
        )
    if known is None:
        raise RefusedError(
            f"bake_sim needs a passing probe of exactly these settings{_changed_since(session)}; call probe_sim first"
        )
    stages, last = session.ledger.stages(), int(known["detail"].get("rows", {}).get("last", -1))
    judged = [r for r in session.ledger.rows() if stages.get(r.id) == "probe" and not r.evidence.get("stale")]
    left = sorted({*_open_of_record(session, known), *(r.id for r in open_in_probe(judged, last))})
    if not left and known["passed"]:
        return known
    named = left or known["detail"].get("failing", [])
    raise RefusedError(
        f"bake_sim needs a passing probe of exactly these settings (the last probe left {named[:_NAMED]} open); call probe_sim first"
    )


def bake_opens(session: Session) -> bool:
    """True if `bake_sim` finds the probe that it asks for. Where the ledger tells already that there is none, nothing is built to see."""
    from .standing import standing

    if standing(session.folder, session.ledger).step("frozen").state != "done":
        return False
    try:
        require_probe(session, session.freeze())
    except (EvidenceError, InputError, LimitError, RefusedError):
        return False
    return True


def _changed_since(session: Session) -> str:
    """Settings that changed since the last probe that passed, in brackets."""
    from ..worlds.patch import differences
    from ..worlds.slices import motion_slice
    from ..worlds.spec import WorldSpec

    passed = next((f for f in session.ledger.freezes() if f["passed"]), None)
    judged = None if passed is None else session.ledger.revision_spec(passed["revision"])
    if passed is None or judged is None:
        return " (no probe of this world has passed)"
    places = list(differences(motion_slice(WorldSpec.model_validate_json(judged[0])), motion_slice(session.spec)))
    since = f" (since the one of revision {passed['revision']}"
    if not places:
        return f"{since} the geometry was built anew or the program that moves it was updated)"
    more = f" and {len(places) - _NAMED} more" if len(places) > _NAMED else ""
    return f"{since} there changed {', '.join(places[:_NAMED])}{more})"


def _open_of_record(session: Session, known: dict[str, Any]) -> list[str]:
    """Ids of rows that the record of a probe leaves open, or lacks although the specification it judged demands them."""
    from ..verifiers.stored import demanded_of_motion
    from ..worlds.probe_length import probe_frames
    from ..worlds.spec import WorldSpec

    rows, judged = known["detail"].get("rows", {}), session.ledger.revision_spec(known["revision"])
    last, kept = int(rows.get("last", -1)), rows.get("mandatory", {})
    found = [i for i, (status, _) in kept.items() if status == "fail"]
    found += [i for i, (status, needed) in kept.items() if status == "unverified" and (needed is None or needed <= last)]
    if judged is None:
        return [*found, "revision"]
    spec = WorldSpec.model_validate_json(judged[0])
    if last < (needed := probe_frames(spec) - 1):
        found.append(f"frames {last + 1}..{needed}, before which it ended")
    return found + sorted(demanded_of_motion(spec) - kept.keys() - set(rows.get("optional", ())))


def require_acceptance(session: Session, freeze: str) -> dict[str, Any]:
    """The acceptance of exactly this candidate, if the rows that it rests on pass.

    Raises:
        RefusedError: there is none; or rows of it or of the matrix are open or missing.
    """
    from ..verifiers.stored import open_in_matrix, unmet
    from ..worlds.candidate import open_candidate
    from .standing import is_about_present

    found = session.ledger.acceptance()
    # A film of an evaluation: what it shows is for those who compare, and no acceptance.
    if found is None or found["verdict"] != (ABLATED if ablation() else "accepted"):
        raise RefusedError(f"{_NOT_ACCEPTED}; {_ACCEPT} and mend what it returns")
    if not is_about_present(session.ledger, found, session.revision):
        raise RefusedError(
            f"{_NOT_ACCEPTED}: the last acceptance is about revision {found['revision']}{_edited_since(session, found)}; {_ACCEPT}"
        )
    candidate = open_candidate(session.folder, freeze, "full") if session.ledger.bake(freeze) is not None else None
    if candidate is None or (found["freeze"], found["record"].get("cache_digest")) != (freeze, candidate.digest):
        raise RefusedError(
            f"{_NOT_ACCEPTED}: the last acceptance is about other frames than those of the present bake; {_ACCEPT}"
        )
    rows = [Row.model_validate(r) for r in found["record"]["rows"]]
    left = list(dict.fromkeys([*unmet(session.spec, rows), *open_in_matrix(session.ledger.rows(), session.ledger.stages())]))
    if left:
        more = f"\n  and {len(left) - _NAMED} more" if len(left) > _NAMED else ""
        raise RefusedError(
            f"{_NOT_ACCEPTED}: the ledger says so, but {len(left)} of the rows that it rests on are open or missing, "
            f"and none may be; {_ACCEPT} and mend what it returns:\n" + "\n".join(f"  {text}" for text in left[:_NAMED]) + more
        )
    return found


def _edited_since(session: Session, accepted: Mapping[str, Any]) -> str:
    """Places that an acceptance was about and that changed since, after a comma; what else sets it apart where none did."""
    from ..worlds.patch import differences
    from ..worlds.spec import WorldSpec

    judged = session.ledger.revision_spec(accepted["revision"])
    if judged is None:
        return ""
    before = WorldSpec.model_validate_json(judged[0])
    places = list(differences(before.model_dump(mode="json"), session.spec.model_dump(mode="json")))
    more = f" and {len(places) - _NAMED} more" if len(places) > _NAMED else ""
    if not places:
        return ", but its record is about another specification than this ledger has under that number"
    return f", and there changed since {', '.join(places[:_NAMED])}{more}"


def require_true_geometry(session: Session, built: Mapping[str, BuiltEntity]) -> None:
    """Build every entity again and compare: a built file that was replaced before the probe hashes like any other.

    Raises:
        EvidenceError: one differs from what the specification gives; it is moved aside.
    """
    from ..construction import build_entity, built_paths

    files = built_paths(session.folder, session.spec)
    for name, found in built.items():
        if build_entity(session.spec, name, session.folder.assets).digest() != found.digest():
            path = session.folder.root / files[name]
            path.replace(path.with_suffix(".altered"))
            raise EvidenceError(
                f"the built geometry of {name!r} is not what the specification gives; it was moved aside to "
                f"{path.with_suffix('.altered').name}. Call place_object, probe_sim and bake_sim again"
            )
