"""Tricks after the acceptance: another prompt under the same motion, no claims, answers that nobody gave, a bundle of another prompt."""

from __future__ import annotations

import hashlib
import json
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from ...workflow.verify_bundle import verify_bundle
from ...workflow.verify_folder import verify_folder
from ...worlds.errors import WorldAgentError
from ...worlds.ledger import Ledger
from ...worlds.reviews import Review
from .agent import Agent
from .cases import Case
from .twins import BLOCKS, BLOCKS_DE, BOUNCE, PUSH, SHELF

__all__ = ["MECHANISMS"]

_OTHER = "A steel kettle falls off a table."


def _answer(function: Callable[[], Any]) -> str:
    """Answer of a call, or its refusal."""
    try:
        return json.dumps(function(), default=str, ensure_ascii=False)
    except WorldAgentError as error:
        return str(error)


def _written(agent: Agent, change: Callable[[dict[str, Any]], None]) -> None:
    """Edit `world.json` outside the server."""
    path = agent.folder.spec_path
    document = json.loads(path.read_text())
    change(document)
    path.write_text(json.dumps(document))


def _by_patch(agent: Agent) -> str:
    return _answer(lambda: agent.call("edit_spec", patch=[{"op": "replace", "path": "/prompt", "value": _OTHER}]))


def _created_again(agent: Agent) -> str:
    return _answer(lambda: agent.call("edit_spec", prompt=_OTHER, spec={}))


def _adopted(agent: Agent) -> str:
    _written(agent, lambda d: d.update(prompt=_OTHER))
    return _answer(lambda: agent.call("edit_spec", on_hand_edit="adopt"))


def _judged_by_hand(agent: Agent) -> str:
    _written(agent, lambda d: d.update(prompt=_OTHER))
    return _answer(lambda: agent.call("run_checks", scope="acceptance", wait_s=600.0))


def _verified_by_hand(agent: Agent) -> str:
    _written(agent, lambda d: d.update(prompt=_OTHER))
    return _answer(lambda: verify_folder(agent.folder.root, replay=False))


def _claims_away(agent: Agent) -> str:
    agent.call(
        "edit_spec", patch=[{"op": "replace", "path": "/claims", "value": {}}], weakening_reason="they were a nuisance to keep"
    )
    return _answer(lambda: agent.call("run_checks", scope="acceptance", wait_s=600.0))


def _claims_away_by_hand(agent: Agent) -> str:
    _written(agent, lambda d: d.update(claims={}))
    return _answer(lambda: verify_folder(agent.folder.root, replay=False))


def _as_version_1(agent: Agent) -> str:
    return _answer(lambda: agent.call("edit_spec", patch=[{"op": "replace", "path": "/spec_version", "value": "1"}]))


def _review(agent: Agent, reader: Any, digest: str) -> str:
    claims = json.loads(agent.folder.spec_path.read_text())["claims"]
    Ledger(agent.folder.ledger_path).add_review(Review(digest, reader, "somebody", dict.fromkeys(claims, "shown"), 1, 1))
    return _answer(lambda: agent.call("run_checks", scope="acceptance", wait_s=600.0)["says"])


def _review_of_a_person(agent: Agent) -> str:
    return _review(agent, "person", "0" * 64)


def _review_of_a_model(agent: Agent) -> str:
    return _review(agent, "model", hashlib.sha256(b"").hexdigest())


def _review_of_the_freeze(agent: Agent) -> str:
    return _review(agent, "person", str(agent.verdict["freeze"]))


def _rewritten(agent: Agent, change: Callable[[dict[str, Any]], None]) -> str:
    """Verdict about the bundle with its members changed and its manifest made to agree."""
    source = agent.folder.root / str(agent.verdict["bundle"])
    with zipfile.ZipFile(source) as archive:
        members = {n: archive.read(n) for n in archive.namelist()}
    manifest = json.loads(members.pop("manifest.json"))
    documents = {n: json.loads(members[n]) for n in ("world/world.json", "verdict.json", "history.json")}
    change(documents)
    members |= {n: json.dumps(d).encode() for n, d in documents.items() if d != json.loads(members[n])}
    manifest["members"] = {n: {"bytes": len(d), "sha256": hashlib.sha256(d).hexdigest()} for n, d in members.items()}
    target = Path(agent.workspace) / "forged.zip"
    with zipfile.ZipFile(target, "w") as archive:
        for name, data in {"manifest.json": json.dumps(manifest).encode(), **members}.items():
            archive.writestr(name, data)
    return _answer(lambda: verify_bundle(target, seed=1, intervals=1))


