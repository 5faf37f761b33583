"""A change of the specification as the rules of repair see it: its parameter groups, the evidence before it, the objections to it."""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping, Sequence
from typing import Any, NamedTuple

from ..worlds.documents import document_of
from ..worlds.groups import GROUPS, group_of
from ..worlds.kinds_said import role_weakenings, said_of
from ..worlds.ledger import Ledger
from ..worlds.looks import RAN
from ..worlds.patch import differences, weakenings
from ..worlds.provenance import stale_artifacts
from ..worlds.requirements import Row
from ..worlds.spec import WorldSpec
from ..worlds.weakened import told_by_motion
from .additions import only_builds_on
from .answers import call
from .earlier import has_motion
from .joint_repairs import Joint, grouped, joint_objections, resolved
from .opened import OpenedWorld
from .repair_rules import CAUSAL_CLASSES, causal_groups, cut_grounds, failed, judged_on, same_causes

__all__ = ["Change", "is_static", "unjudged"]

MAX_CHANGES = 8
MAX_LENGTH = 4
"""An iteration keeps this many changed places, with lists up to this length: enough for a pose or a velocity."""
MAX_TOLD = 20
"""Changed places that a reply names."""


class Attempted(NamedTuple):
    """An attempt at repair, as the ledger records it."""

    hypothesis: str
    group: str
    failing: list[Row]
    values: list[tuple[str, Any, Any]]
    expect: str


