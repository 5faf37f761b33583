"""Claims of a count against the motion and the geometry: exactly so many separate bodies, and exactly so many that do it (R131, R154).

Rival readings of a number n are n - 1 and n + 1:

- *fewer*: counted bodies that are welded or fastened to each other, or overlap where they start, are one lump; parts of a body that lie in
  one another are one. An event of the counted bodies that some of them do not do is one of fewer.
- *more*: a body that no claim speaks of and that looks the same is one more of them. So is a body of theirs that does it as well, unless
  an event of its own says so.
"""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...worlds.audits.counts import Counted, counted_of, countings_of
from ...worlds.claims import named_in
from ...worlds.predicates import And, Count, Or, atoms_of, entities_of
from ...worlds.predicates.events import event_atoms
from ...worlds.quoting import listed
from ...worlds.repeats import is_repeat
from ..predicates.combine import substitute
from ..predicates.evaluators import evaluate
from ..rows.corrections import correction
from ..rows.findings import Finding
from ..scene.surfaces import surfaces_of
from .lookalikes import alike
from .mapping import told_of
from .naming import beats_of
from .repeats import repeats_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...worlds.candidate import Candidate
    from ...worlds.spec import SpecModel, WorldSpec

__all__ = ["count_of", "is_measured"]

SHOWN = 4


class Tally(NamedTuple):
    """Number of those that a claim counts."""

    found: int
    text: str
    unknown: str = ""


def is_measured(spec: WorldSpec, name: str) -> bool:
    """True where geometry or motion can tell what a claim counts; a number of the specification is compared by the audit."""
    counted = counted_of(spec, name)
    return counted.asked is not None and bool(counted.bodies or counted.stories)


def count_of(candidate: Candidate, name: str) -> Finding:
    """The finding about a claim of a count."""
    if is_repeat(candidate.spec, name):
        return repeats_of(candidate, name)
    spec, counted = candidate.spec, counted_of(candidate.spec, name)
    asked, quote = float(counted.asked or 0), spec.claims[name].quote
    tallies = [
        *_pieces(candidate, name, counted),
        *_sides(candidate, counted),
        *_stories(candidate, name, counted),
        *_events(candidate, name, counted),
    ]
    evidence = {
        "rivals": [f"{asked - 1:g}", f"{asked + 1:g}"],
        "counts": {t.text: t.found for t in tallies},
        "entities": list(counted.bodies),
    }
    wrong = [t for t in tallies if t.found != asked and not t.unknown]
    unknown = [t for t in tallies if t.unknown]
    if wrong:
        worst = wrong[0]
        said = f"{quote!r} counts {asked:g}: {worst.text}"
        action = "let exactly so many separate bodies do it: take away, part or hold the others, or name all that the words count"
        hint = correction(said, "story", action, pointers=(f"/claims/{name}/by",))
        return Finding("fail", said, float(worst.found), asked, hints=(hint,), evidence=evidence, entities=counted.bodies)
    if unknown:
        return Finding("unverified", f"{quote!r}: {unknown[0].unknown}", evidence=evidence, entities=counted.bodies)
    told = "; ".join(t.text for t in tallies)
    return Finding("pass", f"{quote!r}: {told}", asked, asked, evidence=evidence, entities=counted.bodies)


# ---------------------------------------------------------------- how many there are


def _pieces(candidate: Candidate, name: str, counted: Counted) -> list[Tally]:
    """Separate lumps among the counted things, and bodies beside them that look the same."""
    if not counted.units:
        return []
    links = _parts_inside(candidate, counted) if len(counted.bodies) < len(counted.units) else _joined(candidate, counted)
    root = {u: u for u in counted.units}

    def top(unit: str) -> str:
        while root[unit] != unit:
            unit = root[unit]
        return unit

    for a, b, _ in links:
        root[top(a)] = top(b)
    lumps = len({top(u) for u in counted.units})
    why = "".join(f"; {_short(a)} and {_short(b)} {how}" for a, b, how in links[:2])
    more = _lookalikes(candidate, name, counted)
    if more:
        why += f"; {listed(more, SHOWN)} beside them looks the same, and no claim speaks of it"
    return [Tally(lumps + len(more), f"{lumps + len(more)} separate bodies{why}")]


