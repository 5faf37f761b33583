"""A jelly drops on a cloth over sand, from its prompt to acceptance through a real client: `python -m worldagent.examples.jelly_hammock`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from typing import Any

from ..testing.worlds.small_soft import HAMMOCK_PROMPT, HIGH, hammock_spec
from ..worlds.claim_marks import with_claims
from .client_run import main_of, play_spec

__all__ = ["FRAMES", "PROMPT", "jelly_spec", "main", "run"]

PROMPT = HAMMOCK_PROMPT
CLAIMS = (
    "A [jelly](thing jelly) [drops on](event drops) a [cloth](thing cloth) hung [between four](place /graph/regions/among) [posts](thing posts) over a "
    "[tray](thing tray) of [sand](thing sand)."
)
FRAMES = 24


def jelly_spec(frames: int = FRAMES, edge: float = 0.025, radius: float = 0.009) -> dict[str, Any]:
    """The world without its prompt.

    Args:
        frames: at 24 per second.
        edge: of the cloth's squares [m].
        radius: of the grains [m].
    """
    spec = hammock_spec(frames=frames, edge=edge, radius=radius)
    last, below = frames - 1, {"kind": "box", "min": [-0.2, -0.2, 0.04], "max": [0.2, 0.2, HIGH - 0.02]}

    def beat(text: str, owner: str, subject: str, when: list[int], predicate: dict[str, Any], *causes: str) -> dict[str, Any]:
        return {"text": text, "owner": owner, "subject": subject, "frames": when, "predicate": predicate, "causes": list(causes)}

    spec["graph"] = {"regions": {
        "under": below,
        "among": {"kind": "box", "role": "between the posts", "min": [-0.232, -0.232, 0.0], "max": [0.232, 0.232, 0.33]},
        "tray": {"kind": "box", "min": [-0.14, -0.14, 0.0], "max": [0.14, 0.14, 0.08]},
    }}  # fmt: skip
    spec["story"] = {
        "semantics": "a soft body falls into a cloth, which gives way, catches it and throws it back",
        "beats": {
            "drops": beat("the jelly drops", "let_go", "jelly", [0, 8],
                          {"kind": "falls", "entity": "jelly", "min": 0.08}),
            "caught": beat("the cloth gives way and catches it", "bodies", "jelly", [3, 14],
                           {"kind": "reaches", "entity": "jelly", "region": "under"}, "drops"),
            "wobbles": beat("the jelly is squeezed and wobbles", "bodies", "jelly", [3, last],
                            {"kind": "deflection", "entity": "jelly", "min": 0.003}, "drops"),
        },
        "requirements": {
            "sand": {"text": "the sand stays in the tray",
                     "predicate": {"kind": "particle_count_in", "entity": "sand", "region": "tray", "min": 200, "when": "always"}},
        },
    }  # fmt: skip
    for name, entity in spec["entities"].items():
        entity["outputs"] = {"jelly": ["deformation"], "cloth": ["motion"], "sand": ["motion"]}.get(name, [])
    spec["shots"] = {"main": {
        "frames": [0, last], "covers": ["drops", "caught", "wobbles"], "subjects": ["jelly", "cloth"],
        "keys": {"k0": {"frame": 0, "position": [0.72, -0.95, 0.55], "target": [0, 0, 0.22], "fov_deg": 40}},
    }}  # fmt: skip
    return with_claims(spec, PROMPT, CLAIMS)


def run(options: argparse.Namespace) -> dict[str, Any]:
    """One run in a fresh world folder; returns what happened."""
    return play_spec("jelly_hammock", PROMPT, jelly_spec(options.frames), options)


def main(argv: Sequence[str] | None = None) -> int:
    """Exit code 0 when the world was accepted; the last line is one JSON object."""
    return main_of("jelly_hammock", PROMPT, FRAMES, run, argv)


if __name__ == "__main__":
    sys.exit(main())
