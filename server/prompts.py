"""Prompts that a user picks in a client: make, repair and review a world."""

from __future__ import annotations

from typing import Annotated, Any

from mcp.server import MCPServer
from pydantic import Field

__all__ = ["add_prompts"]

World = Annotated[str, Field(description="Id of the world, e.g. domino_run")]


def make_world(prompt: Annotated[str, Field(description="What the world should be, in plain words")]) -> str:
    """Turn a prompt into a world that is specified, simulated, accepted and rendered."""
    return f"""\
Make a physical world from the prompt between the lines and bring it to acceptance with the worldagent tools.

---
{prompt}
---

1. inspect_world(part='guide', prompt=...) with the text between the lines: what the skills say of it, with an example. Then
   skill://world-building/SKILL.md, or for land outdoors skill://outdoor-terrain/SKILL.md and its example.json
   (inspect_world(part='guide') has both), and inspect_world(part='schema') part by part as you need it.
2. edit_spec: create the world with this very prompt; give every entity real
   dimensions, a material and a solver; write beats with measurable predicates; plan shots; mark the prompt in `claims`, so that
   every word that says something names what it is judged by.
3. build_terrain where there is ground, place_object; then run_checks(scope='static') until nothing fails.
4. probe_sim, read the rows, repair; then bake_sim (long work answers with a job_id: use job).
5. run_checks(scope='acceptance'). After acceptance: render_shot(kind='final').

Look at previews with render_shot, but decide by the numbers in rows and inspect_world. Finish by telling which rows passed,
which approximations are registered, and where the delivery is. If acceptance is out of reach, say what fails and why."""


def repair_world(world: World) -> str:
    """Find out why a world is not accepted and repair it, one parameter group at a time."""
    return f"""\
Repair the world {world!r} until run_checks(scope='acceptance') passes.

1. Read worldagent://worlds/{world}/report and skill://world-building/SKILL.md, and the skills that its failing rows name.
2. Take the first failing row in causal order (audit, static, probe, bake, shots). inspect_world for its measurements.
3. State one hypothesis and change one parameter group with edit_spec: a scene failure needs a scene edit, a solver failure
   a solver edit. Never widen a bound or drop a row to make it pass.
4. Redo what became stale, from its first step, and compare the row's new measurement with the old one. Keep what helped,
   revert what did not.

Report for each iteration: hypothesis, edit, measurement before and after."""


def review_world(world: World) -> str:
    """Judge a world critically without changing it."""
    return f"""\
Review the world {world!r} without changing anything: use inspect_world, run_checks and render_shot previews only.

1. Compare the prompt with its claims, word by word: inspect_world(part='claims') and worldagent://worlds/{world}/spec. What is missing, what is
   interpreted too kindly?
2. Read worldagent://worlds/{world}/matrix: which rows fail or are unverified, which bounds are so wide that they prove
   nothing, which beats do not test what the prompt says?
3. Read worldagent://worlds/{world}/revisions for weakened bounds and their reasons.
4. Look at a contact sheet of each shot. Does the picture show what the rows claim?

Give findings ordered by weight, each with its evidence (row, measurement, frame, picture) and the edit that would mend it."""


def add_prompts(server: MCPServer[Any]) -> None:
    """Register all prompts on a server."""
    for function, title in ((make_world, "Make a world"), (repair_world, "Repair a world"), (review_world, "Review a world")):
        server.prompt(title=title, description=function.__doc__)(function)
