"""Sound worlds of liquids that meet what deforms, which their seeded defects start from: simulated once per kind, in seconds."""

from __future__ import annotations

from functools import cache as kept
from pathlib import Path
from typing import Any

from ...construction.build import build_entity
from ...simulation.schedule import run_frames
from ...worlds.candidate import Candidate, cache_digest
from ...worlds.patch import parse_spec
from ..worlds.small_liquids import PROMPT, jelly_tank_spec
from ..worlds.small_soft import HAMMOCK_PROMPT, caught_spec
from ._kept import kept_folder

__all__ = ["BATHED", "CAUGHT", "CLOTH", "FIRST", "JELLY", "LAST", "SPACING", "SPILLED", "soft_world"]

CLOTH, JELLY = "cloth", "jelly"
BATHED: tuple[dict[str, Any], ...] = (
    {"crate_at": 0.245},
    {"crate_at": 0.243, "density": 1300.0, "young": 30000.0},
    {"crate_at": 0.3, "depth": 0.16, "young": 40000.0},
    {"crate_at": 0.26, "density": 400.0, "young": 25000.0},
)
CAUGHT: tuple[dict[str, Any], ...] = (
    {},
    {"size": (0.1, 0.175, 0.05), "speed": 1.2},
    {"size": (0.1, 0.1, 0.1), "speed": 0.3},
    {"speed": 0.2, "direction": "one_way"},
)
SPILLED: tuple[dict[str, Any], ...] = ({"size": (0.5, 0.05, 0.05), "speed": 1.5}, {"size": (0.1, 0.5, 0.05), "speed": 1.0})
"""Water that reaches the rim of the cloth, and beyond it."""
SPACING = {JELLY: 0.04, CLOTH: 0.025}
FIRST, LAST = 2, 5
"""Frames in which things go wrong."""


@kept
def soft_world(kind: str, number: int) -> Candidate:
    """One of the sound worlds, simulated once."""
    frames = LAST + 1
    if kind == JELLY:
        jelly: dict[str, Any] = {"frames": frames, "spacing": SPACING[JELLY], **BATHED[number]}
        given = {"prompt": PROMPT, **jelly_tank_spec(**jelly)}
    else:
        own = (CAUGHT if kind == CLOTH else SPILLED)[number]
        sheet: dict[str, Any] = {"size": (0.15, 0.15, 0.05), "above": 0.0125, "speed": 0.8, "stiffness": 1000.0, **own}
        given = {"prompt": HAMMOCK_PROMPT, **caught_spec(frames=frames, spacing=SPACING[CLOTH], **sheet)}
        given["entities"][CLOTH]["physics"]["max_stretch"] = 0.8
    spec, folder = parse_spec(given), kept_folder(kind)
    built = {n: build_entity(spec, n, Path()) for n in spec.entities}
    caches = run_frames(spec, built, folder / "run", frames=frames)
    return Candidate(folder, spec, built, "probe", caches, "run", cache_digest(caches))
