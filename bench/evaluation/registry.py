"""All that Inspect finds under `worldagent/`: the entry point `inspect_ai` of this package names this module."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from inspect_ai import Task
from inspect_ai.scorer import Scorer
from inspect_ai.solver import Solver

from .agents.clis import claude_code, codex_cli
from .agents.external import external
from .agents.random_calls import random_calls
from .agents.react import react_agent
from .agents.replay import replay
from .agents.scripted import scripted
from .metrics.scorers import alignment, caus, comp, imag, pen, prod, qual
from .models import ScriptedModel
from .scorers import verified
from .scoring import METRICS
from .tasks import agenticsimbench, small, smoke

__all__ = [
    "AGENTS",
    "METRICS",
    "MODELS",
    "SCORERS",
    "TASKS",
    "ScriptedModel",
    "agenticsimbench",
    "alignment",
    "caus",
    "claude_code",
    "codex_cli",
    "comp",
    "external",
    "imag",
    "pen",
    "prod",
    "qual",
    "random_calls",
    "react_agent",
    "replay",
    "scripted",
    "small",
    "smoke",
    "verified",
]

TASKS: Mapping[str, Callable[..., Task]] = {"agenticsimbench": agenticsimbench, "small": small, "smoke": smoke}
AGENTS: Mapping[str, Callable[..., Solver]] = {
    "react": react_agent,
    "claude_code": claude_code,
    "codex_cli": codex_cli,
    "scripted": scripted,
    "replay": replay,
    "random": random_calls,
    "external": external,
}
"""Solvers by the name that `worldagent eval run --agent` takes."""
MODELS = ("react", "claude_code", "codex_cli")
"""Agents that need a model."""
SCORERS: Mapping[str, Callable[..., Scorer]] = {"verified": verified, **METRICS}
"""Scorers by the name that `inspect score --scorer worldagent/NAME` takes."""
