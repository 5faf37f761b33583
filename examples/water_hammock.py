"""Water drops on a cloth that catches it, from its prompt to acceptance through a real client: `python -m worldagent.examples.water_hammock`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from typing import Any

from ..testing.worlds.small_soft import caught_spec
from ..worlds.claim_marks import with_claims
from .client_run import main_of, play_spec

__all__ = ["FRAMES", "PROMPT", "held_spec", "main", "run"]

PROMPT = "Water drops on a cloth hung between four posts, which sags and holds it."
CLAIMS = (
    "[Water](thing water) [drops](event drops) on a [cloth](thing cloth) hung [between four](place /graph/regions/among) [posts](thing posts), "
    "[which](thing same_as=cloth) [sags](property sags) and [holds](property holds) [it](thing same_as=water)."
)
FRAMES = 13


def held_spec(frames: int = FRAMES) -> dict[str, Any]:
    """The world without its prompt, `frames` at 24 per second."""
    spec = caught_spec(frames=frames)
    last = frames - 1

    def beat(text: str, owner: str, subject: str, when: list[int], predicate: dict[str, Any], *causes: str) -> dict[str, Any]:
        return {"text": text, "owner": owner, "subject": subject, "frames": when, "predicate": predicate, "causes": list(causes)}

    water = spec["entities"]["water"]
    lowest = water["pose"]["position"][2] - water["dimensions"]["size"][2] / 2
    down = {"kind": "liquid_flux_through", "entity": "water", "point": [0, 0, round(lowest, 6)], "normal": [0, 0, -1], "size": [0.4, 0.4],
            "measure": "total", "min": 2e-4}  # fmt: skip
    spec["graph"] = {"regions": {
        "under": {"kind": "box", "min": [-0.2, -0.2, 0.0], "max": [0.2, 0.2, 0.15]},
        "among": {"kind": "box", "role": "between the posts", "min": [-0.232, -0.232, 0.0], "max": [0.232, 0.232, 0.33]},
    }}  # fmt: skip
    spec["story"] = {
        "semantics": "a sheet that is hung up gives way under water until its tension carries it",
        "beats": {
            "drops": beat("the water drops", "water", "water", [0, 6], {"kind": "and", "of": [down, {"kind": "liquid_speed", "entity": "water", "min": 0.3}]}),
            "sags": beat("the cloth sags under it", "cloth", "cloth", [1, last],
                         {"kind": "displacement", "entity": "cloth", "axis": [0, 0, -1], "min": 0.015}, "drops"),
        },
        "requirements": {
            "holds": {"text": "no water goes through",
                      "predicate": {"kind": "liquid_volume_in", "entity": "water", "region": "under", "max": 0.0, "when": "always"}},
        },
    }  # fmt: skip
    spec["shots"] = {"main": {
        "frames": [0, last], "covers": ["drops", "sags"], "subjects": ["water", "cloth"],
        "keys": {"k0": {"frame": 0, "position": [0.62, -0.8, 0.72], "target": [0, 0, 0.28], "fov_deg": 42}},
    }}  # fmt: skip
    spec["title"] = "Water in a cloth"
    return with_claims(spec, PROMPT, CLAIMS)


def run(options: argparse.Namespace) -> dict[str, Any]:
    """One run in a fresh world folder; returns what happened."""
    return play_spec("water_hammock", PROMPT, held_spec(options.frames), options)


def main(argv: Sequence[str] | None = None) -> int:
    """Exit code 0 when the world was accepted; the last line is one JSON object."""
    return main_of("water_hammock", PROMPT, FRAMES, run, argv)


if __name__ == "__main__":
    sys.exit(main())
