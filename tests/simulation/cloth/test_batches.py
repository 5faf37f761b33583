"""Steps in batches, as GPUs take them: the motion and the sums of a CPU's steps, and the same bytes whatever the lists.

Batches run on a CPU too, where all but atomics, graphs and rounding is as on a GPU; on a machine with one they run there as well.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from copy import deepcopy
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worldagent.bench.cloth_scene import thrown
from worldagent.construction.build import build_entity
from worldagent.geometry.launch import warp
from worldagent.simulation.boundaries import BodyState, Boundary
from worldagent.simulation.cloth.batches import Batches
from worldagent.simulation.cloth.engine import Cloth
from worldagent.simulation.cloth.solver import SolverCloth
from worldagent.testing.worlds.small_cloth import PULLED_PROMPT, pulled_spec
from worldagent.tests.physics.cloth_sheets import box, cloth, fabric, hold, sheet, standing
from worldagent.worlds.arrays import F64
from worldagent.worlds.patch import parse_spec

DEVICES = ["cpu", pytest.param("cuda:0", marks=pytest.mark.skipif(not warp().is_cuda_available(), reason="there is no GPU here"))]
SUMS = ("impulse", "contact", "air", "held", "load", "cut", "work")


def in_batches(running: Cloth) -> Cloth:
    """The same in explicit steps alone; on a CPU too in batches."""
    running._strides = running.grips = None
    if running.device == "cpu":
        running.folds, running.batches = None, Batches(running, running.contacts)
    return running


@dataclass
class Course:
    """A run and the bodies that it meets: those of its boundaries go on as they move, vertices that deform fly on by themselves."""

    running: Cloth
    bodies: BodyState
    time: float = 0.0
    given: dict[str, Any] = field(default_factory=lambda: dict.fromkeys(SUMS, 0.0))
    felt: dict[int, Any] = field(default_factory=dict)
    steps: int = 0
    looked: list[int] = field(default_factory=list)

    def go(self, seconds: float) -> Course:
        """Go on for a time; sums of what was given go on too."""
        end = self.time + seconds
        while self.time < end - 1e-9:
            report = self.running.step(end - self.time, self.bodies, self.time)
            for name in SUMS:
                self.given[name] = self.given[name] + getattr(report, name)
            self._move(report)
            self.looked.append(report.contacts)
            self.steps += report.steps
            self.time += report.dt
        return self

    def _move(self, report: Any) -> None:
        b, dt = self.bodies, report.dt
        b.position += dt * b.velocity
        b.center += dt * b.velocity
        for k, spin in enumerate(b.angular_velocity):
            rate = float(np.linalg.norm(spin))
            if rate > 0.0:
                x, y, z = spin / rate
                cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
                turn = np.eye(3) + math.sin(rate * dt) * cross + (1 - math.cos(rate * dt)) * cross @ cross
                b.rotation[k] = turn @ b.rotation[k]
                b.position[k] = b.center[k] + turn @ (b.position[k] - b.center[k])
        for row, (places, speeds) in b.vertices.items():
            impulse = report.vertex_impulse[row]
            self.felt[row] = self.felt.get(row, 0.0) + impulse
            faster = speeds + impulse * b.vertex_lightness[row][:, None]
            b.vertices[row] = (places + dt * faster, faster)


def _led(device: str) -> Course:
    """A sheet on a rod that goes on and turns about it, over a floor, pushed from the side by a block that moves."""
    flat = sheet((0.3, 0.3), 0.02, fabric())
    edge = np.flatnonzero(flat.position[:, 1] > 0.15 - 1e-9)
    rod = replace(box((0.32, 0.02, 0.02), (0, 0.162, 0)), name="rod/body", motion="kinematic")
    block = replace(box((0.1, 0.1, 0.1), (0.0, -0.05, -0.06)), name="block/body", motion="kinematic")
    floor = box((2, 2, 0.2), (0, 0, -0.2))
    solids = (rod, block, floor)
    bodies = standing(solids)
    bodies.center[0] = [0, 0.162, 0]
    bodies.velocity[0], bodies.angular_velocity[0] = [0.1, -0.3, 0.0], [2.0, 0.0, 0.0]
    bodies.velocity[1] = [0.0, 0.1, 0.5]
    return Course(cloth(flat, boundaries=solids, holds=(hold(edge, flat.position, 0),), device=device), bodies)


def _blown(device: str) -> Course:
    """A sheet held by an edge in air that moves from place to place and in time, in a field, and under loads."""
    flat = sheet((0.3, 0.3), 0.02, fabric())
    edge = np.flatnonzero(flat.position[:, 0] < -0.15 + 1e-9)

    def air(points: F64, time: float) -> F64:
        found = np.tile([6.0, 0.0, 0.0, 1.2], (len(points), 1))
        found[:, 2] = 4.0 * np.sin(20 * points[:, 0] + 30 * time)
        return found

    def drawn(points: F64, time: float) -> F64:
        return np.asarray(-3.0 * (1.0 + time) * points)

    running = cloth(
        flat, drag=((1.2, 0.05),), air=air, acceleration=drawn, holds=(hold(edge, flat.position),), integrator="explicit", device=device
    )  # fmt: skip
    running.loads = np.zeros((running.n, 3))
    running.loads[::7] = [0.0, 0.01, -0.005]
    return Course(running, standing())


def _soft(device: str) -> Course:
    """A block whose vertices give way drops on a sheet that is held at two edges; aside of its lines, where rounding would choose pairs."""
    flat = sheet((0.3, 0.3), 0.02, fabric())
    edges = np.flatnonzero(np.abs(flat.position[:, 0]) > 0.15 - 1e-9)
    block = replace(box((0.1, 0.1, 0.04), (0.0037, 0.0071, 0.023)), name="jelly/body", motion="dynamic", deforming=True)
    solids: tuple[Boundary, ...] = (block,)
    bodies = standing(solids)
    places = np.asarray(block.mesh.vertices, dtype=np.float64)
    bodies.vertices[0] = (places.copy(), np.tile([0.2, 0.0, -1.0], (len(places), 1)))
    bodies.vertex_lightness[0] = np.full(len(places), 1 / 0.02)
    return Course(cloth(flat, boundaries=solids, holds=(hold(edges, flat.position),), device=device), bodies)


def _laid(device: str) -> Course:
    """Two sheets on each other that slide down a slope of 20 degrees: where a CPU would take steps with contacts."""
    angle = math.radians(20)
    flat, small = sheet((0.2, 0.2), 0.02, fabric()), sheet((0.12, 0.12), 0.015, fabric())
    below = replace(flat, position=flat.position + np.array([0.0, 0.0, 0.0016]))
    above = replace(small, position=small.position + np.array([-0.02, 0.013, 0.0047]))
    pull = 9.81 * np.array([math.sin(angle), 0.0, -math.cos(angle)])
    solids = (box((4, 4, 0.2), (0, 0, -0.1)),)
    running = cloth(below, above, boundaries=solids, gravity=pull, friction=(0.1, 0.2), device=device)
    return Course(running, standing(solids))


def _thrown(device: str) -> Course:
    """A sheet that falls on its edge and crumples until ways are cut."""
    running = thrown(12, device=device)
    return Course(running, standing(running.setup.boundaries))


def _struck(device: str) -> Course:
    """A free sheet that a block strikes at 6 m/s: vertices stray too far, and batches are taken again."""
    block = replace(box((0.1, 0.1, 0.1), (0.02, -0.01, -0.07)), name="block/body", motion="kinematic")
    bodies = standing((block,))
    bodies.velocity[0] = [0.5, 0.0, 6.0]
    return Course(cloth(sheet((0.3, 0.3), 0.02, fabric()), boundaries=(block,), device=device), bodies)


SCENES: dict[str, tuple[Callable[[str], Course], float]] = {
    "led by bodies": (_led, 0.1), "in moving air": (_blown, 0.1), "under a body that gives way": (_soft, 0.06),
    "sliding": (_laid, 0.1), "crumpling": (_thrown, 0.25), "struck": (_struck, 0.02),
}  # fmt: skip
"""Runs by what is special about them, each with its length [s]."""


def _batched(name: str, device: str) -> Course:
    course = SCENES[name][0](device)
    in_batches(course.running)
    return course


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("name", SCENES)
def test_batches_give_the_motion_and_the_sums_of_single_steps(name: str, device: str) -> None:
    """Choice: within 1e-9 m and 1e-8 of each sum's size: rounding, which contacts multiply (measured on a CPU: 9e-12 m, 1e-12)."""
    make, seconds = SCENES[name]
    usual = make("cpu")
    usual.running._strides = usual.running.grips = None
    start = usual.running.vertices()[0]
    usual.go(seconds)
    other = _batched(name, device).go(seconds)
    places = usual.running.vertices()[0]
    assert np.abs(places - start).max() > 0.01
    assert np.abs(other.running.vertices()[0] - places).max() < 1e-9
    assert other.steps == usual.steps
    for told in SUMS:
        one, two = np.asarray(usual.given[told]), np.asarray(other.given[told])
        assert np.abs(two - one).max(initial=0.0) <= 1e-8 * np.abs(one).max(initial=0.0), told
    for row, felt in usual.felt.items():
        assert np.abs(other.felt[row] - felt).max() <= 1e-8 * np.abs(felt).max()
        assert np.abs(other.bodies.vertices[row][0] - usual.bodies.vertices[row][0]).max() < 1e-9
    if name == "crumpling":
        assert usual.given["cut"][3] > 0
    assert any(np.abs(usual.given[told]).max(initial=0.0) > 1e-3 for told in ("contact", "air"))


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("name", SCENES)
def test_what_is_listed_in_a_batch_decides_nothing(name: str, device: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Choice: the same bytes with other margins, and where nothing had room at first."""
    usual = _batched(name, device).go(SCENES[name][1])
    monkeypatch.setattr("worldagent.simulation.cloth.batches.LEAST", 1)
    monkeypatch.setattr("worldagent.simulation.cloth.batches.NEAR", 1)
    monkeypatch.setattr("worldagent.simulation.cloth.batches.FAR", (0.7, 0.8, 1.0))
    other = _batched(name, device).go(SCENES[name][1])
    assert other.running.checkpoint() == usual.running.checkpoint()


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("name", SCENES)
def test_batches_go_on_from_a_checkpoint(name: str, device: str) -> None:
    """Choice: the same bytes of state and reports as the run that took it and went on from it as well."""
    part = SCENES[name][1] / 5
    one = _batched(name, device).go(part)
    state, there = one.running.checkpoint(), deepcopy(one.bodies)
    one.running.restore(state)
    other = _batched(name, device)
    other.running.restore(state)
    other.bodies, other.time = there, one.time
    one.given, other.given, told = dict.fromkeys(SUMS, 0.0), dict.fromkeys(SUMS, 0.0), []
    for course in (one, other):
        course.looked = []
        course.go(4 * part)
        told.append([course.running.checkpoint(), *(np.asarray(course.given[n]).tobytes() for n in SUMS)])
    assert told[0] == told[1]
    assert one.looked == other.looked


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("name", ["struck", "under a body that gives way"])
def test_steps_that_are_taken_again_half_as_long_count_once(name: str, device: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Law, with lists so short that single steps outrun them: momentum is what was given, and what a body's vertices got is what it got."""
    monkeypatch.setattr("worldagent.simulation.cloth.batches.FAR", (0.151, 0.152, 0.153))
    course = _batched(name, device)
    assert course.running.batches is not None
    back, taken = course.running.batches._back, []

    def counted(level: int) -> None:
        taken.append(level)
        back(level)

    monkeypatch.setattr(course.running.batches, "_back", counted)
    course.go(SCENES[name][1])
    assert 0 in taken
    mass = course.running.mass
    pull = mass.sum() * course.time * course.running.setup.gravity
    given = pull - course.given["contact"][:, :3].sum(axis=0) + course.given["held"][:3] + course.given["cut"][:3]
    assert np.abs(mass @ course.running.vertices()[1] - given).max() < 1e-12
    for row, felt in course.felt.items():
        assert np.abs(felt.sum(axis=0) - course.given["contact"][row, :3]).max() < 1e-12
        assert np.abs(felt).max() > 1e-3


@pytest.mark.parametrize("device", DEVICES)
def test_a_strip_tears_in_batches_as_in_single_steps(device: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Choice: the same tears at the same times, and all within 1e-9 m, of a strip that hangs aslant in a pull of 26 g."""

    def torn(device: str, *, batches: bool) -> list[Mapping[str, Any]]:
        spec = pulled_spec(strength=20.0, frames=3, resolution=0.05)
        plan, strip = spec["simulation"], spec["entities"]["strip"]
        del spec["entities"]["post"], spec["entities"]["rod"], plan["solvers"]["rigid"]
        plan |= {"drivers": {}, "gravity": [250.0, 40.0, 0.0]}
        plan["solvers"]["cloth"]["settings"] = {"device": device.partition(":")[0], "integrator": "explicit"}
        strip["physics"]["pins"] = {"still": {"edge": "-x"}}
        parsed = parse_spec({**spec, "claims": {}, "story": {"beats": {}}, "prompt": PULLED_PROMPT})
        with monkeypatch.context() as patched:
            if batches:
                patched.setattr("worldagent.simulation.cloth.solver.Cloth", lambda setup: in_batches(Cloth(setup)))
            running = SolverCloth(parsed, {"strip": build_entity(parsed, "strip", Path())}, "cloth")
            running.prepare()
            frames = []
            for k in (1, 2):
                running.advance(k)
                frames.append(running.frame_data())
        return frames

    usual, other = torn("cpu", batches=False), torn(device, batches=True)
    assert sum(len(f["tear/time"]) for f in usual) > 5
    for one, two in zip(usual, other, strict=True):
        for name in ("tear/time", "tear/corner", "tear/side"):
            assert np.array_equal(one[name], two[name]), name
        assert np.abs(one["vertex/position"] - two["vertex/position"]).max() < 1e-9
