"""Breakable bodies as the other verifiers ask for them: what is special to them among rigid bodies."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar

from ....worlds.bonds import components
from ..judge import Judge, Rupture
from .check import category_rows
from .frames import Frames
from .register import fracture_lines

if TYPE_CHECKING:
    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Row

__all__ = ["FractureJudge"]


class FractureJudge(Judge):
    """Breakable rigid bodies: rows and lines beside those of `rigid`, which answers for their motion."""

    name: ClassVar[str] = "fracture"
    moved_as: ClassVar[str] = "rigid"

    def category_rows(self, candidate: Candidate, solver: str) -> list[Row]:
        """Rows of the breakable members of one instance."""
        return category_rows(candidate, solver)

    def ruptures(self, candidate: Candidate) -> Iterator[Rupture]:
        """Breakable bodies whose bonds broke, with what loaded most of those bonds."""
        for solver, cache in candidate.rigid_caches.items():
            for entity in cache.index.breakables:
                frames = Frames(candidate, solver, entity)
                broken = [b for k in range(candidate.frame_count) for b in frames.breaks(k)]
                if not broken:
                    continue
                causes = [b.cause for b in broken if b.cause >= 0 and frames.collider(b.cause) != entity]
                most = max(sorted(set(causes)), key=causes.count) if causes else None
                pieces, _ = components(len(frames.built.bodies), frames.bonds, ~frames.broken(candidate.last_frame))
                yield Rupture(
                    entity,
                    min(b.time for b in broken),
                    max(b.time for b in broken),
                    None if most is None else frames.collider(most),
                    f"breaks into {int(pieces.max()) + 1} pieces ({len(broken)} of {len(frames.bonds)} bonds)",
                )

    def lines(self, candidate: Candidate) -> list[dict[str, str]]:
        """Lines of the approximation register."""
        return fracture_lines(candidate)
