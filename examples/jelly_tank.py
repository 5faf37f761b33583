"""A jelly drops into a tank of water and bobs, from its prompt to acceptance through a real client: `python -m worldagent.examples.jelly_tank`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from typing import Any

from ..testing.worlds.small_liquids import jelly_tank_spec
from ..worlds.claim_marks import with_claims
from .client_run import main_of, play_spec

__all__ = ["FRAMES", "PROMPT", "main", "run", "tank_of_jelly"]

PROMPT = "A jelly cube drops into a tank of water, comes up again and bobs."
CLAIMS = (
    "A [jelly](thing jelly) [cube](property jelly) [drops into](event drops dips) a [tank](thing tank) of [water](thing water), "
    "[comes up](event rises) again and [bobs](event bobs)."
)
FRAMES = 30
DROPPED_FROM = 0.32
"""Height of the middle of the jelly at frame 0 [m]: 8 cm over the water, twice what counts as a fall of a body so high."""


def tank_of_jelly(frames: int = FRAMES) -> dict[str, Any]:
    """The world without its prompt, `frames` at 24 per second."""
    spec = jelly_tank_spec(frames=frames, crate_at=DROPPED_FROM)
    last = frames - 1

    def beat(text: str, when: list[int], predicate: dict[str, Any], *causes: str) -> dict[str, Any]:
        made = {
            "text": text,
            "owner": "rigid" if causes else "let_go",
            "subject": "jelly",
            "frames": when,
            "predicate": predicate,
        }
        return made | {"causes": list(causes)}

    spec["graph"] = {
        "regions": {
            "deep": {"kind": "box", "min": [-0.2, -0.2, 0.0], "max": [0.2, 0.2, 0.18]},
            "up": {"kind": "box", "min": [-0.2, -0.2, 0.204], "max": [0.2, 0.2, 0.4]},
        }
    }
    spec["story"] = {
        "semantics": "a soft body lighter than water falls into it and is borne up",
        "beats": {
            "drops": beat("the jelly drops", [0, 6], {"kind": "falls", "entity": "jelly"}),
            "dips": beat("the water gives way to it", [2, 12], {"kind": "reaches", "entity": "jelly", "region": "deep"}, "drops"),
            "rises": beat("the water bears it up again", [8, last],
                          {"kind": "and", "of": [{"kind": "rises", "entity": "jelly", "min": 0.02}, {"kind": "reaches", "entity": "jelly", "region": "up"}]}, "dips"),
            "bobs": beat("it bobs", [8, last], {"kind": "bobs", "entity": "jelly", "other": "water"}, "dips"),
        },
    }  # fmt: skip
    spec["shots"] = {"main": {
        "frames": [0, last], "covers": ["drops", "dips", "rises", "bobs"], "subjects": ["jelly", "water"],
        "keys": {"k0": {"frame": 0, "position": [0.75, -0.95, 0.75], "target": [0, 0, 0.14], "fov_deg": 40}},
    }}  # fmt: skip
    return with_claims(spec, PROMPT, CLAIMS)


def run(options: argparse.Namespace) -> dict[str, Any]:
    """One run in a fresh world folder; returns what happened."""
    return play_spec("jelly_tank", PROMPT, tank_of_jelly(options.frames), options)


def main(argv: Sequence[str] | None = None) -> int:
    """Exit code 0 when the world was accepted; the last line is one JSON object."""
    return main_of("jelly_tank", PROMPT, FRAMES, run, argv)


if __name__ == "__main__":
    sys.exit(main())
