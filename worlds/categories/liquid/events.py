"""Events of liquids, each by a physical definition whose thresholds stand in `verifiers/categories/liquid/bounds.py` (R28, R131)."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ...predicate_base import PredicateInfo, Subject
from ..event import MatterEvent

__all__ = ["EVENTS", "FloatEvent", "SinkEvent", "SplashEvent"]


class FloatEvent(MatterEvent):
    """A body floats in a liquid, by what the liquid's push does to its weight: it comes to float, or floats all the while."""

    kind: Literal["floats"]
    other: Subject = Field(description="the liquid")
    when: Literal["eventually", "always"] = Field(
        default="eventually", description="always: over every half second of the interval, which is longer than that"
    )


class SinkEvent(MatterEvent):
    """A body sinks in a liquid, or bobs in it."""

    kind: Literal["sinks", "bobs"]
    other: Subject = Field(description="the liquid")


class SplashEvent(MatterEvent):
    """A body throws a liquid up, or grains."""

    kind: Literal["splashes"]
    other: Subject = Field(description="the body that strikes it")


_PUSHES = ("origin", "particle/position", "particle/fluid", "particle/volume", "exchange/impulse")
_LOOSE = ("origin", "particle/position", "particle/id")


def _vessel(kind: str, gloss: str, source: str) -> PredicateInfo:
    return PredicateInfo(
        kind, "1", _LOOSE, {"min": "up"}, "narrower", event=True, adds_up=True, directed=True, gloss=gloss, source=source
    )


EVENTS = (
    PredicateInfo(
        "floats",
        "1",
        _PUSHES,
        {"min": "up"},
        bodily=True,
        matter="other",
        event=True,
        directed=True,
        gloss="For half a second the push of `other` carries at least 0.8 of its weight, in 0.9 of the time some of it, and nothing else more than 0.2, while part of it is "
        "above the surface or it goes down by no more than 0.1 of its height; with `when` always, every half second of the interval.",
        source="Archimedes, On Floating Bodies I, 5: what floats is borne by the liquid that it displaces; shares and span are own choice",
    ),
    PredicateInfo(
        "bobs",
        "1",
        _PUSHES,
        {"min": "up"},
        frames="narrower",
        bodily=True,
        matter="other",
        event=True,
        directed=True,
        adds_up=True,
        gloss="Its height turns twice, by 0.02 of the height of its box and 1 mm at least, while `other` carries 0.5 of its weight over half a second and "
        "others no more than 0.2.",
        source="own choice; what a path or a rope moves up and down does not bob",
    ),
    PredicateInfo(
        "sinks",
        "1",
        _PUSHES,
        {"min": "up"},
        frames="narrower",
        bodily=True,
        matter="other",
        event=True,
        directed=True,
        adds_up=True,
        gloss="Denser than `other`, it goes down in it by its own height (each piece of the way by the share of it that is under the surface), by 0.5 of "
        "it where it comes to the bottom, and is wholly under, while all others together give no more than 0.2 of its weight.",
        source="Archimedes, On Floating Bodies I, 7: what is heavier than the liquid goes down to the bottom; shares and ways are own choice",
    ),
    _vessel(
        "pours",
        "It leaves `other` over its rim while that leans by more than 0.26 rad, and falls by 0.1 of its height, or gets as far from the mouth of one "
        "that lies (1.3 rad): at least 0.05 of the most that was in it.",
        "own choice: what leaves a vessel by its tilt is poured, what leaves an upright one is not",
    ),
    _vessel(
        "fills",
        "It takes up at least 0.5 of the volume that the walls of `other` enclose, and that share has risen by 0.25.",
        "own choice: content over capacity; `min` asks for more",
    ),
    _vessel(
        "overflows",
        "It leaves `other` over its rim while that stands upright (within 0.26 rad) and it stands at 0.85 of its height: at least 0.02 of its "
        "volume.",
        "own choice: a full vessel runs over; what sloshes out of a half-full one is spilled",
    ),
    _vessel(
        "leaks",
        "It leaves `other` lower than the rim and than the surface inside, on ways that meet no wall: at least 0.02 of the most that was in it.",
        "own choice: an opening below the surface; what went through a wall is a defect and not counted",
    ),
    PredicateInfo(
        "splashes",
        "1",
        (*_LOOSE, "exchange/impulse"),
        {"min": "up"},
        frames="narrower",
        event=True,
        directed=True,
        gloss="Within 0.5 s after `other` strikes it, at a speed against it of at least 0.5 of what throws so high, eight particles or grains from below "
        "its surface about there stand above that by at least the body's half-size and two spacings.",
        source="energy: v^2 = 2 g h; what a crown or jet gains over that is an own choice, as are height and time",
    ),
    PredicateInfo(
        "flows",
        "m^3/s",
        _LOOSE,
        {"min": "up"},
        frames="narrower",
        event=True,
        gloss="Over 0.5 s on end it passes the disc along its normal, eight particles at least, 0.75 of what passes in all, and no more than 0.5 of "
        "it rides along with a moving body.",
        source="flux through a section; what sloshes comes back, and what a bucket carries does not flow: the shares are own choices",
    ),
    PredicateInfo(
        "spreads",
        "1",
        _LOOSE,
        {"min": "up"},
        frames="narrower",
        event=True,
        adds_up=True,
        gloss="Seen from above it covers at least 1.5 of the area that it covered when the interval began, while at least 0.5 of its weight is borne.",
        source="own choice; what falls apart in the air is not borne",
    ),
)
