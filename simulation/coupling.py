"""Two-way coupling of a rigid instance with coupled solvers: liquids, cloth, grains (R66-R68). They step together and exchange impulses.

At every sub-step a coupled solver gets the bodies as they are, with their inverse mass and inertia and their acceleration without it,
so that its solve can let them give way (which keeps light bodies stable). What it gave them over the step is applied to the
MuJoCo bodies as a constant wrench over the same time, in which they make their own steps. Both sides are recorded, each
counted by itself: `exchange/impulse` and `exchange/reaction` in the coupled solver's cache, `exchange/impulse` of what MuJoCo
integrated in the rigid one's.

Surfaces that deform are met at their vertices: those of elastic members of the rigid instance, and those of cloth for the
other coupled solvers. Impulses at vertices are taken to what carries them, nodes or the cloth's vertices, over the same time. Cloth
steps last, so that it has all that the others gave it.

A frame at whose end surfaces of bodies could overlap is redone by all instances with half the rigid step, from their
states at its start; so every frame starts from checkpoint bytes, and a resumed run equals an unbroken one.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np

from ..worlds.arrays import F64
from .airing import Airing
from .bodies import lay_vertices, resting
from .boundaries import BodyState, MovingSurface
from .coupled_solver import CoupledSolver
from .protocol import SHORTEST, Within, stepping
from .rigid.coupled import RigidBodies, lasting
from .rigid.solver import SolverRigid
from .rigid.struck import Struck

__all__ = ["CoupledRun"]


@runtime_checkable
class Deforms(Protocol):
    """A coupled solver whose vertices are boundaries of others."""

    @property
    def members(self) -> tuple[str, ...]:
        """Its entities."""

    def surface(self, entity: str) -> MovingSurface:
        """An entity's vertices at present."""

    def load(self, forces: Mapping[str, F64]) -> None:
        """Forces at the vertices of its entities from now on, each (v, 3) [N]."""


class _Soft(NamedTuple):
    """A deforming boundary of a coupled solver."""

    row: int
    entity: str
    owner: int
    """The coupled solver that moves it; -1: the rigid instance."""


