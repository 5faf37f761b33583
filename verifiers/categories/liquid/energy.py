"""Energy and momentum of a liquid against all that can change them (R67, R99).

- `energy`: kinetic + potential energy, less what inflow, waves and bodies gave, never grows by more than
  `limits.energy_growth` of the energy in play. Pressure, viscosity and walls only take energy away.
- `momentum`: what changes the liquid's momentum in a frame is gravity, what boundaries gave (`exchange/reaction`), what zones of waves gave, what came in
  and went out, and closed sides of the domain, which push inwards only.
- `calm`: liquid that nothing drives and whose surface has come to rest does not move by itself.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ....worlds.arrays import F64
from ....worlds.errors import EvidenceError
from ...rows.corrections import bake_again, out_of_solids
from ...rows.findings import Finding
from .bodies import Bodies, exchanged
from .bounds import CALM, DRIVEN, LAYERS, MOMENTUM, SETTLED, TENSION
from .corrections import refine, shorter_step
from .questions import ENERGY, MOMENTUM_BALANCE
from .rows import first_over

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...rows.questions import Question
    from .frames import Frame, Liquid, Step

__all__ = ["Energy", "Momentum", "blown"]

QUIET_SECONDS = 0.5
WET = 2.0
"""Spacings from a side of the domain within which liquid can feel it."""


DRIVEN_RECORDS = ("driver_impulse_x", "driver_impulse_y", "driver_impulse_z", "driver_work")
BLOWN_RECORDS = ("field_impulse_x", "field_impulse_y", "field_impulse_z", "field_work")


def driven(step: Step) -> F64:
    """Momentum [N s] and energy [J] that zones of waves and force fields gave in a frame, (4,); zero where none are planned.

    Raises:
        EvidenceError: some are planned and their records are missing.
    """
    waves = _since(step, DRIVEN_RECORDS) if step.liquid.waves else np.zeros(4)
    return waves + blown(step)


def blown(step: Step) -> F64:
    """The same of force fields alone."""
    return _since(step, BLOWN_RECORDS) if step.liquid.fields else np.zeros(4)


def _since(step: Step, names: tuple[str, ...]) -> F64:
    """Increase of the named sums since the frame before, shape (4,); zeros at the first.

    Raises:
        EvidenceError: a frame lacks one of them.
    """
    if step.before is None:
        return np.zeros(4)
    missing = [n for n in names if f"record/{n}" not in step.now.others or f"record/{n}" not in step.before.others]
    if missing:
        raise EvidenceError(f"frame {step.now.index} of {step.liquid.solver!r} lacks record/{missing[0]}; bake again")
    return np.array([float(step.now.others[f"record/{n}"]) - float(step.before.others[f"record/{n}"]) for n in names])


class Energy:
    """Kinetic and potential energy of every frame, with what brought or took any."""

    questions: ClassVar[Mapping[str, Question]] = ENERGY

    def __init__(self, liquid: Liquid) -> None:
        self.liquid, self.bodies = liquid, Bodies(liquid)
        self.kinetic: list[float] = []
        self.potential: list[float] = []
        self.given: list[float] = []
        self.doubt: list[float] = []
        self.driven: list[bool] = []
        self.layers: list[float] = []
        self.half_height = self.one_spacing = 0.0
        self.tension = 0.0

    def see(self, step: Step) -> None:
        """Sum up one frame."""
        liquid, frame = self.liquid, step.now
        height = frame.position @ liquid.up
        each = frame.mass * (0.5 * frame.squared + liquid.strength * height)
        self.layers.append(_layers(liquid, frame))
        self.kinetic.append(0.5 * float(frame.mass @ frame.squared))
        self.potential.append(liquid.strength * float(frame.mass @ height))
        weight = liquid.strength * float(frame.mass.sum())
        self.one_spacing = max(self.one_spacing, weight * liquid.spacing)
        low, top = (float(height.min()), float(np.quantile(height, 0.999))) if frame.count else (0.0, 0.0)
        self.half_height = max(self.half_height, 0.5 * weight * (top - low))
        strongest = max(liquid.physics(m).surface_tension for m in liquid.members)
        self.tension = max(self.tension, TENSION * strongest * 6.0 * frame.count ** (2 / 3) * liquid.pitch**2)
        given, doubt = 0.0, 0.0
        if step.before is not None:
            came = step.new
            given += float(each[came].sum()) + liquid.strength * float(frame.mass[came] @ np.maximum(top - height[came], 0.0))
            then = step.before
            out = step.gone
            went = then.mass[out] * (0.5 * then.squared[out] + liquid.strength * (then.position[out] @ liquid.up))
            given -= float(went.sum())
            given_by_bodies, doubt = self._bodies(step)
            given += given_by_bodies + float(driven(step)[3])
        self.given.append(given)
        self.doubt.append(doubt)
        inflow = any(liquid.active(n, frame.index) for n in liquid.inflows)
        waves = any(w.start < frame.index * liquid.duration for w in liquid.waves.values())
        blowing = any(f.acts((frame.index - 1) * liquid.duration, frame.index * liquid.duration) for f in liquid.fields)
        self.driven.append(bool(inflow or waves or blowing or len(step.gone) or self.bodies.moving[frame.index] > DRIVEN))

    def _bodies(self, step: Step) -> tuple[float, float]:
        """Work of moving boundaries on the liquid in the frame [J], and how far the frame's ends leave it open."""
        k = step.now.index
        linear, angular = self.bodies.motion
        if not (linear[k - 1 : k + 1].any() or angular[k - 1 : k + 1].any()):
            return 0.0, 0.0
        impulse = exchanged(step.now, "impulse", self.bodies.count)
        rows, told = self.bodies.told_work(k)
        impulse[list(rows)] = 0.0
        v, w = (0.5 * (m[k - 1] + m[k]) for m in (linear, angular))
        change = np.linalg.norm(linear[k] - linear[k - 1], axis=1), np.linalg.norm(angular[k] - angular[k - 1], axis=1)
        doubt = 0.5 * (np.linalg.norm(impulse[:, :3], axis=1) @ change[0] + np.linalg.norm(impulse[:, 3:], axis=1) @ change[1])
        doubt += float(np.linalg.norm(impulse[:, :3], axis=1) @ self.bodies.bending(k))
        return -told - float((impulse[:, :3] * v).sum() + (impulse[:, 3:] * w).sum()), float(doubt)

    def findings(self) -> dict[str, Finding]:
        """Growth of energy, and what goes on in the quiet end."""
        kinetic, potential = np.array(self.kinetic), np.array(self.potential)
        return {"energy": self._energy(kinetic, potential), "calm": self._calm(kinetic, potential)}

    def _energy(self, kinetic: F64, potential: F64) -> Finding:
        if not len(kinetic):
            raise EvidenceError("the cache holds no frame")
        energy = kinetic + potential - np.cumsum(self.given)
        lowest = np.minimum.accumulate(energy)
        at = np.array([int(np.argmin(energy[: k + 1])) for k in range(len(energy))])
        doubts = np.cumsum(self.doubt)
        rise = energy - lowest - (doubts - doubts[at])
        # What all of it would gain by a rise of one spacing, so that particles that settle at rest are no growth.
        scale = max(float(kinetic.max()) + float(np.ptp(potential - np.cumsum(self.given))), self.one_spacing, 1e-12)
        bound = self.liquid.candidate.spec.simulation.limits.energy_growth
        excess = (rise - self.tension) / scale
        thin = min(self.layers) < LAYERS and float(rise.max()) < 0.5 * self.one_spacing
        hints = (
            *((refine(self.liquid, f"the liquid lies in {min(self.layers):.2g} layers of particles, which lift each other as they close up"),) if thin else ()),
            shorter_step(self.liquid, "the step is too long for the flow"),
            out_of_solids(self.liquid.members, "a solid overlaps the liquid at the start and throws it"),
        )  # fmt: skip
        found = first_over(
            np.maximum(excess, 0.0), bound, "1", f"growth of energy without a source (of {scale:.4g} J in play)", hints
        )
        evidence = {
            "scale_J": scale,
            "start_J": float(energy[0]),
            "end_J": float(energy[-1]),
            "brought_J": float(np.sum(self.given)),
        }
        return Finding(found.status, found.text, found.measured, bound, "1", None, found.frame, found.hints, evidence)

    def _calm(self, kinetic: F64, potential: F64) -> Finding:
        driven = np.flatnonzero(self.driven)
        first = int(driven[-1]) + 1 if len(driven) else 0
        window = max(2, round(QUIET_SECONDS / self.liquid.duration))
        unit = max(self.half_height, 1e-12)
        ratio = np.full(len(kinetic), np.nan)
        for k in range(first + window, len(kinetic)):
            swing = float(np.ptp(potential[k - window : k + 1]))
            if swing <= SETTLED * unit:
                ratio[k] = max(0.0, float(kinetic[k - window : k + 1].mean()) - 2.0 * swing) / unit
        if np.isnan(ratio).all():
            return Finding(
                "not_applicable",
                f"at no frame has the surface been at rest for {QUIET_SECONDS:g} s without anything that drives it",
            )
        return first_over(ratio, CALM, "1", "kinetic energy of liquid whose surface rests, over weight x height / 2,",
                          (shorter_step(self.liquid, "the pressure solve does not converge: the liquid boils"),))  # fmt: skip


