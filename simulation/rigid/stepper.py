"""A rigid instance that steps from one time to another, over drivers that switch and clusters that fall apart."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence

import numpy as np

from ...worlds.built import BuiltEntity
from ...worlds.fields import Carrier
from ...worlds.slices import fastened_pairs
from ...worlds.spec import RigidSettings, WorldSpec
from ..fracture import Breakage, Fate
from ..protocol import Intervention
from .checkpoint import lay_down
from .contact_law import rest_speed, set_contact_law
from .distances import collide_all, settle_kinematics
from .exchange import Exchange
from .fields import FieldForces
from .flex import Flexes, hear
from .flex_fields import FlexFields
from .flex_loads import SoftLoads
from .parts import Parts, carry_over, make_parts
from .records import velocities
from .relax import open_skins

__all__ = ["Stepper"]

ADOPTED = 1.2
"""Bodies within this many summed skins of each other count as touching at frame 0 and at a release."""


class Stepper:
    """The model of the present clusters and its state.

    Args:
        spec: the specification.
        built: built entities.
        name: of the instance.
        intervention: what is done to it from outside.
        coupled: whether others push its bodies.
        media: of instances that drag its bodies along.
    """

    def __init__(
        self,
        spec: WorldSpec,
        built: Mapping[str, BuiltEntity],
        name: str,
        *,
        intervention: Intervention | None = None,
        coupled: bool = False,
        media: Mapping[str, Carrier] | None = None,
    ) -> None:
        self.spec, self.built, self.name = spec, built, name
        self._intervention, self._media = intervention or Intervention(), media or {}
        self._frame_time = 1.0 / spec.simulation.fps
        instance = spec.simulation.rigid[name]
        self.members = tuple(dict.fromkeys(instance.members))
        self.settings: RigidSettings = instance.settings
        self._work = 0.0
        """Work of drivers since the start of the frame [J]."""
        self.relaxation = 0.0
        """Largest displacement of a body when the skins were opened [m]."""
        self.settled: bytes | None = None
        """State at rest from which it starts; None: from what is declared."""
        self._coupled = coupled
        self._before: frozenset[str] | None = None
        """Who was held right before the present time."""

    def compile(self) -> None:
        """The model and the state at the start of the preroll."""
        import mujoco

        self._mj = mujoco
        # Warnings are counted in the `overflows` record; the engine would also write a log file into the working directory.
        mujoco.set_mju_user_warning(hear)
        self.breakage = Breakage(self.spec, self.built, self.members)
        self._install(self._parts())
        start = -self.spec.simulation.preroll
        self.drivers.remember_poses(self.data)
        self.drivers.set_model(start, free=True)
        self.drivers.plan_paths(start, self.settings.step, 0)
        self.drivers.follow_paths(self.data, 0, self.settings.step)
        if self.settled is None:
            self.relaxation = open_skins(
                self.rigid, self.data, self.settings, frozenset(map(frozenset, fastened_pairs(self.spec)))
            )
        else:
            self.relaxation = lay_down(self.model, self.data, self.settled)
        self.drivers.remember_poses(self.data)
        soft = None if self.flexes is None or not self._coupled else SoftLoads(self.flexes)
        self._exchange = Exchange(len(self.rigid.bodies), soft)

    def _parts(self) -> Parts:
        """A model of the present clusters."""
        whole = self.breakage.whole()
        return make_parts(self.spec, self.built, self.members, self.settings, self._intervention, whole, self._media)

    def _install(self, parts: Parts) -> None:
        """Work with this model from now on."""
        self._now, self.rigid, self.model, self.data = parts, parts.rigid, parts.rigid.model, parts.data
        self._saved, self.drivers, self.work, self.gyration = parts.saved, parts.drivers, parts.work, parts.gyration
        self.monitor, self.ledger, self.fields, self.flexes = parts.monitor, parts.ledger, parts.fields, parts.flexes
        self.breakage.bind(self.rigid)

    def _split(self, time: float) -> None:
        """Go on from `time` [s] with the present clusters."""
        parts = self._parts()
        carry_over(self._now, parts, time)
        self._install(parts)
        settle_kinematics(self.model, self.data)

    def _adopt_contacts(self, time: float) -> None:
        """Bodies that touch, or nearly do, when the monitor starts to look at them make no event."""
        model = self.model
        margins, pair_margins = model.geom_margin.copy(), model.pair_margin.copy()
        model.geom_margin[:], model.pair_margin[:] = margins * ADOPTED, pair_margins * ADOPTED
        collide_all(self.model, self.data)
        self.monitor.adopt(self.data, time)
        model.geom_margin[:], model.pair_margin[:] = margins, pair_margins

    def _run(self, start: float, end: float, step: float, held: frozenset[str] | None = None) -> int:
        """Step from `start` to `end` [s], switching drivers exactly at their times; returns the steps taken.

        `held` tells who was held right before `start`.
        """
        taken = 0
        held = self.drivers.held(start) if held is None else held
        stops = [start, *self.drivers.switch_times(start, end), end]
        for t0, t1 in itertools.pairwise(stops):
            count = max(1, math.ceil((t1 - t0) / step * (1 - 1e-9)))
            dt = (t1 - t0) / count
            self._set(t0, t0, dt, count)
            if held - self.drivers.held(t0):
                self._adopt_contacts(t0)
            held = self.drivers.held(t0)
            done, retakes = 0, 0
            while done < count:
                if done or retakes:
                    self._set(t0, t0 + done * dt, dt, count - done)
                steps, fate = self._segment(t0 + done * dt, dt, count - done, retakes)
                done += steps
                retakes = (retakes if steps == 0 else 0) + 1 if fate is Fate.AGAIN else 0
                if fate is not Fate.WHOLE:
                    self._split(t0 + done * dt)
            taken += count
        self._before = held
        return taken

    def _set(self, since: float, now: float, dt: float, count: int) -> None:
        """Write what holds from `since` on into model and state, for `count` steps of `dt` from `now` [s]."""
        set_contact_law(self.rigid, self.settings.contact_steps, dt)
        self.drivers.set_model(since)
        self.drivers.set_data(self.data, since)
        self._exchange.apply(self._now)
        self.drivers.plan_paths(now, dt, count)

    def _segment(self, start: float, dt: float, count: int, retakes: int) -> tuple[int, Fate]:
        """Up to `count` steps of `dt` [s] within which no driver switches.

        Args:
            start: of the first [s].
            dt: step [s].
            count: of steps.
            retakes: how often the first of them was taken already.

        Returns:
            Steps taken before clusters fell apart, and whether they did, in the last of these steps or in one to be taken again.
        """
        mujoco, model, data = self._mj, self.model, self.data
        first, watch_contacts, watch_sleep = mujoco.mj_step1, self.monitor.watch_contacts, self.monitor.watch_sleep
        authored, contact_law, solve = bool(self.drivers.kinematic), self.rigid.law.apply, self.rigid.law.solve
        gyration, ropes, watch = self.gyration.apply, self.drivers.has_ropes, self.ledger.watch
        fields = [f for f in (self.fields, None if self.flexes is None else self.flexes.fields) if f]
        held = self.drivers.held(start) if fields else frozenset()
        working = self.work.begin(data, velocities(model, data), self._exchange.outside(self._now))
        slowest = rest_speed(float(np.linalg.norm(model.opt.gravity)), dt)
        breaks, still, fate, taken = bool(self.breakage), self.drivers.held(start), Fate.WHOLE, 0
        while taken < count and fate is Fate.WHOLE:
            k = taken
            if authored:
                self.drivers.follow_paths(data, k, dt)
            if ropes:
                self.drivers.slacken(data)
            first(model, data)
            watch(data)
            for field in fields:
                field.apply(data, start + k * dt, dt, held)
            gyration(data, dt)
            contact_law(data, dt, slowest)
            if self.flexes is not None:
                self._step_beside(self.flexes, start + (k + 1) * dt, dt)
            else:
                # The stages of `mj_step2`, so that forces are read before the integration.
                solve(data)
                mujoco.mj_checkAcc(model, data)
                if breaks:
                    again, others = retakes if k == 0 else 0, self._exchange.asked
                    fate = self.breakage.watch(data, start + (k + 1) * dt, dt, still, retakes=again, others=others)
                    if fate is Fate.AGAIN:
                        self._undo(fields, working, dt)
                        return k, fate
                watch_contacts(data, start + (k + 1) * dt, dt)
                mujoco.mj_implicit(model, data)
                self.rigid.law.end(data, dt)
                watch_sleep(data, start + (k + 1) * dt)
            if working:
                self.work.after_step(data, dt)
            self._exchange.step(self._now, dt)
            taken += 1
        if authored:
            self.drivers.follow_paths(data, taken, dt)
        self._close(fields, working, taken, dt)
        return taken, fate

    def _step_beside(self, flexes: Flexes, end: float, dt: float) -> None:
        """The rest of a step of `dt` to `end` [s] with elastic members: their integrator has no stage of its own, and nothing sleeps beside them."""
        self._mj.mj_step2(self.model, self.data)
        self.rigid.law.settle(self.data)
        self.monitor.watch_contacts(self.data, end, dt)
        self.rigid.law.end(self.data, dt)
        flexes.watch(self.data, dt)

    def _close(self, fields: Sequence[FieldForces | FlexFields], working: bool, taken: int, dt: float) -> None:
        """Bring the state up to date after some steps of `dt` [s], and count what acted in them."""
        settle_kinematics(self.model, self.data)
        for field in fields:
            field.end(self.data)
        if working:
            self._work += self.work.end(velocities(self.model, self.data), dt)
        self._exchange.taken(self._now, taken * dt)

    def _undo(self, fields: Sequence[FieldForces | FlexFields], working: bool, dt: float) -> None:
        """Take back what the present step began: it is taken again."""
        for field in fields:
            field.undo(self.data)
        if working:
            self._work += self.work.end(velocities(self.model, self.data), dt)