class CoupledRun:
    """A rigid instance and the coupled solvers that it exchanges impulses with, perhaps in a gas that carries and feels them."""

    def __init__(self, rigid: SolverRigid, others: Sequence[CoupledSolver], airing: Airing | None = None) -> None:
        self.rigid, self._airing = rigid, airing
        self.others = tuple(sorted(others, key=lambda o: isinstance(o, Deforms)))
        self._all = self.others if airing is None else (*self.others, airing.gas)
        self.frame = 0
        self._frame_time = 1.0 / rigid.spec.simulation.fps

    def prepare(self, *, resumed: bool = False, tell: Within | None = None) -> None:
        """Set all up and run the preroll together: the state at frame 0. `tell` takes how far the preroll is."""
        self.rigid.compile()
        for other in self._all:
            other.begin_run()
        self._bodies = RigidBodies(self.rigid)
        self._rest = [resting(other.surround) for other in self.others]
        self._rows = [self._moving_rows(other) for other in self.others]
        self._soft = [self._soft_rows(other) for other in self.others]
        self._struck = Struck(self.rigid, self.others)
        preroll = self.rigid.spec.simulation.preroll
        if preroll > 0 and not resumed:
            self.rigid.begin_attempt(0)
            self.rigid.time = -preroll
            self._go(-preroll, 0.0, tell=tell)
        self.rigid.start_frames()
        for other in self._all:
            other.start_frames()
        self.frame = 0

    def _moving_rows(self, other: CoupledSolver) -> list[tuple[int, int]]:
        """(row among its boundaries, row among the moving bodies) of the bodies that it meets."""
        known = {name: row for row, name in enumerate(self.rigid.rigid.bodies)}
        return [(k, known[b.name]) for k, b in enumerate(other.surround.boundaries) if b.name in known]

    def _soft_rows(self, other: CoupledSolver) -> list[_Soft]:
        """The deforming boundaries that it meets, and who moves them."""
        owners = {m: k for k, p in enumerate(self.others) if isinstance(p, Deforms) for m in p.members}
        return [_Soft(row, s.entity, owners.get(s.entity, -1)) for row, s in other.surround.soft.items()]

    def advance(self, frame: int, *, tell: Within | None = None) -> None:
        """Advance all from frame - 1 to `frame`; `tell` takes how far that is.

        Raises:
            InputError: not the next frame.
            EngineError: a state is not finite.
        """
        rigid = self.rigid
        rigid.begin_frame(frame)
        states = [other.checkpoint() for other in self._all]
        for level in range(rigid.settings.refine + 1):
            if level > 0:
                for other, state in zip(self._all, states, strict=True):
                    other.restore(state, frame - 1)
            rigid.begin_attempt(level)
            for other in self._all:
                other.begin_frame(frame)
            again = f"{rigid.repeats()}, " if level > 0 else ""
            self._go((frame - 1) * self._frame_time, frame * self._frame_time, tell=tell, again=again)
            if rigid.end_attempt():
                break
        rigid.end_frame()
        for other in self._all:
            other.end_frame()
        self.frame = frame

    def _go(self, start: float, end: float, *, tell: Within | None = None, again: str = "") -> None:
        """Step all from `start` to `end` [s], in a gas that feels them from step to step of it."""
        exchange = partial(self._exchange, tell=tell, again=again)
        if self._airing is None:
            exchange(start, end)
        else:
            self._airing.through(
                start, end, exchange if self.others else lambda begin, until: self.rigid.step_to(until, start=begin)
            )

    def _exchange(self, start: float, end: float, *, tell: Within | None = None, again: str = "") -> None:
        """Step all from `start` to `end` [s]; the first coupled solver sets the pace. `tell` takes how far it is, after the words `again`."""
        time = start
        while time < end - SHORTEST:
            bodies, surfaces = self._bodies.state(), self._bodies.surfaces()
            wrench = np.zeros((len(self.rigid.rigid.bodies), 6))
            given_to: dict[int, dict[str, F64]] = {}
            taken = 0.0
            for number, other in enumerate(self.others):
                if isinstance(other, Deforms):
                    other.load({n: j / taken for n, j in given_to.get(number, {}).items()})
                given = self._bodies_of(number, bodies, surfaces)
                if number == 0:
                    report = other.step(self._span(end - time, other.max_stable_dt(), bodies), given, time)
                    taken, impulse, at_vertices = report.dt, report.impulse, dict(report.vertex_impulse)
                else:
                    impulse, at_vertices = _steps(other, given, time, taken)
                for boundary, body in self._rows[number]:
                    wrench[body] += impulse[boundary]
                for soft in self._soft[number]:
                    held = given_to.setdefault(soft.owner, {})
                    held[soft.entity] = held.get(soft.entity, 0.0) + at_vertices[soft.row]
            until = end if end - time - taken < SHORTEST else time + taken
            loads = {n: j / (until - time) for n, j in given_to.get(-1, {}).items()}
            self.rigid.step_to(until, wrench / (until - time), start=time, loads=loads)
            time = until
            if tell is not None:
                tell((time - start) / (end - start), again + stepping(taken))

    def _span(self, left: float, usual: float, bodies: BodyState) -> float:
        """Longest next exchange [s], `left` [s] before the end, where `usual` [s] is what it would be: equal parts of what is left."""
        longest = lasting(bodies, min(left, usual))
        span = self._struck.span(left, usual)
        return span if longest >= min(span, usual) else left / math.ceil(left / longest - 1e-6)

    def _bodies_of(self, number: int, moving: BodyState, surfaces: Mapping[str, MovingSurface]) -> BodyState:
        """States of the boundaries of one coupled solver: those at rest at their places, the others as they are."""
        rest, rows = self._rest[number], self._rows[number]
        found = rest.copied_rows()
        if rows:
            own, theirs = (list(k) for k in zip(*rows, strict=True))
            found.write(own, moving, theirs)
        for soft in self._soft[number]:
            owner = self.others[soft.owner]
            now = owner.surface(soft.entity) if soft.owner >= 0 and isinstance(owner, Deforms) else surfaces[soft.entity]
            lay_vertices(found, soft.row, self.others[number].surround.soft[soft.row], now.places, now.speeds)
            found.vertex_lightness[soft.row], found.vertex_give[soft.row] = now.lightness, now.give
            found.vertex_pace[soft.row] = now.pace
        return found


def _steps(other: CoupledSolver, bodies: BodyState, time: float, seconds: float) -> tuple[F64, dict[int, F64]]:
    """Let a coupled solver step for `seconds` from `time`; the impulses that it gave, shape (b, 6), and those at vertices."""
    total: F64 = np.zeros((len(other.surround.boundaries), 6))
    at_vertices: dict[int, F64] = {}
    done = 0.0
    while done < seconds - SHORTEST:
        report = other.step(seconds - done, bodies, time + done)
        total += report.impulse
        for row, given in report.vertex_impulse.items():
            at_vertices[row] = at_vertices.get(row, 0.0) + given
        done += report.dt
    return total, at_vertices
