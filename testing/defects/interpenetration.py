"""Seeded defects of the interpenetration check: bodies that overlap at frame 0, seen or hidden, gross or just over eps."""

from __future__ import annotations

from collections.abc import Callable

from . import _overlap_worlds as w
from .cases import Mechanism, Suite, World

__all__ = ["SUITE"]

JUST_OVER = 1.05
"""In units of the bound."""
Build = Callable[..., World]


def _overlap(name: str, text: str, build: Build, high: float = 1e7) -> Mechanism:
    return Mechanism(name, text, True, build, JUST_OVER, high, "eps", bound=1.0)


def _broken(name: str, text: str, build: Build, low: float, high: float, unit: str) -> Mechanism:
    return Mechanism(name, text, True, build, low, high, unit)


def _sound(name: str, text: str, build: Build, low: float, high: float, unit: str) -> Mechanism:
    return Mechanism(name, text, False, build, low, high, unit)


SUITE = Suite(
    "interpenetration",
    (
        _overlap("sunk", "a block stands in the floor", w.sunk),
        _overlap("far sunk", "kilometres from the origin", w.far_sunk, 1e5),
        _overlap("any way up", "two blocks of a turned scene, hidden between walls", w.any_way_up),
        _overlap("edge down", "only an edge is inside", w.edge_down),
        _overlap("concave", "a block pokes into the wall of a channel from within", w.concave),
        _overlap("beyond fastened", "deeper than declared", w.beyond_fastened, 1e5),
        _overlap("own pieces", "two bodies of one entity overlap", w.own_pieces),
        _broken("buried", "a pipe whole inside a wall", w.buried, 0.01, 0.4, "1"),
        _broken("tiny in huge", "a grain inside a huge ring", w.tiny_in_huge, 1e-3, 1.0, "m"),
        _broken("twice", "the same body twice in almost the same place", w.twice, 1e-8, 0.3, "1"),
        _broken("inside out", "an import with normals inwards", w.inside_out, 1e-6, 0.05, "m"),
        _broken("leaky", "an import that lacks triangles holds a block", w.leaky, 0.003, 0.2, "1"),
        _broken("inverted lobe", "a mesh crosses itself, one lobe inside out", w.inverted_lobe, 0.01, 0.8, "1"),
        _broken("crossed bars", "no corner is inside", w.crossed_bars, 1e-4, 0.1, "m"),
        _sound("flush", "blocks flush in a turned scene", w.flush, 1e-3, 0.95, "eps"),
        _sound("far flush", "flush, far away", w.far_flush, 10.0, 1e4, "m"),
        _sound("tight pin", "a pin in a hole of one concave part", w.tight_pin, 1e-8, 1e-3, "m"),
        _sound("in the channel", "within the hull of a concave part", w.in_the_channel, 1e-8, 1e-2, "m"),
        _sound("linked", "linked rings", w.linked, 0.01, 0.2, "m"),
        _sound("under the table", "a stool between the legs", w.under_the_table, 1e-8, 1e-2, "m"),
        _sound("nested", "crates in crates", w.nested, 1e-8, 1e-2, "m"),
        _sound("fastened", "as deep as declared", w.fastened, 0.3, 1.0, "1"),
        _sound("union", "a mesh crosses itself, all outwards", w.union, 0.01, 0.8, "1"),
        _sound("corner to corner", "corners and crossed edges touch", w.corner_to_corner, 0.01, 10.0, "m"),
        _sound("bowl and ball", "inside the hull of a thin bowl", w.bowl_and_ball, 1e-6, 1e-2, "m"),
        _sound("flush pieces", "bodies of one entity lie flush", w.flush_pieces, 0.01, 1.0, "m"),
    ),
)
