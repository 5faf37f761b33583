"""Pushes of a gas on what it carries: they are those of its own velocities past it, and how much of its momentum they are (R66, R105)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ....worlds.categories.gas.carrying import carried_members, carries
from ....worlds.errors import EvidenceError
from ....worlds.instances import felt_by
from ...rows.corrections import bake_again, halve_step
from ...rows.findings import Finding
from ..judge import Push
from .bounds import PUSHED
from .frames import box_of
from .pushed import given_by
from .questions import PUSHING
from .returned import returned_share
from .rows import kept_within

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ....worlds.arrays import F64
    from ....worlds.candidate import Candidate
    from ...rows.questions import Question
    from .cells import GasFrame
    from .frames import GasBox
    from .stream import Given

__all__ = ["Pushing", "carried_pushes", "pushing_lines"]

TINY = 1e-12
"""[N s]"""


class Pushing:
    """Impulses on all that a gas carries."""

    questions: ClassVar[Mapping[str, Question]] = PUSHING

    def __init__(self, box: GasBox) -> None:
        self.box = box

    def see(self, now: GasFrame, before: GasFrame | None) -> None:
        """Nothing: what is carried stands in other caches."""

    def findings(self) -> dict[str, Finding]:
        """Finding on the question by name."""
        if not carries(self.box.candidate.spec, self.box.solver):
            return {name: Finding("not_applicable", "no coupling lets it carry anything") for name in PUSHING}
        return {"pushed": self._pushed([g for g in given_by(self.box) if g.judged.any()])}

    def _pushed(self, found: list[Given]) -> Finding:
        """Recorded impulses against those worked out, summed from frame 0 over the intervals that are judged."""
        if not found:
            return Finding(
                "unverified",
                "nothing that it carries is free, awake and within its box from one frame to the next, so that nothing tells how it pushes",
            )
        offs = [_off(g) for g in found]
        worst = int(np.argmax([float(o.max()) for o in offs]))
        given, off = found[worst], offs[worst]
        who = ", ".join(given.entities)

        def told(frame: int | None) -> str:
            recorded, own = (
                np.cumsum(np.where(given.judged[:, None], a, 0.0), axis=0) for a in (given.recorded, given.worked_out)
            )
            k = -1 if frame is None else max(frame - 1, 0)
            sizes = f"{_size(recorded[k]):.4g} N s recorded and {_size(own[k]):.4g} N s by its cells"
            return f"what it gave to {who} by {'the last frame' if frame is None else f'frame {frame}'}: {sizes} (in {given.judged.sum()} intervals)"

        spec = self.box.candidate.spec
        owner = next(n for n, i in spec.simulation.solvers.items() if given.entities[0] in i.members)
        hints = (bake_again(), halve_step(self.box.candidate, owner, "the push changes much within a step"))
        evidence = {"given_Ns": float(_size(given.worked_out.sum(axis=0))), "entities": list(given.entities)}
        return kept_within(off, PUSHED, "1", told, hints, evidence)


def _off(given: Given) -> F64:
    """Difference of both sums over the largest of these, by frame, shape (F,)."""
    recorded, own = (np.cumsum(np.where(given.judged[:, None], a, 0.0), axis=0) for a in (given.recorded, given.worked_out))
    scale = max(float(np.linalg.norm(own, axis=1).max()), float(np.linalg.norm(recorded, axis=1).max()), TINY)
    doubt = 0.0 if given.doubt is None else np.cumsum(np.where(given.judged, given.doubt, 0.0))
    return np.concatenate([[0.0], np.maximum(given.off() - doubt, 0.0) / scale])


def _size(vector: F64) -> float:
    return float(np.linalg.norm(vector))


def carried_pushes(found: list[list[Push]], candidate: Candidate, solver: str) -> None:
    """Add to the pushes of each frame those of a gas on what it carries."""
    fps, box = candidate.spec.simulation.fps, box_of(candidate, solver)
    for given in given_by(box):
        for entity, impulses in given.shares.items():
            for k, size in enumerate(np.linalg.norm(impulses, axis=1).tolist()):
                if size > 0.0 and k + 1 < len(found):
                    found[k + 1] += [Push(m, entity, k / fps, (k + 1) / fps, size) for m in box.members]


def pushing_lines(candidate: Candidate) -> list[dict[str, str]]:
    """Lines of the approximation register: what gases carry, and how much of their momentum that takes."""
    spec, found = candidate.spec, []
    for name in spec.simulation.gas:
        carried = carried_members(spec, name)
        if not carried:
            continue
        found += [*_felt_lines(candidate, name, carried)]
        flat = any(spec.entities[m].physics.lifted for members in carried.values() for m in members)
        found += [
            {
                "what": f"the gas of {name!r} acts on rigid bodies by its velocity at their centre of mass and one drag coefficient",
                "effect": (
                    "no buoyancy, and no lift and torque on what declares none: a balloon does not rise by its lightness"
                    if flat
                    else "no lift across the flow, no torque and no buoyancy: nothing spins in it, and a balloon does not rise by its lightness"
                ),
            },
            {
                "what": f"between two frames and two middles of cells the gas of {name!r} that carries is taken as changing evenly",
                "effect": "eddies that turn over within a frame or a cell push nothing",
            },
            {
                "what": f"beyond the box of {name!r} what it carries meets, within four cells, the declared fields, and still air where there are none",
                "effect": "what flows out of the box carries nothing farther",
            },
        ]
    return found


def _felt_lines(candidate: Candidate, name: str, carried: Mapping[str, tuple[str, ...]]) -> Iterator[dict[str, str]]:
    """Lines about what a gas carries, as far as it feels it, and as far as it does not."""
    felt = felt_by(candidate.spec, name)
    for ones in (tuple(c for c in carried if c not in felt), felt):
        listed = ", ".join(repr(m) for c in ones for m in carried.get(c, ()))
        if not listed:
            continue
        if ones is felt:
            yield {
                "what": f"the gas of {name!r} feels the drag of {listed}, spread over the cells about each, and flows through them",
                "effect": "nothing is parted or shaded by them but by drag; what is as wide as a cell drags on part of its own wake: 8 % too little, two cells wide 14 %, "
                f"four 26 %, a fifth of one nothing to speak of (measured, balls); {returned_share(candidate, name)}",
            }
        else:
            yield {
                "what": f"the gas of {name!r} carries {listed} and does not feel them",
                "effect": f"omitted reaction: it is not slowed, parted or shaded by them; {_share(candidate, name)}",
            }


def _share(candidate: Candidate, name: str) -> str:
    """Sentence about the momentum given, against the gas's own."""
    if name not in candidate.caches:
        return "how much that is, is known after a probe"
    try:
        box = box_of(candidate, name)
        given = given_by(box)
        if not given:
            return "it carries nothing that moves"
        each = np.linalg.norm(sum((g.worked_out for g in given), np.zeros_like(given[0].worked_out)), axis=1)
        k = int(each.argmax())
        now = box.read(k + 1)
        own = box.volume * float((box.density(now) * now.room * np.linalg.norm(now.velocity, axis=3)).sum())
    except EvidenceError as error:
        return f"how much that is, is not known: {error}"
    total = float(each.sum())
    if total <= 0.0:
        return "it gave them nothing"
    return (
        f"{total:.2g} N s in all, in frame {k + 1} {each[k] / max(own, TINY):.2g} of the momentum that it has itself (the most)"
    )
