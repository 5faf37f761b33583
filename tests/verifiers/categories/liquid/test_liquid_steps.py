"""Corrections of a particle that jumped: they shorten the step that ran, and name the bodies that squeezed it."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.testing.defects import _liquid_scenes as scenes
from worldagent.testing.worlds.liquid_worlds import Flow, pool_in_tank
from worldagent.testing.worlds.small_worlds import IDENTITY, box
from worldagent.verifiers.categories.liquid.frames import liquid_of
from worldagent.verifiers.categories.liquid.motion import Motion
from worldagent.verifiers.rows.findings import Finding

S, FRAMES, LEAPS = scenes.SPACING, 8, 4


def jumped(flow: Flow, folder: Path) -> Finding:
    """Finding on a pool of which the particle nearest to the right wall, at the top, is three spacings higher from a frame on."""
    made = flow.edited()
    points = made.position[0]
    row = int(np.argmax(points[:, 0] + 2.0 * points[:, 2] - 0.5 * np.abs(points[:, 1])))
    for k in range(LEAPS, FRAMES):
        made.position[k][row, 2] += 3.0 * S
    liquid = liquid_of(made.candidate(folder), "water")
    watch = Motion(liquid)
    for step in liquid.steps():
        watch.see(step)
    return watch.findings()["jumps"]


def pool(**more: Any) -> Flow:
    return pool_in_tank(size=(12 * S, 8 * S, 6 * S), spacing=S, frames=FRAMES, **more)


@pytest.mark.parametrize(("ran", "field", "value"), [(2.5e-4, "cfl", 0.2), (4.9e-3, "max_step", 2.5e-3)])
def test_the_step_that_ran_is_shortened_by_what_held_it(tmp_path: Path, ran: float, field: str, value: float) -> None:
    """Steps of 0.25 ms are not shortened by a `max_step` of 2.5 ms."""
    flow = pool()
    flow = dataclasses.replace(flow, change={(k, "record/step"): np.array(ran) for k in range(1, FRAMES)})
    found = jumped(flow, tmp_path)
    assert (found.status, found.frame) == ("fail", LEAPS), found.text
    patch = found.hints[0].patch[0]
    assert (str(patch["path"]).rpartition("/")[2], patch["value"]) == (field, value)
    assert not any("squeeze" in h.cause for h in found.hints)


def test_two_bodies_that_close_upon_a_particle_are_named(tmp_path: Path) -> None:
    top = 6 * S
    others = {"slab": box(0.08, 0.08, 0.02, at=(6 * S - 0.05, 0, top + 0.012), motion="dynamic")}
    flow = pool(others=others, two_way=True)
    sinks = np.outer(np.arange(FRAMES) * 1e-4, [0.0, 0.0, -1.0])
    flow = dataclasses.replace(flow, tracks={"slab": (np.array(others["slab"].pose.position) + sinks, IDENTITY)})
    found = jumped(flow, tmp_path)
    assert found.status == "fail", found.text
    assert found.evidence is not None
    assert {n.partition("/")[0] for n in found.evidence["between"]} == {"slab", "tank"}
    squeeze = next(h for h in found.hints if "squeeze" in h.cause)
    assert squeeze.patch[0]["value"] == pytest.approx(0.7 * S, rel=0.01)
