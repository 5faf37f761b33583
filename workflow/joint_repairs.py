"""Repairs of independent failures in one edit: each parameter group answers a row of its own, in a part of the world that the others do not reach.

A departure from R113, which asks for one group per failed run: faults that cannot have to do with each other need not wait for each other.
Two rows are independent where what moves in them lies in different components of the failed run: nothing links them by contact, joint,
relation or exchange up to the later of their first failing frames. A row about what is drawn or said has nothing to do with a motion,
whosever it is; what answers it may, and then moves nothing that another row is about.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..worlds.arrays import F64
from ..worlds.drivers import acts_from
from ..worlds.errors import EvidenceError
from ..worlds.groups import group_of
from ..worlds.hints import did_you_mean
from ..worlds.instances import coupled_groups
from .arguments import Repair

if TYPE_CHECKING:
    from ..worlds.candidate import Candidate
    from ..worlds.ledger import Ledger
    from ..worlds.requirements import Row
    from ..worlds.spec import WorldSpec

__all__ = ["Joint", "Linked", "grouped", "joint_objections", "resolved", "said_by", "said_of"]

ALONE = frozenset({"step", "contact", "interval", "terrain"})
"""Groups that act on everything."""
GRAVITY = "/simulation/gravity"
DRAWN = frozenset({"claim:unseen", "claim:property:colour", "claim:look", "claim:time"})
"""Questions about what is drawn, lit and said, which no motion decides."""
MOVES_BY = 1e-9
"""Least relative change of a measurement that has a direction."""
NONE_FAILS = (
    "no row of the matrix does (what fails in a sketch is none): leave repairs out, and edit one parameter group at a time"
)
"""End of an objection to repairs where nothing fails."""


class Joint(NamedTuple):
    """Repairs of several parameter groups in one edit, and the run that failed."""

    repairs: tuple[Repair, ...]
    candidate: Candidate


class Linked:
    """The parts of a world that reached each other in a run, up to a frame.

    Args:
        candidate: the run; at the static stage only relations and joints link.
        last: frame up to which contacts and exchange count.
    """

    def __init__(self, candidate: Candidate, last: int) -> None:
        self._spec = spec = candidate.spec
        self._root = {name: name for name, entity in spec.entities.items() if entity.motion != "static"}
        self._beside: dict[str, set[str]] = {name: set() for name in spec.entities}
        for relation in spec.graph.relations.values():
            self._join(relation.a, relation.b)
        for joint in spec.simulation.joints.values():
            self._join(joint.child, joint.parent)
        for driver in spec.simulation.drivers:
            self._join(*_acted_on(spec, driver))
        last = min(last, candidate.last_frame)
        bodies = [n for c in candidate.rigid_caches.values() for n in _owners(c.index.bodies)]
        for name in candidate.caches:
            if name in spec.simulation.rigid:
                self._touching(candidate, name, last)
            elif not any(name in group for group in coupled_groups(spec)):
                # It reads the bodies' motion and tells nothing of it: any of them may have moved it.
                self._join(*spec.simulation.solvers[name].members, *bodies)

    def component(self, names: Iterable[str]) -> frozenset[str]:
        """Everything that moves and is linked with some entities; with static ones, what touches them."""
        seeds = {m for n in names for m in ({n} if n in self._root else self._beside.get(n, set()))}
        roots = {self._find(m) for m in seeds if m in self._root}
        return frozenset(n for n in self._root if self._find(n) in roots)

    def _touching(self, candidate: Candidate, name: str, last: int) -> None:
        """Link what touched within a rigid instance, and what it exchanged impulses with."""
        cache, spec = candidate.caches[name], self._spec
        colliders = cache.index.colliders
        for log in cache.ragged("contact/pair", "event/pair")[: last + 1]:
            for pairs in log.values():
                for a, b in np.unique(np.asarray(pairs).reshape(-1, 2), axis=0).tolist():
                    self._join(colliders[a], colliders[b])
        partners = next((g for g in coupled_groups(spec) if name in g), frozenset())
        if partners - {name}:
            given: F64 = np.abs(cache.series("exchange/impulse")[: last + 1]).sum(axis=(0, 2))
            pushed = _owners(b for b, much in zip(cache.index.bodies, given, strict=True) if much > 0)
            self._join(*(m for p in partners - {name} for m in spec.simulation.solvers[p].members), *pushed)

    def _join(self, *names: str | None) -> None:
        known = [n for n in names if n is not None and n in self._beside]
        for a in known:
            self._beside[a] |= {*known} - {a}
        moving = [self._find(n) for n in known if n in self._root]
        for other in moving[1:]:
            self._root[self._find(other)] = self._find(moving[0])

    def _find(self, name: str) -> str:
        while self._root[name] != name:
            name = self._root[name]
        return name


def _owners(bodies: Iterable[str]) -> list[str]:
    return list(dict.fromkeys(b.partition("/")[0] for b in bodies))


def _acted_on(spec: WorldSpec, driver: str) -> tuple[str, ...]:
    try:
        return acts_from(spec, driver)[1]
    except EvidenceError:
        return ()


def joint_objections(
    joint: Joint, failing: Sequence[Row], places: Mapping[str, Sequence[str]], stages: Mapping[str, str], after: WorldSpec
) -> list[str]:
    """Objections to an edit of several parameter groups, each of which is to answer a row of its own.

    Args:
        joint: one repair per group, and the failed run.
        failing: rows that fail, optional ones too.
        places: JSON pointers that the edit changes, by causal group.
        stages: at which each row was judged.
        after: the specification after the edit.
    """
    repairs, candidate = joint
    rows = {r.id: r for r in failing}
    told = _unpaired(rows, places, repairs)
    if told:
        return told
    if candidate.stage == "static" and (moved := [r.row for r in repairs if stages.get(r.row) in ("probe", "full", "stale")]):
        return [
            f"the run in which {', '.join(moved)} failed is not there, so that nobody can tell what they have to do with each other"
        ]
    alone = sorted({g for g in places if g in ALONE} | {"drivers" for p in places.get("drivers", ()) if p.startswith(GRAVITY)})
    if alone and len(places) > 1:
        return [f"{', '.join(alone)} acts on the whole world, so that it is changed alone; test it, then the others"]
    return [*told, *_dependent(joint, rows, places, after)]


def resolved(repairs: Iterable[Repair], places: Mapping[str, Sequence[str]]) -> tuple[Repair, ...]:
    """Repairs by their groups, where some name a field or its JSON pointer instead (`damping`, `motion`): what holds it among the changed places.

    Args:
        repairs: as they were written.
        places: JSON pointers that the edit changes, by causal group.
    """
    return tuple(r if r.group in places else r.model_copy(update={"group": _group_with(r.group, places)}) for r in repairs)


def _group_with(named: str, places: Mapping[str, Sequence[str]]) -> str:
    """The one group among whose changed places is the field or pointer of that name; the name itself where none or several are."""
    token = named.strip("/")
    found = [g for g, changed in places.items() if any(f"/{token}/" in f"{p}/" for p in changed)]
    return found[0] if token and len(found) == 1 else named


def _dependent(joint: Joint, rows: Mapping[str, Row], places: Mapping[str, Sequence[str]], after: WorldSpec) -> Iterator[str]:
    """Objections to repairs of rows that have to do with each other, or by changes that reach further than their rows."""
    repairs, candidate = joint
    spec = candidate.spec
    drawn = {r.row for r in repairs if rows[r.row].question in DRAWN}
    last = max((_first_frame(rows[r.row], candidate) for r in repairs), default=0)
    linked = Linked(candidate, last)
    reach = {r.row: linked.component(_named(rows[r.row])) for r in repairs}
    for k, one in enumerate(repairs):
        for other in repairs[k + 1 :]:
            if not {one.row, other.row} & drawn and (common := reach[one.row] & reach[other.row]):
                yield (
                    f"{one.row} and {other.row} are not independent: {', '.join(sorted(common)[:4])} had to do with both up to frame {last}; "
                    "mend the earlier one first"
                )
        moving = [p for p in places[one.group] if not _only_drawn(p, spec, after)]
        changed = linked.component({n for p in moving for n in _entities_at(spec, p)})
        if more := changed - reach[one.row]:
            yield f"the change of {one.group} reaches {', '.join(sorted(more)[:4])}, which had no part in {one.row}"
        for other in repairs if one.row in drawn else ():
            if other.row not in drawn and (common := changed & reach[other.row]):
                yield (
                    f"the change of {one.group} may move {', '.join(sorted(common)[:4])}, which {other.row} is about; answer {one.row} by what is "
                    "drawn alone (parts of static entities that do not collide), or one after the other"
                )


def _only_drawn(pointer: str, *specs: WorldSpec) -> bool:
    """True if what stands at a pointer is, in each specification that has it, of static entities and collides with nothing."""
    head, name, kind, part = [*pointer.split("/"), "", "", ""][1:5]
    there = [spec.entities[name] for spec in specs if head == "entities" and name in spec.entities]
    parts = [e.parts.values() if kind != "parts" or not part else [e.parts[part]] if part in e.parts else [] for e in there]
    return bool(there) and all(e.motion == "static" for e in there) and not any(p.collides for held in parts for p in held)


def _unpaired(rows: Mapping[str, Row], places: Mapping[str, Sequence[str]], repairs: Sequence[Repair]) -> list[str]:
    """Objections to repairs that do not name one failing row for each group, and one group for each row."""
    told = []
    for repair in repairs:
        if repair.row not in rows:
            hint = did_you_mean(repair.row, rows) or ";"
            known = f"these do: {', '.join(sorted(rows)[:8])}" if rows else NONE_FAILS
            told.append(f"repairs name row {repair.row!r}, which does not fail{hint} {known}")
        if repair.group not in places:
            known = "; ".join(f"{g} ({', '.join(changed[:2])})" for g, changed in sorted(places.items()))
            told.append(f"repairs name group {repair.group!r}, which this edit does not change; it changes {known}")
    named = [r.group for r in repairs]
    told += [
        f"the change of {g} ({', '.join(places[g][:2])}) answers no row: add {{'row', 'group': {g!r}, 'expect', 'hypothesis'}} to repairs"
        for g in sorted(set(places) - set(named))
    ]
    twice = {n for n in named if named.count(n) > 1} | {r.row for r in repairs if [s.row for s in repairs].count(r.row) > 1}
    return told + [f"repairs name {n!r} twice: one group for one row each" for n in sorted(twice)]


def _named(row: Row) -> set[str]:
    return {n for n in (*row.entities, row.first_failing_entity) if n}


def _first_frame(row: Row, candidate: Candidate) -> int:
    return candidate.last_frame if row.first_failing_frame is None else row.first_failing_frame


def _entities_at(spec: WorldSpec, pointer: str) -> set[str]:
    """Entities that a place of the specification is about; all where it is about the whole."""
    head, _, rest = pointer[1:].partition("/")
    name = rest.partition("/")[0]
    if head == "entities":
        return {name}
    if head == "materials":
        return {n for n, e in spec.entities.items() if name in {e.material, *(p.material for p in e.parts.values())}}
    plan, (_, kind, key) = spec.simulation, [*pointer.split("/"), "", "", ""][1:4]
    if kind == "joints" and key in plan.joints:
        return {n for n in (plan.joints[key].child, plan.joints[key].parent) if n}
    if kind == "drivers" and key in plan.drivers:
        return set(_acted_on(spec, key))
    if kind == "solvers" and key in plan.solvers:
        return set(plan.solvers[key].members)
    if head == "graph" and kind == "relations" and key in spec.graph.relations:
        return {spec.graph.relations[key].a, spec.graph.relations[key].b}
    return set(spec.entities)


def grouped(places: Iterable[str], causal: Sequence[str]) -> dict[str, list[str]]:
    """Changed places by the causal groups that an edit counts as; a place that follows from another's counts with it."""
    found: dict[str, list[str]] = {name: [] for name in causal}
    for place in places:
        name = group_of(place).name
        if name in found:
            found[name].append(place)
        elif name in ("dimensions", "placement") and "shape" in found:
            found["shape"].append(place)
    return found


