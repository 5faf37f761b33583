"""Strength of a jar that is pushed off a shelf and breaks on the floor: loads of push and fall by the law that the skill `fracture` gives.

The stress in the bonds is that of `impulse / contact_time`, times a factor of the shape and its pieces (`simulation/fracture`): equal for
all speeds, so that one run tells the strength to choose.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
from worldagent.tests.physics import rigid_world
from worldagent.tests.physics.fracture_world import simulate
from worldagent.workflow.states import motion_over, state_at
from worldagent.worlds.candidate import Candidate
from worldagent.worlds.spec import WorldSpec

MATTER = {
    "glass": {"density": 2500.0, "friction": 0.4},
    "tin": {"density": 1150.0, "friction": 0.4},
    "stone": {"density": 2300.0, "friction": 0.5},
}
CONTACT_TIME = 1e-3
"""[s] Default of `contact_time`."""
RADIUS, TIN = 0.033, 0.055
UNBROKEN = 6e8
"""[Pa] So strong that nothing breaks, and the load is read."""
FALL, KNOCK = 1554.0, 5800.0
"""[1/m^2] Factors of this jar: flat on its foot, and struck on its wall; the figures of the skill."""
LINEAR = 0.02
"""[1] Own choice: share by which factors may differ between speeds."""


def jar(height: float, tension: float) -> dict[str, Any]:
    """A jar of 0.2 kg whose foot is at a height [m], in 14 pieces."""
    r, wall, tall, foot = RADIUS, 0.0024, 0.12, 0.008
    profile = [[0, 0], [r - 0.002, 0], [r, 0.002], [r, tall], [r - wall, tall], [r - wall, foot], [0, foot]]
    bond = {"tension": tension, "shear": 1.6 * tension, "young_modulus": 5e10, "crumble": 0.001}
    broken = {"pattern": {"kind": "voronoi", "pieces": 14, "seed": 513}, "bond": bond}
    return rigid_world.entity(
        {"kind": "revolution", "profile": profile, "segments": 24}, at=(0, 0, height + 0.0011), material="glass", breakable=broken
    )


def world(entities: dict[str, Any], seconds: float) -> WorldSpec:
    return rigid_world.world(
        {"floor": rigid_world.floor(material="stone"), **entities},
        seconds=seconds,
        materials=MATTER,
        settings={"step": 1e-4, "refine": 2},
    )


def dropped(folder: Path, height: float, tension: float) -> Candidate:
    return simulate(folder, world({"jar": jar(height, tension)}, math.sqrt(2 * height / 9.81) + 0.1))


def pushed(folder: Path, speed: float, mass: float, tension: float) -> Candidate:
    tin = rigid_world.entity(
        {"kind": "cylinder", "radius": TIN, "height": 0.12}, at=(-0.1, 0, TIN + 0.0012), euler=(math.pi / 2, 0, 0),
        v=(speed, 0, 0), w=(0, speed / TIN, 0), material="tin", mass=mass,
    )  # fmt: skip
    return simulate(folder, world({"tin": tin, "jar": jar(0.0, tension)}, 0.02 / speed + 0.15))


def bonds(candidate: Candidate) -> dict[str, Any]:
    """Loads of the jar's bonds over the whole run, as `inspect_world(part='state')` tells them."""
    told, _ = motion_over(candidate, ["jar"], 0, candidate.last_frame, 10, 0)
    found: dict[str, Any] = told["entities"]["jar"]["bonds"]
    return found


def mass_of(candidate: Candidate) -> float:
    return sum(b.mass for b in candidate.entity("jar").bodies)


@pytest.mark.parametrize("height", [0.3, 0.7])
def test_the_load_of_a_fall_is_that_of_its_momentum(tmp_path: Path, height: float) -> None:
    candidate = dropped(tmp_path, height, UNBROKEN)
    momentum = mass_of(candidate) * math.sqrt(2 * 9.81 * height)
    stress = bonds(candidate)["largest_load"] * UNBROKEN
    assert stress == pytest.approx(FALL * momentum / CONTACT_TIME, rel=LINEAR)
    told, _ = state_at(candidate, ["jar"], candidate.last_frame, candidate.last_frame, 10, 0)
    assert told["entities"]["jar"]["bonds"] == {
        "broken": 0,
        "largest_load": bonds(candidate)["largest_load"],
        "at_frame": bonds(candidate)["at_frame"],
    }


@pytest.mark.parametrize("speed", [0.3, 0.6])
def test_the_load_of_a_knock_is_that_of_the_shared_momentum(tmp_path: Path, speed: float) -> None:
    candidate = pushed(tmp_path, speed, 1.9, UNBROKEN)
    mass = mass_of(candidate)
    impulse = mass * 1.9 / (mass + 1.9) * speed
    stress = bonds(candidate)["largest_load"] * UNBROKEN
    assert stress == pytest.approx(KNOCK * impulse / CONTACT_TIME, rel=LINEAR)


def test_the_strength_between_the_two_loads_survives_the_push_and_breaks_on_the_floor(tmp_path: Path) -> None:
    """As the skill says: the root of the product of both loads, read from runs in which nothing breaks."""
    push, fall = pushed(tmp_path / "a", 0.3, 1.9, UNBROKEN), dropped(tmp_path / "b", 0.7, UNBROKEN)
    loads = [bonds(c)["largest_load"] for c in (push, fall)]
    assert loads[0] < 0.5 * loads[1], "a slow push leaves room between the two"
    strength = UNBROKEN * math.sqrt(loads[0] * loads[1])
    assert 3e5 < strength < 8e5, "the range of the skill's table for glasses"
    kept, gone = bonds(pushed(tmp_path / "c", 0.3, 1.9, strength)), bonds(dropped(tmp_path / "d", 0.7, strength))
    assert kept["broken"][-1] == 0
    assert gone["broken"][-1] > 0


def test_a_knock_at_walking_speed_breaks_what_a_fall_from_a_shelf_does(tmp_path: Path) -> None:
    """No strength is right for a tin of 1.9 kg at 1.25 m/s: its knock loads the jar more than a fall of 0.7 m."""
    push, fall = pushed(tmp_path / "a", 1.25, 1.9, UNBROKEN), dropped(tmp_path / "b", 0.7, UNBROKEN)
    assert bonds(push)["largest_load"] > bonds(fall)["largest_load"]
