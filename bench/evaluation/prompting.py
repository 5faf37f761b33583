"""The prompt of a sample: that of the paper's Appendix B, with our server in the place of Blender.

Its text is data (`appendix_b.txt`) with a version and a hash, and both stand in the log. What the paper says of Blender's systems is
said of the server's engines; of its list, Dynamic Paint and Geometry Nodes have no equivalent here, and Ocean is a liquid with
waves (R132). Scenes come one at a time, each with a server of its own, where the paper gives all at once to one agent.
"""

from __future__ import annotations

import hashlib
from importlib.resources import files
from string import Template

__all__ = ["TEMPLATE_VERSION", "ending_words", "prompt_digest", "task_prompt"]

TEMPLATE_VERSION = 1
"""Goes up with every change of the text: figures of two versions are not compared."""
FILM = "Render a complete 1920x1080 final sequence with render_shot(kind='final', width=1920, height=1080) once the world is accepted."
NO_FILM = "The scene is complete when run_checks(scope='acceptance') says that it is accepted; no film is asked for."


def _text() -> str:
    return (files(__package__) / "appendix_b.txt").read_text(encoding="utf-8")


def prompt_digest() -> str:
    """SHA-256 of the template, hex."""
    return hashlib.sha256(_text().encode()).hexdigest()


def ending_words(*, film: bool) -> str:
    """Words that say what completes a scene: its film, or its acceptance."""
    return FILM if film else NO_FILM


def task_prompt(prompt: str, *, example: str, setting: str, instructions: str, film: bool) -> str:
    """The whole prompt of one sample.

    Args:
        prompt: of the scene.
        example: `example_3`: its folder, and the name of its world.
        setting: `outdoor` or `interior`.
        instructions: that the server gives.
        film: whether the final sequence is asked for.
    """
    told = {"prompt": prompt, "example": example, "setting": setting, "instructions": instructions}
    return Template(_text()).substitute(told, ending=ending_words(film=film))
