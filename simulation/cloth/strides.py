"""Long implicit steps of sheets in which nothing is met: how it is made sure of, and the move."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...geometry.launch import warp
from ...worlds.arrays import F64
from . import bound_kernels as bounds
from . import step_kernels as steps
from . import stride_kernels as strides
from .contacts import SPARE
from .implicit import Implicit

if TYPE_CHECKING:
    from .engine import Cloth

__all__ = ["Strides"]

WORTH = 6
"""Explicit steps that an implicit one costs, measured on 100 x 100 vertices; it has to save more."""
RETRY = 4
"""Calls until an implicit step is tried again after one that met something or turned too far."""
CALM = 0.3
"""Share of what vertices may move until lists no longer hold that they go in a step, below which lists do not count on velocities."""
AHEAD = 2.0
"""Steps for which lists are made that do."""


class Strides:
    """Long steps of one run. Lists of pairs are those of the engine's contacts, but are made anew where explicit steps lie between.

    Args:
        engine: whose arrays it moves.
    """

    def __init__(self, engine: Cloth) -> None:
        self._of = engine
        e, wp = engine, warp()
        self.implicit = Implicit(
            e.passes,
            {
                "x": e.x, "v": e.v, "u": e.u, "target": e.target, "mass": e.masses, "inverse": e.inverse, "clock": e.clock,
                "faces": e.face_array, "rest": e.rest, "law": e.law, "force": e.force, "pull": e.pull, "weight": e.weight,
                "hinges": e.hinges if len(e.host_hinges) else None, "weights": e.weights, "hinge_law": e.hinge_law,
                "corners": e.corners, "ends": e.ends, "acceleration": e.acceleration,
            },
            e.setup.sheets, e.faces, e.held,
        )  # fmt: skip
        self._share = wp.zeros(e.n, dtype=wp.float64, device=e.device)
        self._met = wp.zeros(1, dtype=wp.int32, device=e.device)
        self.taken = 0
        self.begin()

    def begin(self) -> None:
        """Forget what went before."""
        self.until, self._wait, self._last = 0.0, 0, -1

    def take(self, span: float, time: float, solid_speed: float, air: F64) -> bool:
        """Take an implicit step if it saves any, meets nothing and turns no edge too far; whether it was taken.

        Args:
            span: its length [s].
            time: at its start [s].
            solid_speed: of the fastest point of any solid [m/s].
            air: momentum [N s] and energy [J] that air and fields gave, (4,): theirs come on top.
        """
        e, implicit = self._of, self.implicit
        if span < WORTH * e.longest:
            return False
        self._wait = max(self._wait - 1, 0)
        if self._wait:
            return False
        if e.grips is not None:
            e.grips.remember()
        if e.steps_done != self._last:
            e.contacts.fresh = False
        push = e.blow(time, e.x.numpy()[: e.n])
        if e.blown:
            implicit.feel(e.x, e.v, e.face_array, e.air, e.drag, e.corners)
        self.tell(0, span)
        if e.led_count:
            e.lead()()
        trusted = implicit.step(span)
        felt = implicit.settle(span)
        if not trusted or not self._free(span, solid_speed):
            self._wait = RETRY
            e.contacts.fresh = False
            return False
        self._go()
        mean = implicit.mean.numpy()
        given = e.mass[:, None] * push * span
        if e.blown:
            given -= span * np.einsum("nij,nj->ni", implicit.drag.numpy(), mean - implicit.before.numpy())
        air += [*given.sum(0), float((given * mean).sum())]
        implicit.end()
        if len(e.held):
            e.reaction.numpy()[e.held] += felt
        self._last = e.steps_done + 1
        self.taken += 1
        return True

    def tell(self, place: int, value: float) -> None:
        """Set a value of the engine's clock."""
        clock = self._of.clock.numpy().copy()
        clock[place] = value
        self._of.clock.assign(clock)

    def _free(self, dt: float, solid_speed: float) -> bool:
        """True if a step with the velocities u surely meets nothing."""
        e = self._of
        of = e.contacts
        if not of.active:
            return True
        now = float(e.clock.numpy()[2])
        outrun = now + dt > self.until or (now + dt) * solid_speed > of.solid_margin
        if not of.fresh or outrun or self.strays():
            self.search(dt, solid_speed)
            if self.strays():
                return False
        if of.count == 0:
            return True
        self._met.zero_()
        of.passes(
            "meets", strides.meets, of.count, [e.x, e.u, of.state["radius"], of.pairs, of.kinds, e.clock, of.wanted, self._met]
        )()
        return int(self._met.numpy()[0]) == 0

    def search(self, dt: float, solid_speed: float) -> None:
        """Make new lists: of what is near while all is calm, else of what comes near as all goes on."""
        e = self._of
        of, u = e.contacts, e.u.numpy()[: e.n]
        drift = e.mass @ u / e.mass.sum()
        speed = float(np.sqrt(((u - drift) ** 2).sum(1).max()))
        own, others = of.margins(speed, float(np.linalg.norm(drift)))
        calm = not of.self_collision or speed * dt < CALM * SPARE * own
        if of.solid is not None:
            fastest = max(solid_speed, float(np.sqrt((u**2).sum(1).max())))
            calm = calm and fastest * dt < CALM * SPARE * others
        span = 0.0 if calm else AHEAD * dt
        of.search(speed, drift, span)
        of.fresh = True
        self.until = np.inf if calm else span * (1 + 1e-9)
        self.tell(2, 0.0)

    def strays(self) -> bool:
        """True if any vertex would go farther from where it was expected than lists hold."""
        e = self._of
        of = e.contacts
        of.passes("reached", bounds.reached, e.n, [e.clock, of.anchor, of.plan, of.budget, e.x, e.u, self._share])()
        return bool(self._share.numpy().max() > 1.0)

    def _go(self) -> None:
        """Move all by the step that was found free."""
        e = self._of
        p = e.passes
        p("stride", bounds.stride, e.n, [e.clock, e.u, e.x, e.v])()
        if e.total > e.n:
            p("carry", steps.carry, e.total - e.n, [e.n, e.clock, e.u, e.x])()
        p("tick", steps.tick, 1, [e.clock])()
