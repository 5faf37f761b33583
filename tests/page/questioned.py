"""A world whose questions for readers are written, without a bake."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict

from worldagent.tests.page.conftest import Made
from worldagent.tests.stories.small_run import PROMPT
from worldagent.workflow.review.conduct import place_of
from worldagent.workflow.review.questions import Questions, asked_of, prompts_to_choose
from worldagent.workflow.session import Session
from worldagent.worlds.folder import write_atomically
from worldagent.worlds.provenance import recipes

__all__ = ["questioned"]

CLAIMS = {
    "c1": {"quote": "ball", "type": "thing", "by": ["/entities/ball"]},
    "c2": {"quote": "falls off", "type": "event", "by": ["/story/beats/fall"]},
}


def questioned(made: Made, picture: bytes = b"picture") -> Session:
    """A world `w` whose questions are written, as a review of a bake writes them."""
    folder = made.world("w", claims=CLAIMS)
    session = Session.at(folder)
    spans, left_out = asked_of(session.spec)
    prompts, right = prompts_to_choose(PROMPT, "d")
    digest = hashlib.sha256(picture).hexdigest()
    questions = Questions("5 things, 36 frames", (digest,), spans, left_out, prompts, right)
    root = folder.root / "reviews" / place_of(questions.digest)
    write_atomically(root / "picture_1.png", picture)
    write_atomically(root / "questions.json", json.dumps(asdict(questions)).encode())
    about = {"digest": questions.digest, "recipe": recipes(session.spec)["final"], "cache_digest": "c"}
    write_atomically(folder.root / "reviews" / "current.json", json.dumps(about).encode())
    return session