def _bundle_prompt(agent: Agent) -> str:
    return _rewritten(agent, lambda d: d["world/world.json"].update(prompt=_OTHER))


def _bundle_claims(agent: Agent) -> str:
    return _rewritten(agent, lambda d: d["world/world.json"].update(claims={}))


def _bundle_words(agent: Agent) -> str:
    return _rewritten(agent, lambda d: d["verdict.json"]["prompt"].update(read_by="person", warnings=[], claimed=1.0))


def _bundle_spans(agent: Agent) -> str:
    return _rewritten(agent, lambda d: d["verdict.json"]["prompt"].update(filler_texts=[], filler=0.0))


_CLAUSE = {"/spec_version": "1", "/clauses": {"c1": {"met_by": ["/story/beats/fall", "/story/beats/bounce", "/entities/ball"]}}}

MECHANISMS: Mapping[str, tuple[Case, ...]] = {
    "prompt exchanged": (
        Case("by a patch", BLOCKS, says="prompt", act=_by_patch),
        Case("by creating it again", BLOCKS, says="exists already", act=_created_again),
        Case("by hand, adopted", BLOCKS, says="immutable", act=_adopted),
        Case("by hand, judged", BLOCKS, says="outside the server", act=_judged_by_hand),
        Case("by hand, verified", BLOCKS, says="no candidate holds this specification", act=_verified_by_hand),
    ),
    "claims evaded": (
        Case("taken away after the acceptance", BLOCKS, says="no claim says which words", act=_claims_away),
        Case("taken away by hand", BLOCKS, says="no candidate holds this specification", act=_claims_away_by_hand),
        Case("version 1 by a patch", BLOCKS, says="spec_version", act=_as_version_1),
        Case("version 1 from the start", BOUNCE, says="of which no world is made any more", marked="", prompt="A rubber ball falls onto a stone floor.", changes=_CLAUSE),
        Case("version 1 for another prompt", BOUNCE, says="of which no world is made any more", marked="", prompt="An anvil floats on a pond.", changes=_CLAUSE),
        Case("version 1 in German", BOUNCE, says="of which no world is made any more", marked="", prompt="Ein Amboss schwimmt auf einem Teich.", changes=_CLAUSE),
        Case("none given", SHELF, "audit:claims", "no claim says which words", marked="", prompt=SHELF.prompt),
        Case("things alone", PUSH, says="'pushes'", marked="A [steel](property plate) [plate](thing plate) pushes a [wooden](property crate) [crate](thing crate) across the [floor](thing floor)."),
        Case("nur ein Ding", BLOCKS_DE, says="filler: ", marked="Ein [Stahlklotz](thing steel_block) rutscht über einen Steinboden. Er trifft einen Holzklotz, und der rutscht weiter."),
    ),
    "review forged": (
        Case("a person's, of a digest of zeros", BLOCKS, says="read by nobody", act=_review_of_a_person),
        Case("a model's, of nothing", BLOCKS, says="read by nobody", act=_review_of_a_model),
        Case("a person's, of the freeze", BLOCKS, says="read by nobody", act=_review_of_the_freeze),
    ),
    "bundle of another prompt": (
        Case("its prompt", BLOCKS, says='"verdict": "refused"', act=_bundle_prompt),
        Case("its claims", BLOCKS, says='"verdict": "refused"', act=_bundle_claims),
        Case("who read it", BLOCKS, says='"verdict": "incomplete"|"verdict": "refused"', act=_bundle_words),
        Case("what was filler", BLOCKS, says='"verdict": "incomplete"|"verdict": "refused"', act=_bundle_spans),
    ),
}  # fmt: skip
"""By name."""