def _sides(candidate: Candidate, counted: Counted) -> list[Tally]:
    """Number of the counted bodies that stand in equal groups on two sides, where the words give their number to each.

    They do where a level direction parts them by a gap that is wider than either group is deep in it.
    """
    known = [n for n in counted.bodies if n in candidate.solids]
    if counted.sides != 2 or len(known) < 2:
        return []
    boxes = [candidate.vertices(n, 0) for n in known]
    places = np.array([0.5 * (b.min(axis=0) + b.max(axis=0)) for b in boxes])
    flat = places[:, :2] - places[:, :2].mean(axis=0)
    half, best, fuller = len(known) // 2, -np.inf, len(known)
    for axis in (*np.linalg.eigh(flat.T @ flat)[1].T, *np.eye(2)):
        along = np.sort(flat @ axis)
        gaps = np.diff(along)
        cut = int(np.argmax(gaps)) + 1
        deep = max(along[cut - 1] - along[0], along[-1] - along[cut])
        if gaps[cut - 1] > deep and gaps[cut - 1] - deep > best:
            best, fuller = float(gaps[cut - 1] - deep), max(cut, len(known) - cut)
    found = len(known) if 2 * fuller == len(known) == 2 * half else 2 * (len(known) - fuller)
    text = f"{half} stand on each side" if found == len(known) else f"they do not stand {half} on each of two sides"
    return [Tally(found, text)]


def _short(unit: str) -> str:
    return unit.removeprefix("/entities/")


def _joined(candidate: Candidate, counted: Counted) -> list[tuple[str, str, str]]:
    """Pairs of counted bodies that are one lump, and how."""
    spec, bodies = candidate.spec, set(counted.bodies)
    plan = spec.simulation
    cut = {d.joint for d in plan.drivers.values() if d.kind == "detach"}
    pairs = {
        (j.parent, j.child): "are welded to each other"
        for n, j in plan.joints.items()
        if j.kind == "weld" and n not in cut and j.parent
    }
    pairs |= {(r.a, r.b): "are fastened to each other" for r in spec.graph.relations.values() if r.kind == "fastened"}
    solids = [n for n in counted.bodies if n in candidate.solids]
    if len(solids) > 1:
        deepest = -spec.simulation.limits.contact_gap
        pairs |= {p: f"overlap by {-gap:.3g} m at frame 0" for p, gap in surfaces_of(candidate).first.items() if gap < deepest}
    found = [(a, b, how) for (a, b), how in pairs.items() if a in bodies and b in bodies and a != b]
    return [(f"/entities/{a}", f"/entities/{b}", how) for a, b, how in found]


def _parts_inside(candidate: Candidate, counted: Counted) -> list[tuple[str, str, str]]:
    """Pairs of counted parts of which one lies in the box of the other."""
    boxes = {}
    for unit in counted.units:
        keys = unit.split("/")
        parts = [p for p in candidate.entity(keys[2]).parts if len(keys) == 3 or p.part == keys[4]]
        corners = np.concatenate([p.render.vertices for p in parts])
        boxes[unit] = (keys[2], corners.min(axis=0), corners.max(axis=0))
    slack = candidate.spec.simulation.limits.contact_gap
    found = []
    for a, b in combinations(counted.units, 2):
        (one, low, high), (other, below, above) = boxes[a], boxes[b]
        inside = (low >= below - slack).all() and (high <= above + slack).all()
        around = (below >= low - slack).all() and (above <= high + slack).all()
        if one == other and (inside or around):
            found.append((a, b, "lie in one another"))
    return found


def _lookalikes(candidate: Candidate, name: str, counted: Counted) -> list[str]:
    """Bodies that no claim of a thing or count names and that look like a counted one."""
    spec = candidate.spec
    spoken = {
        n for other, c in spec.claims.items() if c.type in ("thing", "count") for n in named_in(spec, other, "entities")
    } | set(counted.bodies)
    rest = [n for n in candidate.solids if n not in spoken]
    own = [n for n in counted.bodies if n in candidate.solids] if "/parts/" not in counted.units[0] else []
    return [n for n in rest if any(alike(candidate, n, body) for body in own)]


# ---------------------------------------------------------------- how many do it


def _stories(candidate: Candidate, name: str, counted: Counted) -> list[Tally]:
    """Numbers of those who do what a beat or requirement counts that the claim names, with others like them."""
    found = []
    for group, key in counted.stories:
        told = getattr(candidate.spec.story, group.split("/")[1]).get(key)
        if told is None:
            continue
        frames = told.frames or (0, candidate.spec.simulation.frames - 1)
        for count in countings_of(told.predicate):
            found.append(_doers(candidate, name, count, frames, tuple(count.entities), key))
    return found


def _events(candidate: Candidate, name: str, counted: Counted) -> list[Tally]:
    """Numbers of those who do what events say that are told of all the counted bodies; parts of one body do what it does."""
    spec, bodies, found = candidate.spec, set(counted.bodies), []
    if len(bodies) < len(counted.units):
        return []
    elsewhere = {b for other, c in spec.claims.items() if c.type == "count" for b in beats_of(spec, other)}
    for claim_name, claim in spec.claims.items():
        if claim.type != "event" or claim.waived is not None or not claim.by:
            continue
        beats = [b for b in beats_of(spec, claim_name) if b not in elsewhere]
        about = {b: set(entities_of(spec.story.beats[b].predicate)) & bodies for b in beats}
        if set().union(*about.values()) != bodies or not bodies:
            continue
        tellers = [(spec.story.beats[b].predicate, spec.story.beats[b].frames) for b in beats if about[b]]
        found.append(_tally(candidate, name, tellers, counted.bodies, repr(claim.quote)))
    return found