class Change:
    """One edit of a world, which becomes a revision unless something stands against it.

    Args:
        world: the world before the edit.
        after: its specification after it.
        hypothesis: the supposed cause of a failure and why the edit cures it.
        reason: why a requirement is made easier.
        derived: whether the change only follows from an edit that was made already.
        follows: pointers of what changes only because an entity moves or is copied.
        joint: of several parameter groups, which failing row each answers.
    """

    def __init__(
        self,
        world: OpenedWorld,
        after: WorldSpec,
        *,
        hypothesis: str,
        reason: str,
        derived: bool,
        follows: Collection[str] = (),
        joint: Joint | None = None,
    ) -> None:
        self.world, self.after, self.hypothesis, self.reason, self.joint = world, after, hypothesis, reason, joint
        self._documents = document_of(world.spec), document_of(after)
        self.places = list(differences(*self._documents))
        """JSON pointers that differ."""
        self.groups = {group_of(p) for p in self.places}
        """Their parameter groups."""
        along = {*follows, *_relations_of_new(world.spec, after)}
        self.causal = [] if derived else causal_groups(_own(self.places, along), cut_grounds(world.spec, after))
        """Names of the groups of scene and solver among them."""
        if joint is not None:
            self.joint = joint._replace(repairs=resolved(joint.repairs, grouped(self.places, self.causal)))
        self.stale = stale_artifacts(world.spec, after)
        """Artifacts that the edit makes stale."""
        self.undone: list[dict[str, Any]] = []
        """Untested changes that the edit takes back."""
        self.failing: list[Row] = []
        """Mandatory rows whose last judgement was a failure."""
        self.answerable: list[Row] = []
        """These and the optional ones, which repairs may answer too."""
        self.weaker: list[str] = []
        """Requirements that the edit makes easier, a line each."""
        self.early: list[str] = []
        """Those of which nothing was evidence yet: the history keeps them, and they are no weakenings."""

    def objections(self) -> list[str]:
        """Objections to the edit by the evidence that the ledger holds at this moment (R111-R113, R157)."""
        ledger = self.world.ledger
        self.undone = self._undone() if self.causal else []
        self.answerable = [r for r in ledger.rows() if failed(r) and r.check != "audit"]
        self.failing = [r for r in self.answerable if r.mandatory]
        self.weaker = weakenings(self.world.spec, self.after, judged_on(self.failing))
        self.weaker += role_weakenings(self.world.spec, self.after, said_of(self.failing))
        told = self._version_objections()
        unseen = unjudged(ledger)
        if not unseen and not ledger.ever_judged() and not ledger.ever_failed():
            self.early = self.weaker  # nothing of the world was ever looked at: it might as well have begun so
        elif not unseen and not ledger.ever_failed(moving=True):
            self.early = [w for w in self.weaker if told_by_motion(w)]
        self.weaker = [w for w in self.weaker if w not in self.early]
        if self.weaker and (unseen or ledger.ever_failed()) and len(self.reason.strip()) < 15:
            told.append(
                (f"{unseen}: " if unseen else "")
                + "this edit makes the specification easier to satisfy after evidence against it: "
                + "; ".join(self.weaker[:6])
                + ". Repair the scene or the solver instead; to ask for more, add a member to an `and` that keeps the others, or a beat or requirement beside what is there; or give weakening_reason (>= 15 characters); it is printed with the acceptance."
            )
        if self.causal and self._builds_on(unseen):
            self.causal = []
        if self.causal and not self.undone:
            told += self._causal_objections()
        return told

    def _sets_up(self, unseen: str) -> bool:
        """True if static rows alone fail, and no motion was seen that nobody judged: a scene that is being set up."""
        stages = self.world.ledger.stages()
        return not unseen and all(stages.get(r.id) == "static" for r in self.failing)

    def _builds_on(self, unseen: str) -> bool:
        """True if the edit only adds entities to a scene that is being set up: no repair."""
        ledger = self.world.ledger
        return (
            self._sets_up(unseen)
            and all(is_static(ledger, i) for i in ledger.open_iterations())
            and only_builds_on(*self._documents)
        )

    def _is_one_scene(self) -> bool:
        """True if the edit answers static rows alone, by groups of the scene: geometry, which place_object judges whole within seconds."""
        scene = all(GROUPS[name].edit_class == "scene" for name in self.causal)
        return scene and bool(self.failing) and self._sets_up(unjudged(self.world.ledger))

    def _version_objections(self) -> list[str]:
        """Objections to new clauses, and to the way back to them."""
        before, after = self.world.spec, self.after
        if after.spec_version == "2" or (before.spec_version == "1" and before.clauses == after.clauses):
            return []
        return [
            "clauses are of spec_version '1' and judged by nothing: they can no longer be written. Mark the prompt instead, which makes the world "
            f"version 2: edit_spec(world={self.world.folder.id!r}, claims='A [ball](thing ball) [rolls off](event roll) ...'); "
            "inspect_world(part='claims') proposes spans"
        ]

    def takes_back(self) -> bool:
        """True if the edit sets every cause to what it was before the changes that are not tested yet."""
        return bool(self._undone())

    def _undone(self) -> list[dict[str, Any]]:
        """The untested changes that the edit takes back, all of them; none unless its causes are those last tested."""
        untested = self.world.ledger.open_iterations()
        recorded = self.world.ledger.revision_spec(int(untested[0]["revision"]) - 1) if untested else None
        if recorded is None:
            return []
        return untested if same_causes(WorldSpec.model_validate_json(recorded[0]), self.after) else []

    def _causal_objections(self) -> list[str]:
        """All objections to an edit of the scene or the solver (R111-R113)."""
        told: list[str] = []
        ledger, failing, causal = self.world.ledger, self.failing, self.causal
        # Rows that failed turn stale with the edit that answers them: the open iteration outlives them.
        untested = ledger.open_iterations()
        if untested:
            rows = ", ".join(json.loads(str(untested[-1]["failing_before"]))[:3])
            again = " (or a whole run_checks(scope='probe'): there is motion of these settings)" if has_motion(self.world) else ""
            test = "place_object" if is_static(ledger, untested[-1]) else f"probe_sim{again}"
            told.append(
                f"the change of revision {untested[-1]['revision']} ({untested[-1]['grp']}) is not tested yet: it answered {rows}. "
                f"Call {test} before the next change; or take it back: setting everything causal to what it was in revision "
                f"{untested[0]['revision'] - 1} is allowed at once"
            )
        if self._is_one_scene():
            self.joint = None
        if self.joint is not None:
            return told + joint_objections(self.joint, self.answerable, grouped(self.places, causal), ledger.stages(), self.after)
        unseen = "" if failing else unjudged(ledger, untested=True)
        if not failing and not unseen:
            return told
        if len(self.hypothesis.strip()) < 10:
            why = unseen or f"{len(failing)} rows fail ({', '.join(r.id for r in failing[:5])})"
            told.append(
                f"{why}; an edit must now name its hypothesis: "
                "what you believe causes the failure and why this change cures it (>= 10 characters)"
            )
        if len(causal) > 1 and not self._is_one_scene():
            told.append(
                f"this edit changes {len(causal)} causal parameter groups at once ({_with_places(grouped(self.places, causal))}); after a failure change one, "
                "test it with place_object / run_checks / probe_sim, then the next; or say with repairs=[{row, group, expect, hypothesis}] "
                "which failing row each answers, where these rows have nothing to do with each other: nothing links what moves in them by "
                "contact, joint, relation or exchange up to their first failing frames, or one is about what is drawn or said; or make all "
                f"of it in a world beside this one: {call('edit_spec', world='NEW', copy_of=self.world.folder.id)} with this patch, which "
                "is printed with its acceptance, as all that it asks less"
            )
        if not failing:
            return told
        wanted = {e for r in failing for e in (*(r.evidence.get("edit_classes") or ()), *(c.edit_class for c in r.corrections))}
        edit = GROUPS[causal[0]].edit_class
        if wanted & set(CAUSAL_CLASSES) and edit not in wanted:
            names = sorted({c.group for r in failing for c in r.corrections if c.edit_class in CAUSAL_CLASSES})
            told.append(
                f"the failing rows ask for a {'/'.join(sorted(wanted & set(CAUSAL_CLASSES)))} edit (groups {', '.join(names)}), "
                f"not a {edit} edit of {causal[0]!r}"
            )
        return told

    def attempts(self) -> list[Attempted]:
        """Hypotheses that the edit tests, each with its group, the failing rows that it answers, and its first places."""
        if self.joint is None:
            groups = grouped(self.places, self.causal) if len(self.causal) > 1 else {self.causal[0]: self.places}
            return [Attempted(self.hypothesis, name, self.failing, self._values(places), "") for name, places in groups.items()]
        rows, places = {r.id: r for r in self.answerable}, grouped(self.places, self.causal)
        return [
            Attempted(r.hypothesis, r.group, [rows[r.row]], self._values(places[r.group]), r.expect) for r in self.joint.repairs
        ]

    def _values(self, places: Sequence[str]) -> list[tuple[str, Any, Any]]:
        """The first causal ones of some changed places, with their values before and after."""
        changed = [p for p in places if group_of(p).edit_class in CAUSAL_CLASSES]
        before, after = self._documents
        return [(p, _value(before, p), _value(after, p)) for p in changed[:MAX_CHANGES]]

    def told(self) -> dict[str, Any]:
        """The edit for the model: changed places, parameter groups, stale artifacts, and the changes that it takes back."""
        more = len(self.places) - MAX_TOLD
        return {
            "changed": self.places[:MAX_TOLD] + ([f"and {more} more"] if more > 0 else []),
            "groups": sorted(g.name for g in self.groups),
            "stale": _shorten(self.stale),
            **({"undoes_revisions": [i["revision"] for i in self.undone]} if self.undone else {}),
        }


