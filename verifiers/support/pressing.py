"""Which contacts of a group can be pressed at all: drawn surfaces that touch, or bodies that something presses together.

Bodies are simulated with collision skins, so that pairs which touch may be drawn two skins apart. Between things that never move such a
pair is a spring under load that no weight, joint or driver loads: it holds bodies by friction beside drawn air. Where a weight or a
mechanism presses, the force is that of the press, whatever the skins. A body that something carries from beneath may lean, and press; if it
rests without those beside it, it does not.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from .bounds import BEND, FITTED, MISSING, OUTSIDE
from .equilibrium import solve
from .seams import facets

if TYPE_CHECKING:
    from ..scene.surfaces import Surfaces
    from .equilibrium import Group

__all__ = ["Squeeze", "pressed", "squeezes"]


class Squeeze(NamedTuple):
    """A body beside a thing that never moves, or that stands by itself: drawn apart, and within their skins."""

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
    """Contacts of a group that are drawn apart, where nothing presses; none where something may.

    Args:
        surfaces: of the candidate.
        group: free bodies that touch each other, with their contacts.
        still: things that never move.
        frame: the frame.
    """
    standing: set[str] = set()
    beside: list[tuple[str, str]] = []
    for pushed, pushing, contacts in group.contacts:
        for body, other, sign in ((pushed, pushing, 1.0), (pushing, pushed, -1.0)):
            if body not in group.members:
                continue
            if other not in still and other not in group.members:
                return []
            if (-sign * contacts.normals @ group.down >= BEND).any():
                standing.add(body)
            else:
                beside.append((body, other))
    others = [m for m in group.members if m in standing]
    # What rests by itself leans on nothing, and presses what stands beside it no more than a wall does.
    if others and not _rest_alone(group, others):
        return []
    found: list[Squeeze] = []
    for body, other in beside:
        breakable = surfaces.candidate.spec.entities[body].breakable
        if body in standing or (other not in still and other not in standing) or (breakable is not None and breakable.fixed):
            continue  # bonded to what its fixed faces touch
        gap = float(surfaces.series(body, other)[frame])
        if gap > FITTED + facets(surfaces, body, other):
            found.append(Squeeze(body, other, gap, surfaces.skins(body, other)))
    return found


def _rest_alone(group: Group, some: list[str]) -> bool:
    """True if some bodies of a group rest where they are without the others."""
    balances = solve(group.of(some), shift=OUTSIDE).values()
    return all(b.missing <= MISSING and b.shift <= OUTSIDE for b in balances)


def pressed(surfaces: Surfaces, group: Group, still: frozenset[str], frame: int) -> Group:
    """The group as if bodies did not touch that from which they are drawn apart and to which nothing presses them."""
    for one in squeezes(surfaces, group, still, frame):
        group = group.without(one.body, one.wall)
    return group