def _layers(liquid: Liquid, frame: Frame) -> float:
    """Mean depth of a liquid, seen along gravity, over where it is [spacings]."""
    if not frame.count:
        return np.inf
    flat = np.eye(3)[np.argsort(np.abs(liquid.up))[:2]]
    cells = np.floor((frame.position @ flat.T) / liquid.spacing).astype(np.int64)
    cells -= cells.min(axis=0)
    count = len(np.unique(cells[:, 0] * (cells[:, 1].max() + 1) + cells[:, 1]))
    return float(frame.volume.sum()) / (count * liquid.spacing**3)


class Momentum:
    """Change of the liquid's momentum per frame against its causes."""

    questions: ClassVar[Mapping[str, Question]] = MOMENTUM_BALANCE

    def __init__(self, liquid: Liquid) -> None:
        self.liquid, self.bodies = liquid, Bodies(liquid)
        self.excess: list[float] = []
        self.axis: list[int] = []

    def see(self, step: Step) -> None:
        """Balance one frame against the one before."""
        frame, before, liquid = step.now, step.before, self.liquid
        if before is None or frame.count + before.count == 0:
            self.excess.append(np.nan)
            self.axis.append(0)
            return
        reaction = exchanged(frame, "reaction", self.bodies.count)[:, :3]
        h = step.duration
        mass = 0.5 * float(frame.mass.sum() + before.mass.sum())
        brought = frame.mass[step.new] @ frame.velocity[step.new] - before.mass[step.gone] @ before.velocity[step.gone]
        change = frame.mass @ frame.velocity - before.mass @ before.velocity
        given = driven(step)[:3]
        rest = change - mass * h * liquid.gravity - reaction.sum(axis=0) - brought - given
        fastest = max(frame.fastest, before.fastest)
        passing = float(frame.mass[step.new].sum() + before.mass[step.gone].sum())
        scale = mass * h * max(liquid.strength, 1e-3) + float(np.linalg.norm(reaction, axis=1).sum())
        scale += float(np.linalg.norm(given))
        doubt = passing * (fastest + liquid.strength * h) + self._pushed(step)
        low, high = self._sides(step)
        over = np.maximum(np.where(high, 0.0, rest), np.where(low, 0.0, -rest)) - doubt
        self.excess.append(max(0.0, float(over.max())) / scale)
        self.axis.append(int(np.argmax(over)))

    def _pushed(self, step: Step) -> float:
        """Most that inflows can have pushed the liquid before them [N s]: pressure of its depth, and of stopping the flow."""
        liquid, frame, total = self.liquid, step.now, 0.0
        for name, driver in liquid.inflows.items():
            if liquid.active(name, frame.index) and frame.count:
                at, _ = liquid.inflow_frame(name)
                depth = max(0.0, float((frame.position @ liquid.up).max() - at @ liquid.up))
                density = float(liquid.rest_density[liquid.members.index(driver.entity)])
                total += driver.area * step.duration * density * (liquid.strength * depth + driver.flow_speed**2)
        return total

    def _sides(self, step: Step) -> tuple[F64, F64]:
        """Axes along which a closed and wet side of the domain can have pushed: towards minus, towards plus."""
        liquid = self.liquid
        low, high = np.zeros(3, dtype=bool), np.zeros(3, dtype=bool)
        reach = WET * liquid.spacing
        for frame in (step.now, step.before):
            if frame is not None and frame.count:
                travel = reach + frame.fastest * step.duration
                for axis in range(3):
                    high[axis] |= liquid.closed[2 * axis] and frame.position[:, axis].min() < liquid.lower[axis] + travel
                    low[axis] |= liquid.closed[2 * axis + 1] and frame.position[:, axis].max() > liquid.upper[axis] - travel
        return low, high

    def findings(self) -> dict[str, Finding]:
        """The largest imbalance."""
        values = np.array(self.excess)
        if np.isnan(values).all():
            return {"momentum": Finding("not_applicable", "there is no liquid at two frames in a row")}
        hints = (
            shorter_step(self.liquid, "forces on boundaries and on the liquid are not of the same step"),
            bake_again(),
        )
        found = first_over(values, MOMENTUM, "1", "momentum without a cause, over weight and impulses of a frame,", hints)
        axis = "xyz"[self.axis[int(np.nanargmax(values))]]
        return {
            "momentum": Finding(
                found.status, found.text, found.measured, MOMENTUM, "1", None, found.frame, found.hints, {"axis": axis}
            )
        }