def _with_places(groups: Mapping[str, Sequence[str]]) -> str:
    """Groups in words, each with the first place that it changes."""
    return ", ".join(f"{name}: {places[0]}" if places else name for name, places in groups.items())


def _relations_of_new(before: WorldSpec, after: WorldSpec) -> set[str]:
    """Pointers of new relations that name an entity which the edit adds: they say how that one stands, and follow from it."""
    old, new = before.graph.relations, after.graph.relations
    added = after.entities.keys() - before.entities.keys()
    return {
        f"/graph/relations/{k}" for k, r in new.items() if k not in old and {getattr(r, "a", ""), getattr(r, "b", "")} & added
    }


def _own(places: Sequence[str], follows: Collection[str]) -> list[str]:
    """Places of an edit without those at or below a pointer that only follows."""
    below = tuple(f"{pointer}/" for pointer in follows)
    return [p for p in places if p not in follows and not p.startswith(below)]


def unjudged(ledger: Ledger, *, untested: bool = False) -> str:
    """Statement about motions that were looked at and never judged; empty where there are none."""
    looks = ledger.looks(untested=untested)
    if not looks:
        return ""
    latest = looks[-1]
    if latest["stage"].endswith(RAN):
        run = {"full": "bake"}.get(stage := latest["stage"].removesuffix(RAN), stage)
        return (
            f"the {run} {latest['freeze'][:16]} (revision {latest['revision']}) ran to frame {latest['last']} and was not judged: it was ended "
            "before, or goes on; what its frames show counts as evidence"
        )
    if latest["stage"] == "sketch":
        seen = "rows failed in, or frames were looked at without a verdict of,"
        return f"{seen} a sketch of frames 0..{latest['last']} of revision {latest['revision']}, which counts as evidence"
    run = {"full": "bake"}.get(latest["stage"], latest["stage"])
    told = (
        f"frames 0..{latest['last']} of the {run} {latest['freeze'][:16]} (revision {latest['revision']}) were looked at, and it was "
        "never judged, so that they count as evidence"
    )
    return f"{told} (while the settings are still these, run_checks(scope='probe') judges them)" if untested else told


def is_static(ledger: Ledger, iteration: Mapping[str, Any]) -> bool:
    """True if an iteration answers rows that static checks judge."""
    stages = ledger.stages()
    return all(stages.get(r, "static") in ("static", "audit", "stale") for r in json.loads(str(iteration["failing_before"])))


def _value(document: Any, pointer: str) -> Any:
    """Value of a document at a pointer, where it is a number, a word or a short list of them; else None."""
    at = document
    for token in pointer.split("/")[1:]:
        if not isinstance(at, dict) or token not in at:
            return None
        at = at[token]
    flat = at if isinstance(at, list) and len(at) <= MAX_LENGTH else [at]
    return at if all(v is None or isinstance(v, bool | int | float | str) for v in flat) else None


def _shorten(names: Sequence[str]) -> list[str]:
    """`static:a`, `static:b`, ... of many entities as one line."""
    kinds: dict[str, list[str]] = {}
    for name in names:
        kinds.setdefault(name.split(":", 1)[0], []).append(name)
    return [
        n
        for group in kinds.values()
        for n in (group if len(group) <= 6 else [*group[:3], f"and {len(group) - 3} more {group[0].split(':')[0]}"])
    ]
