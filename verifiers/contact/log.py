"""The contact log against itself: impulses, forces and events of a pair are sums over the same steps, so that one edited alone shows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .bounds import CONE, LOG, PAUSE

if TYPE_CHECKING:
    from ...worlds.arrays import F64

__all__ = ["Fault", "log_fault"]


class Fault(NamedTuple):
    """Contradiction in the contact log."""

    frame: int
    pair: tuple[int, int]
    text: str
    measured: float
    bound: float


def log_fault(
    frames: Sequence[Mapping[str, Any]],
    duration: float,
    asleep: Sequence[frozenset[int]],
    step: float,
    friction: F64,
    *,
    let_go: Mapping[int, frozenset[int]] | None = None,
) -> Fault | None:
    """The first frame at which the log of contacts and events is none that any motion gives.

    Args:
        frames: channels `contact/pair`, `contact/impulse`, `contact/vector`, `contact/max_force`, `event/pair` and `event/impulse` of
            every frame.
        duration: of a frame [s].
        asleep: colliders that sleep at each frame, or have within the frame before it; their contacts are not all listed.
        step: longest step [s].
        friction: greatest coefficient between any two colliders, shape (n, n).
        let_go: by frame, colliders that a driver lets go within it: what they touch already then makes no event.
    """
    let_go = let_go or {}
    known: dict[tuple[int, int], float] | None = None
    for k, log in enumerate(frames):
        pairs = [(int(a), int(b)) for a, b in log["contact/pair"].tolist()]
        impulse = dict(zip(pairs, log["contact/impulse"].tolist(), strict=True))
        begun: dict[tuple[int, int], list[float]] = {}
        for (a, b), given in zip(log["event/pair"].tolist(), log["event/impulse"].tolist(), strict=True):
            begun.setdefault((int(a), int(b)), []).append(given)
        if k > 0:  # frame 0 is a state
            forces = dict(zip(pairs, log["contact/max_force"].tolist(), strict=True))
            found = _impossible(k, impulse, forces, begun, duration) or _outside_cone(k, log, friction)
            if found is None and known is not None and k > 1 and duration > PAUSE + 2.0 * step:
                quiet = asleep[k - 1] | asleep[k] | let_go.get(k, frozenset())
                fresh = {p for p in impulse if p not in known and not {*p} & quiet}
                found = _begins(k, impulse, begun, fresh)
            if found is not None:
                return found
        known = impulse
    return None


def _impossible(
    frame: int,
    impulse: Mapping[tuple[int, int], float],
    forces: Mapping[tuple[int, int], float],
    begun: Mapping[tuple[int, int], Sequence[float]],
    duration: float,
) -> Fault | None:
    for pair, given in impulse.items():
        most = forces[pair] * duration
        if given > most * (1.0 + LOG):
            return Fault(frame, pair, "its impulse is more than its largest force gives in a whole frame", given, most)
    for pair, parts in begun.items():
        if pair not in impulse:
            return Fault(frame, pair, "an event tells of a contact that is not in the log", max(parts), 0.0)
        if max(parts) > impulse[pair] * (1.0 + LOG):
            return Fault(
                frame, pair, "an event gives more impulse than its contact in the whole frame", max(parts), impulse[pair]
            )
    return None


def _outside_cone(frame: int, log: Mapping[str, Any], friction: F64) -> Fault | None:
    """Coulomb: what a contact gives lies within the cone of friction about its normals."""
    pairs = log["contact/pair"].astype(np.int64)
    size = np.linalg.norm(log["contact/vector"], axis=1)
    most = log["contact/impulse"] * np.sqrt(1.0 + friction[pairs[:, 0], pairs[:, 1]] ** 2)
    wrong = np.flatnonzero(size > most * (1.0 + CONE))
    if not len(wrong):
        return None
    row = int(wrong[0])
    text = "it gives more than its normal impulse and friction allow"
    return Fault(frame, (int(pairs[row, 0]), int(pairs[row, 1])), text, float(size[row]), float(most[row]))


def _begins(
    frame: int,
    impulse: Mapping[tuple[int, int], float],
    begun: Mapping[tuple[int, int], Sequence[float]],
    fresh: set[tuple[int, int]],
) -> Fault | None:
    """Pairs that did not touch in the frame before: all of their impulse comes from their first event on."""
    for pair in sorted(fresh):
        if pair not in begun and impulse[pair] > 0.0:
            return Fault(frame, pair, "a contact begins and no event tells of it", impulse[pair], 0.0)
        if pair in begun and impulse[pair] > begun[pair][0] * (1.0 + LOG):
            return Fault(frame, pair, "a contact gives more impulse than since it began", impulse[pair], begun[pair][0])
    return None
