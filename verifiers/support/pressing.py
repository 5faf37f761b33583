"""Which contacts of a group can be pressed at all: drawn surfaces that touch, or bodies that something presses together.

Bodies are simulated with collision skins, so that pairs which touch may be drawn two skins apart. Between things that never move such a
pair is a spring under load that no weight, joint or driver loads: it holds bodies by friction beside drawn air. Where a weight or a
mechanism presses, the force is that of the press, whatever the skins.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from .bounds import BEND, FITTED
from .seams import facets

if TYPE_CHECKING:
    from ..scene.surfaces import Surfaces
    from .equilibrium import Group

__all__ = ["Squeeze", "pressed", "squeezes"]


class Squeeze(NamedTuple):
    """A body beside a thing that never moves: drawn apart, and within their skins."""

    body: str
    wall: str
    gap: float
    """Between what is drawn [m]."""
    skins: float
    """The two collision skins [m]."""

    def text(self) -> str:
        """Both distances in words."""
        return (
            f"{self.body!r} is drawn {self.gap * 1e3:.4g} mm from {self.wall!r}, and their collision skins of {self.skins * 1e3:.4g} mm overlap "
            f"by {max(0.0, self.skins - self.gap) * 1e3:.4g} mm: no weight, joint or driver presses them together"
        )


def squeezes(surfaces: Surfaces, group: Group, still: frozenset[str], frame: int) -> list[Squeeze]:
    """Contacts of a group with things that never move that are drawn apart, where nothing presses; none where something may.

    Args:
        surfaces: of the candidate.
        group: free bodies that touch each other, with their contacts.
        still: things that never move.
        frame: the frame.
    """
    found: list[Squeeze] = []
    for pushed, pushing, contacts in group.contacts:
        if pushed in group.members and pushing in group.members:
            continue
        body, wall, sign = (pushed, pushing, 1.0) if pushed in group.members else (pushing, pushed, -1.0)
        rises = -sign * contacts.normals @ group.down
        if wall not in still or (rises >= BEND).any():
            return []
        breakable = surfaces.candidate.spec.entities[body].breakable
        if breakable is not None and breakable.fixed:
            continue  # bonded to what its fixed faces touch
        gap = float(surfaces.series(body, wall)[frame])
        if gap > FITTED + facets(surfaces, body, wall):
            found.append(Squeeze(body, wall, gap, surfaces.skins(body, wall)))
    return found


def pressed(surfaces: Surfaces, group: Group, still: frozenset[str], frame: int) -> Group:
    """The group as if bodies did not touch the walls from which they are drawn apart and to which nothing presses them."""
    for one in squeezes(surfaces, group, still, frame):
        group = group.without(one.body, one.wall)
    return group
