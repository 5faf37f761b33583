"""Balloons in still air: weight, buoyancy and a drag that grows with speed, solved in closed form over every frame.

m dv/dt = (m - rho V) g - c v, with the mass m and volume V of a balloon, the density rho of the air and its drag c. No added mass.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...worlds.arrays import F64, pose_of
from ...worlds.categories.balloons.models import BalloonPhysics
from ...worlds.shapes import Sphere
from ..boundaries import BodyState, Surround
from ..coupled_solver import CoupledSolver, motion_records
from ..sealed import from_bytes, to_bytes
from ..step_reports import StepReport

__all__ = ["SolverBalloons"]

NOTHING = Surround((), (), ())


class SolverBalloons(CoupledSolver):
    """One instance of balloons."""

    KIND = "balloons"
    REMEDY = "raise their air_drag"

    @property
    def surround(self) -> Surround:
        """Nothing: they meet no bodies."""
        return NOTHING

    def set_up(self) -> None:
        """Balloons at their places, at rest."""
        spec = self.spec
        parts = [(k, m, p) for k, m in enumerate(self.members) for _, p in sorted(spec.entities[m].parts.items())]
        self.member = np.array([k for k, _, _ in parts], dtype=np.int32)
        self.radius: F64 = np.array([p.shape.radius for _, _, p in parts if isinstance(p.shape, Sphere)])
        own = [pose_of(spec.entities[m].pose).apply(pose_of(p.pose).position[None])[0] for _, m, p in parts]
        self.position: F64 = np.array(own)
        self.velocity: F64 = np.zeros_like(self.position)
        volume = 4.0 / 3.0 * np.pi * self.radius**3
        density = np.array([spec.materials[p.material or spec.entities[m].material].density for _, m, p in parts])
        self.mass: F64 = density * volume
        physics = [spec.entities[m].physics for _, m, _ in parts]
        self.drag: F64 = np.array([p.air_drag for p in physics if isinstance(p, BalloonPhysics)])
        gravity = np.array(spec.simulation.gravity, dtype=np.float64)
        self.lift: F64 = (self.mass - self.instance.settings.air_density * volume)[:, None] * gravity

    def max_stable_dt(self) -> float:
        """A frame: the motion is known in closed form."""
        return self._frame_time

    def step(self, limit: float, bodies: BodyState, time: float) -> StepReport:
        """One step of `limit` seconds from `time`, counted into the frame."""
        if not self.held(time):
            rate = (self.drag / self.mass)[:, None]
            last, end = self.velocity, self.lift / self.drag[:, None]
            decay = np.exp(-rate * limit)
            self.velocity = end + (last - end) * decay
            self.position = self.position + end * limit + (last - end) * (1.0 - decay) / rate
            gained = self.mass @ (self.velocity - last)
            for k, axis in enumerate("xyz"):
                lifted = float(self.lift[:, k].sum()) * limit
                self._ledger[f"lift_impulse_{axis}"] += lifted
                self._ledger[f"drag_impulse_{axis}"] += float(gained[k]) - lifted
        self._tally["steps"] += 1
        return StepReport.still(limit, NOTHING)

    def open_ledger(self) -> dict[str, Any]:
        """Sums since frame 0."""
        return {f"{name}_impulse_{axis}": 0.0 for name in ("lift", "drag") for axis in "xyz"}

    def open_tally(self) -> dict[str, Any]:
        """Sums of a frame."""
        return {"steps": 0}

    def coordinates(self) -> tuple[F64, F64]:
        """Positions and velocities (n, 3) of the balloons [m, m/s]."""
        return self.position, self.velocity

    def measured(self) -> dict[str, Any]:
        """Channels and records of the frame that ends."""
        origin, steps = self.position.mean(axis=0), self._tally["steps"]
        moved = motion_records(self.mass, self.position, self.velocity, np.array(self.spec.simulation.gravity))
        records = {**moved, **self._ledger, "steps": steps, "step": self._frame_time if steps else 0.0}
        return {
            "origin": origin,
            "particle/position": (self.position - origin).astype(np.float32),
            "particle/velocity": self.velocity.astype(np.float32),
            "particle/id": np.arange(len(self.mass), dtype=np.int32),
            "balloon/member": self.member,
            "balloon/radius": self.radius.astype(np.float32),
            **{f"record/{name}": np.float64(value) for name, value in records.items()},
        }

    def pack(self) -> bytes:
        """State of the engine."""
        return to_bytes({"position": self.position, "velocity": self.velocity})

    def unpack(self, state: bytes) -> None:
        """Continue from such a state."""
        found = from_bytes(state, ("position", "velocity"))
        if found["position"].shape != (*self.radius.shape, 3):
            raise ValueError(f"it has {len(found['position'])} balloons, not {len(self.radius)}")
        self.position, self.velocity = found["position"], found["velocity"]
