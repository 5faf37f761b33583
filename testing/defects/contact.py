"""Seeded defects of the contact check: overlaps at one frame, and bodies that pass through each other between two."""

from __future__ import annotations

from collections.abc import Callable

from . import _contact_broken as broken
from . import _contact_clean as clean
from .cases import Mechanism, Suite, World

__all__ = ["SUITE"]

JUST_OVER = 1.05
"""In units of the bound."""
Build = Callable[..., World]


def _overlap(name: str, text: str, build: Build, high: float = 1e7) -> Mechanism:
    return Mechanism(name, text, True, build, JUST_OVER, high, "eps", bound=1.0)


def _sound(name: str, text: str, build: Build, low: float, high: float, unit: str) -> Mechanism:
    return Mechanism(name, text, False, build, low, high, unit)


SUITE = Suite(
    "contact",
    (
        _overlap("dip", "a box sinks into the floor at one frame", broken.dip),
        _overlap("last dip", "a box sinks into the floor at the last frame", broken.last_dip),
        _overlap("far dip", "kilometres from the origin", broken.far_dip, 1e5),
        _overlap("hidden dip", "two blocks overlap inside a closed chest", broken.hidden_dip),
        _overlap("concave", "a block pokes into the wall of a channel from within", broken.concave),
        _overlap("own pieces", "two bodies of one entity overlap", broken.own_pieces),
        _overlap("beyond fastened", "deeper than declared", broken.beyond_fastened, 1e5),
        Mechanism("nested", "a ball whole inside a block", True, broken.nested, 0.01, 0.4, "1"),
        Mechanism("tiny in huge", "a grain inside a huge ring, one frame", True, broken.tiny_in_huge, 1e-3, 1.0, "m"),
        Mechanism("inside out", "an import with normals inwards is overlapped", True, broken.inside_out, 1e-6, 0.05, "m"),
        Mechanism("rope through itself", "a segment lies in another", True, broken.rope_through_itself, 0.2, 1.5, "radius"),
        Mechanism("thin wall", "a fast ball skips a thin plate", True, broken.thin_wall, 1.05, 30.0, "thickness"),
        Mechanism("slowed through", "felt, slowed, and still through", True, broken.slowed_through, 0.05, 0.6, "1"),
        Mechanism("spinning blade", "a bar turns through a post", True, broken.spinning_blade, 0.3, 15.0, "rad"),
        Mechanism("head on", "two dynamic bodies swap places", True, broken.head_on, 1.05, 10.0, "sizes"),
        Mechanism("gate", "a ball crosses a moving gate", True, broken.gate, 1.05, 30.0, "thickness"),
        Mechanism(
            "threaded ring", "a ring is linked with a bar from one frame to the next", True, broken.threaded_ring, 0.5, 3.0, "1"
        ),
        Mechanism("filled ditch", "a ball rolls over a ditch that is drawn open", True, broken.filled_ditch, 1.0, 6.0, "radii"),
        _sound("rest", "blocks stand with no gap", clean.rest, 1e-3, 0.95, "eps"),
        _sound("far rest", "no gap, kilometres away", clean.far_rest, 10.0, 1e4, "m"),
        _sound("slide", "flush along floor and wall", clean.slide, 0.1, 30.0, "m/s"),
        _sound("tight pin", "a pin in a hole of one concave part", clean.tight_pin, 1e-8, 1e-3, "m"),
        _sound("joints of a pavement", "a ball hardly dips into a slot", clean.joints_of_a_pavement, 0.02, 0.2, "radii"),
        _sound("bounce", "off a thin plate between two frames", clean.bounce, 0.5, 50.0, "m/s"),
        _sound("corner bounce", "off two sheets within one frame", clean.corner_bounce, 0.5, 30.0, "m/s"),
        _sound("recoil", "two flying balls strike and part", clean.recoil, 0.5, 50.0, "m/s"),
        _sound("landing stick", "an end strikes, the stick turns", clean.landing_stick, 0.5, 15.0, "m/s"),
        _sound("near miss", "past the edge of a wall", clean.near_miss, 1e-5, 0.05, "m"),
        _sound("thrown over", "the chord leads through, the parabola over", clean.thrown_over, 1e-4, 0.05, "m"),
        _sound("blade beside post", "turns fast and clears it", clean.blade_beside_post, 1e-5, 0.05, "m"),
        _sound("open gate", "a ball flies under a rising gate", clean.open_gate, 1e-4, 0.1, "m"),
        _sound("linked rings", "swing through each other's holes", clean.linked_rings, 0.05, 3.0, "rad"),
        _sound("bowl and ball", "rolls inside the hull of a thin bowl", clean.bowl_and_ball, 1e-6, 1e-2, "m"),
        _sound("crate with content", "carried, with little play", clean.crate_with_content, 1e-8, 1e-2, "m"),
        _sound("turntable", "riders with no gap", clean.turntable, 0.5, 30.0, "rad/s"),
        _sound("fastened", "within the declared depth", clean.fastened, 0.5, 1.0, "1"),
        _sound("flush pieces", "bodies of one entity lie flush", clean.flush_pieces, 1e-3, 10.0, "m/s"),
        _sound("rope in a bight", "close to itself, neighbours joined", clean.rope_in_a_bight, 0.05, 1.0, "radius"),
    ),
)
