"""Branches of an `or`: one that never comes true is no outcome of this world, and what is asked for by it alone is not asked for.

A wanted effect joined with something that holds anyway would be met by the latter. Every branch therefore has to come true: in the
recorded motion over the frames of its beat or requirement, or in a perturbed run where the beat has a sample of them (R156).

Of a `count` a branch counts when it is true of any entity; within `always` and `until`, when it is true at any frame. A negated `and`
is an `or` of its negated members.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ...worlds.candidate import Candidate
from ...worlds.errors import EvidenceError
from ...worlds.predicates import Always, And, Count, Not, Or, Until, describe_predicate, entities_of
from ...worlds.spec import Perturbed, Requirement
from ..predicates.combine import substitute
from ..predicates.evaluators import evaluate
from ..rows.answers import row_of
from ..rows.corrections import correction
from ..rows.findings import Finding, lacking
from .questions import BRANCHES, CHOICES

if TYPE_CHECKING:
    from ...worlds.requirements import Row
    from ...worlds.spec import Beat, SpecModel

__all__ = ["Branch", "branch_lines", "branches_of", "check_branches", "comes_true"]

NAMED = 4
"""Branches that a sentence quotes."""


@dataclass(frozen=True)
class Branch:
    """One side of an `or`, where it stands and what it may be true of."""

    pointer: str
    predicate: SpecModel
    frames: tuple[int, int]
    each: tuple[str, ...] = ()
    """Entities of the `count` around it."""
    at_a_frame: bool = False
    """True if truth at one frame is enough, as within `always`."""

    @property
    def text(self) -> str:
        """In words."""
        return describe_predicate(self.predicate)


def branches_of(declared: Beat | Requirement, pointer: str, last: int) -> list[Branch]:
    """Every branch of every `or` in the predicate of a beat or requirement, whose own frames default to 0 to `last`."""
    start = Branch(f"{pointer}/predicate", declared.predicate, declared.frames or (0, last))
    return list(_within(start, wanted=not (isinstance(declared, Requirement) and declared.never)))


def _within(node: Branch, *, wanted: bool) -> Iterator[Branch]:
    """Branches below a node; `wanted` says that its truth helps, not its falsehood."""
    predicate = node.predicate
    if isinstance(predicate, (And, Or)):
        choice = isinstance(predicate, Or) == wanted and len(predicate.of) > 1
        for k, member in enumerate(predicate.of):
            below = replace(node, pointer=f"{node.pointer}/of/{k}", predicate=member)
            if choice:
                yield below if wanted else replace(below, predicate=Not(predicate=member))
            yield from _within(below, wanted=wanted)
        return
    more = replace(
        node,
        frames=getattr(predicate, "frames", None) or node.frames if not _counts_frames(predicate) else node.frames,
        at_a_frame=node.at_a_frame or isinstance(predicate, (Always, Until)),
        each=tuple(predicate.entities) if isinstance(predicate, Count) else node.each,
    )
    if isinstance(predicate, Not) or (isinstance(predicate, Count) and predicate.min is None):
        wanted = not wanted
    for name in ("predicate", "hold", "goal"):
        inner: SpecModel | None = getattr(predicate, name, None)
        if inner is not None:
            yield from _within(replace(more, pointer=f"{node.pointer}/{name}", predicate=inner), wanted=wanted)


def _counts_frames(predicate: SpecModel) -> bool:
    """True if `frames` of a predicate is a number of frames, as that of `within`, and no interval."""
    return isinstance(getattr(predicate, "frames", None), int)


def comes_true(candidate: Candidate, branch: Branch) -> bool:
    """True if a motion makes a branch true.

    Raises:
        EvidenceError: it cannot be judged.
    """
    unknown = ""
    for name in branch.each or ("",):
        asked = substitute(branch.predicate, name) if name else branch.predicate
        outcome = evaluate(candidate, asked, branch.frames)
        at_a_frame = branch.at_a_frame and outcome.truth is not None and bool(outcome.truth.any())
        if outcome.status == "pass" or (at_a_frame and outcome.status == "fail"):
            return True
        unknown = unknown or (outcome.explanation if outcome.status == "unverified" else "")
    if unknown:
        raise EvidenceError(unknown)
    return False


def check_branches(candidate: Candidate, declared: Beat | Requirement, name: str) -> list[Row]:
    """Row `beat:branches:<id>` or `requirement:branches:<id>`; none for a predicate without a choice."""
    subject: str | None = getattr(declared, "subject", None)
    group = "requirements" if subject is None else "beats"
    pointer, last = f"/story/{group}/{name}", candidate.spec.simulation.frames - 1
    branches = branches_of(declared, pointer, last)
    if not branches:
        return []
    try:
        never = [b for b in branches if not comes_true(candidate, b)]
        found = _judged(branches, never, [] if subject is None else _sampled(candidate, name))
    except EvidenceError as error:
        found = lacking(error)
    frames = (0, declared.frames[1] if declared.frames else last)
    entities = (*([subject] if subject else []), *entities_of(declared.predicate))
    question = replace(CHOICES if subject is None else BRANCHES, mandatory=declared.mandatory)
    extra = [declared.model_dump(mode="json"), *_sampled(candidate, name)]
    return [row_of(candidate, question, (name,), replace(found, frames=frames), entities=entities, extra=extra)]


def _sampled(candidate: Candidate, beat: str) -> list[str]:
    """Samples of perturbed runs that judge a beat."""
    return [k for k, item in candidate.spec.story.robustness.items() if isinstance(item, Perturbed) and beat in item.beats]


def _judged(branches: list[Branch], never: list[Branch], samples: list[str]) -> Finding:
    """The finding about an `or` of which some branches never came true in the recorded motion."""
    if not never:
        return Finding("pass", f"all {len(branches)} branches come true", 0.0, 0.0)
    text = told(branches, never)
    if samples:
        return Finding("pass", f"{text}; the perturbed runs of {samples[0]!r} decide about the others", 0.0, 0.0)
    hints = tuple(
        correction(
            f"{b.text} never comes true, so that the other side of the `or` alone decides",
            "story",
            f"drop that branch, {b.pointer}, and ask for what happens; if it is what the prompt tells, drop the others and mend the motion",
            pointers=(b.pointer,),
            patch=({"op": "remove", "path": b.pointer},) if len(never) == 1 else (),
        )
        for b in never[:NAMED]
    )
    evidence = {"never": [b.pointer for b in never], "pointers": [b.pointer for b in never]}
    return Finding("fail", text, float(len(never)), 0.0, frame=never[0].frames[1], hints=hints, evidence=evidence)


def told(branches: Iterable[Branch], never: list[Branch]) -> str:
    """Sentence about the branches that came true and those that never did."""
    places = {b.pointer for b in never}
    came = [b.text for b in branches if b.pointer not in places]
    only = f"only {', '.join(came[:NAMED])} came true" if came else "no branch came true"
    return f"{only}; {', '.join(b.text for b in never[:NAMED])} never did"


def branch_lines(candidate: Candidate) -> list[dict[str, str]]:
    """Lines of the register about branches that never came true in the recorded motion."""
    story, last, lines = candidate.spec.story, candidate.spec.simulation.frames - 1, []
    for group, entries in (("beats", story.beats), ("requirements", story.requirements)):
        for name, declared in entries.items():
            branches = branches_of(declared, f"/story/{group}/{name}", last)
            try:
                never = [b for b in branches if not comes_true(candidate, b)]
            except EvidenceError:
                continue  # its row says so
            if never:
                lines.append({"what": f"`or` of the {group[:-1]} {name!r}", "effect": told(branches, never)})
    return lines