def _doers(candidate: Candidate, name: str, count: Count, frames: tuple[int, int], bodies: tuple[str, ...], key: str) -> Tally:
    return _tally(candidate, name, [(count, frames)], bodies, key)


def _tally(
    candidate: Candidate, name: str, tellers: Sequence[tuple[SpecModel, tuple[int, int]]], bodies: tuple[str, ...], what: str
) -> Tally:
    """Number of some bodies, and of others like them, that do what predicates tell of the bodies."""
    does, unknown = [], ""
    for body in bodies:
        outcomes = [evaluate(candidate, p, f) for p, f in _of_body(tellers, body)]
        if any(o.status == "pass" for o in outcomes):
            does.append(body)
        elif any(o.status == "unverified" for o in outcomes):
            unknown = unknown or f"whether {body} does {what} is not known"
    more = [n for n in _others(candidate, name, tellers, bodies) if _does_too(candidate, tellers, bodies, n)]
    text = f"{what} is true of {len(does) + len(more)}"
    idle = [n for n in bodies if n not in does]
    text += f", not of {listed(idle, SHOWN)}" if idle and not unknown else ""
    text += f", of {listed(more, SHOWN)} as well" if more else ""
    return Tally(len(does) + len(more), text, unknown)


def _of_body(tellers: Sequence[tuple[SpecModel, tuple[int, int]]], body: str) -> list[tuple[SpecModel, tuple[int, int]]]:
    """Parts of predicates that speak of one body, with their frames."""
    return [(own, frames) for predicate, frames in tellers if (own := _restricted(predicate, body)) is not None]


def _restricted(predicate: SpecModel, body: str) -> SpecModel | None:
    """The part of a predicate that speaks of one body; None where it says nothing of it."""
    if isinstance(predicate, Count):
        return substitute(predicate.predicate, body) if body in predicate.entities else None
    if isinstance(predicate, And | Or):
        own = [p for member in predicate.of if (p := _restricted(member, body)) is not None]
        return predicate.model_copy(update={"of": own}) if own else None
    inner = getattr(predicate, "predicate", None)
    if inner is not None and atoms_of(predicate) != [predicate]:
        own_inner = _restricted(inner, body)
        return None if own_inner is None else predicate.model_copy(update={"predicate": own_inner})
    return predicate if body in entities_of(predicate) else None


def _does_too(
    candidate: Candidate, tellers: Sequence[tuple[SpecModel, tuple[int, int]]], bodies: tuple[str, ...], other: str
) -> bool:
    """True where another body does what predicates say of one of the bodies."""
    for body in bodies:
        for predicate, frames in _of_body(tellers, body):
            mapped = told_of(predicate, body, other)
            if mapped != predicate and evaluate(candidate, mapped, frames).status == "pass":
                return True
    return False


def _others(
    candidate: Candidate, name: str, tellers: Sequence[tuple[SpecModel, tuple[int, int]]], bodies: tuple[str, ...]
) -> list[str]:
    """Bodies like the counted ones: of the same words, or that look the same; but for those of which another event says the same."""
    spec, own = candidate.spec, set(bodies)
    kinds = {str(getattr(a, "kind", "")) for p, _ in tellers for a in event_atoms(p) or atoms_of(p)}
    found: dict[str, None] = {}
    for other, claim in spec.claims.items():
        named = set(named_in(spec, other, "entities"))
        if claim.type in ("thing", "count") and claim.waived is None and own & named:
            found |= dict.fromkeys(sorted(named - own))
    for n in candidate.solids:
        if n not in own and any(b in candidate.solids and alike(candidate, n, b) for b in bodies):
            found[n] = None
    return [n for n in found if n in spec.entities and not _told_itself(spec, n, kinds, own)]


def _told_itself(spec: WorldSpec, body: str, kinds: set[str], counted: set[str]) -> bool:
    """True where an event claim says one of some kinds of a body, and of none of the counted ones."""
    for other, claim in spec.claims.items():
        if claim.type != "event" or claim.waived is not None:
            continue
        atoms = [a for b in beats_of(spec, other) for a in event_atoms(spec.story.beats[b].predicate)]
        mine = [a for a in atoms if body in entities_of(a) and str(getattr(a, "kind", "")) in kinds]
        if any(not set(entities_of(a)) & counted for a in mine):
            return True
    return False