def said_of(iteration: Mapping[str, Any]) -> dict[str, Any] | None:
    """Outcome of a repair that said what it expects; None of one that did not, or is not tested yet.

    `confirmed`: its row does not fail any more, or measures more or less as expected; `refuted`: it was judged and does neither; `untested`: it was
    not judged by the test.
    """
    expected = iteration.get("expect")
    if not expected or iteration.get("probe") is None:
        return None
    row = iteration["failing_before"][0]
    before, after = ((iteration[k] or {}).get(row, {}) for k in ("before", "after"))
    told = {
        "row": row,
        "group": iteration["grp"],
        "expected": expected,
        "before": before.get("measured"),
        "after": after.get("measured"),
    }
    if not after:
        return {**told, "said": "untested"}
    if after.get("status") != "fail":
        return {**told, "said": "confirmed"}
    old, new = before.get("measured"), after.get("measured")
    if old is None or new is None:
        return {**told, "said": "refuted"}
    gain = (new - old) * (1 if expected == "higher" else -1)
    return {**told, "said": "confirmed" if gain > MOVES_BY * max(abs(old), abs(new)) else "refuted"}


def said_by(ledger: Ledger, probe: str) -> dict[str, Any]:
    """Part of a reply about the repairs that a test has answered; empty where none said what it expects."""
    found = [said for i in ledger.iterations() if i["probe"] == probe and (said := said_of(i))]
    return {"repairs": found} if found else {}
