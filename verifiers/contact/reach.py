"""Parts that cannot have come together between two frames, by exact distances of their surfaces at both ends.

A point of either part goes no farther in the interval than the way that is known of it, there and back. Had two parts met at some
moment, then their distances at the two ends together would be no more than both ways together. What is farther apart than half of
both ways at *each* end has therefore not met: neither a hit between the frames nor a step that leapt over a wall hides there.

- **Surfaces** are the visible ones, less what the collision shapes stand out of them, and less the skins.
- **Nothing is concluded** of what deforms, nor of two entities that the contact log names while all of their parts seem too far apart:
  then a way is wrong, and all of their parts count as near.
- **Joined.** Parent and child of a joint that is not said to collide, and that nothing cuts, never push each other.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...geometry import apart, kept_solid
from ...worlds.spec import DetachDriver

if TYPE_CHECKING:
    from ...geometry import Solid
    from ...worlds.built import BuiltPart
    from ...worlds.candidate import Candidate
    from ...worlds.spec import WorldSpec

__all__ = ["Reach", "joined"]


def joined(spec: WorldSpec) -> set[frozenset[str]]:
    """Pairs of entities that never push each other: parent and child of joints that do not collide and that nothing cuts."""
    plan = spec.simulation
    cut = {d.joint for d in plan.drivers.values() if isinstance(d, DetachDriver)}
    return {
        frozenset((j.parent, j.child))
        for n, j in plan.joints.items()
        if j.parent is not None and not getattr(j, "collide", True) and n not in cut
    }


class Reach:
    """Proofs that parts of a candidate have not met between two frames."""

    def __init__(self, candidate: Candidate, skins: float) -> None:
        self.candidate, self.skins = candidate, skins
        self._solids: dict[int, Solid] = {}

    def _solid(self, part: BuiltPart) -> Solid:
        if id(part) not in self._solids:
            self._solids[id(part)] = kept_solid(part.render, closed=part.closed)
        return self._solids[id(part)]

    def met(self, one: tuple[str, BuiltPart], other: tuple[str, BuiltPart], frames: tuple[int, int], way: float) -> bool:
        """False where two parts are proved not to have met.

        Args:
            one: entity and part.
            other: the same of the other.
            frames: ends of the interval; the same frame twice for its state alone.
            way: what a point of the one and a point of the other go in it, together [m].
        """
        (a, part_a), (b, part_b) = one, other
        if a in self.candidate.deformables or b in self.candidate.deformables:
            return True
        gap = 0.5 * way + self.skins + part_a.deviation[0] + part_b.deviation[0]
        return not all(
            apart(
                self._solid(part_a),
                self.candidate.pose(a, k, part_a.body),
                self._solid(part_b),
                self.candidate.pose(b, k, part_b.body),
                gap=gap,
            )
            for k in sorted(set(frames))
        )
