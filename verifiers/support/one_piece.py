"""Rows about moving bodies of several parts: the parts touch each other, for plates with nothing between are no table (R92, R154).

Of static things this is asked part by part (`support/held.py`): each needs something that holds it. Parts of one moving body keep their
places whatever is between them, so that the same is asked of their surfaces here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ...geometry import apart
from ..rows.answers import row_of
from ..rows.corrections import correction, pointer
from ..rows.findings import Finding
from .questions import PIECE

if TYPE_CHECKING:
    from ...worlds.requirements import Row
    from ..scene.surfaces import Surfaces

__all__ = ["one_piece_rows", "own_touches"]


def own_touches(
    surfaces: Surfaces, parts: Sequence[int], *, gap: float | None = None, joined: Callable[[int, int], bool] | None = None
) -> Iterator[tuple[int, int]]:
    """Pairs of an entity's parts that touch each other at frame 0, within `gap` [m]; default the contact tolerance (S3).

    Pairs that are `joined` when their turn comes are left out: those that cost a search come last.
    """
    if len(parts) < 2:
        return
    low, high = (box[:, 0] for box in surfaces.boxes(np.zeros(1, dtype=np.intp)))
    own = np.array(parts)
    name = surfaces.parts[parts[0]].entity
    gap = surfaces.contact_gap(name, name) if gap is None else gap
    boxes = np.maximum(low[own][:, None] - high[own], low[own] - high[own][:, None]).max(axis=2)
    # Entities of one recipe share their surfaces: what touches in one touches in the other.
    alike = not surfaces.shapes.soft & set(parts) and len({surfaces.parts[i].body for i in parts}) == 1
    known: dict[tuple[int, int, float], bool] = surfaces.candidate.memo("own touches", dict) if alike else {}
    near = [(int(own[a]), int(own[b])) for a, b in np.argwhere(boxes <= gap).tolist() if a < b]
    keys = [(id(surfaces.parts[i].solid), id(surfaces.parts[j].solid), gap) for i, j in near]
    order: Sequence[int] = range(len(near))
    if joined is not None:
        order = sorted(order, key=lambda k: keys[k] not in known and not _told(surfaces, *near[k], gap))
    for k in order:
        if joined is not None and joined(*near[k]):
            continue
        if keys[k] not in known:
            known[keys[k]] = _apart(surfaces, *near[k], gap)
        if not known[keys[k]]:
            yield near[k]


def _told(surfaces: Surfaces, i: int, j: int, gap: float) -> bool:
    """True if the clearance of two parts of one entity is known as far as `gap` asks."""
    return gap <= surfaces.reach and (i, j) in surfaces.own


def _apart(surfaces: Surfaces, i: int, j: int, gap: float) -> bool:
    if _told(surfaces, i, j, gap):
        return surfaces.own[i, j] >= gap
    poses = [surfaces.track(surfaces.parts[k].entity, surfaces.parts[k].body).at(0) for k in (i, j)]
    return apart(surfaces.shapes.solid(i, 0), poses[0], surfaces.shapes.solid(j, 0), poses[1], gap=gap)


def one_piece_rows(surfaces: Surfaces, still: frozenset[str]) -> list[Row]:
    """Rows `support:piece:<entity>` of what moves and has several parts in one body.

    Args:
        surfaces: of the candidate.
        still: what never moves, which is judged part by part.
    """
    found: list[Row] = []
    for name in surfaces.entities:
        if name in still or name in surfaces.broken or name in surfaces.candidate.deforming:
            continue
        bodies: dict[str, list[int]] = {}
        for i in surfaces.parts_of[name]:
            bodies.setdefault(surfaces.parts[i].body, []).append(i)
        if max((len(own) for own in bodies.values()), default=0) > 1:
            judge = partial(_piece, surfaces, name, bodies)
            found.append(row_of(surfaces.candidate, PIECE, (name,), judge, entities=(name,)))
    return found


def _pieces(surfaces: Surfaces, parts: Sequence[int]) -> list[list[int]]:
    """Parts that hang together, the piece with most of them first."""
    label = {i: i for i in parts}
    for a, b in own_touches(surfaces, parts, joined=lambda i, j: label[i] == label[j]):
        old, new = label[b], label[a]
        label.update({i: new for i, at in label.items() if at == old})
    groups: dict[int, list[int]] = {}
    for i, at in label.items():
        groups.setdefault(at, []).append(i)
    return sorted(groups.values(), key=len, reverse=True)


def _piece(surfaces: Surfaces, name: str, bodies: dict[str, list[int]]) -> Finding:
    reason = surfaces.candidate.spec.entities[name].afloat
    found = {body: _pieces(surfaces, own) for body, own in bodies.items()}
    off = [piece for groups in found.values() for piece in groups[1:]]
    if not off or reason is not None:
        text = f"{name!r} hangs together" if not off else f"parts of {name!r} float beside it: {reason}"
        return Finding("pass", text, frames=(0, 0), extra=[reason])
    parts = [surfaces.parts[i].part for i in off[0]]
    return Finding(
        "fail",
        f"{', '.join(map(repr, parts))} of {name!r} touches none of its other parts: nothing is between them",
        float(1 + len(off)),
        1.0,
        hints=(
            correction(
                f"{parts[0]!r} of {name!r} is placed away from the others, or what joins them is missing",
                "shape",
                "Move it until it touches them, or add the part that is between them.",
                pointers=(pointer("entities", name, "parts", parts[0], "pose"), pointer("entities", name, "parts")),
            ),
            correction(
                "it is an entity of its own",
                "shape",
                "Make it an entity of its own, with what holds it.",
                pointers=("/entities",),
            ),
        ),
        evidence={"parts": parts},
        frames=(0, 0),
        extra=[reason],
    )
