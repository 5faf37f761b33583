"""Judge of balloons: their momentum against recorded impulses, and their motion against the balance of forces."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ....worlds.arrays import F64
from ....worlds.built import TriangleMesh
from ....worlds.categories.balloons.models import BalloonPhysics
from ...rows.corrections import bake_again
from ...rows.findings import Finding
from ..container import answers, rows_about
from ..judge import joined
from ..loose import Loose, Sample
from .questions import BALANCE, LEDGER, ROUNDING

if TYPE_CHECKING:
    from ....worlds.cache import Cache
    from ....worlds.candidate import Candidate
    from ....worlds.requirements import Row
    from ....worlds.spec import SolverInstance

__all__ = ["BalloonJudge"]


class _Flight:
    """The balloons of one instance over its frames."""

    def __init__(self, candidate: Candidate, solver: str, cache: Cache) -> None:
        spec = candidate.spec
        self.cache, self.frames, self.step = cache, candidate.frame_count, 1.0 / spec.simulation.fps
        self.member = cache.read(0, ("balloon/member",))["balloon/member"]
        volume = 4.0 / 3.0 * np.pi * cache.read(0, ("balloon/radius",))["balloon/radius"].astype(np.float64) ** 3
        contracts = [spec.entities[name] for name in cache.index.bodies]
        self.mass: F64 = np.array([spec.materials[c.material].density for c in contracts])[self.member] * volume
        self.drag: F64 = np.array([c.physics.air_drag for c in contracts if isinstance(c.physics, BalloonPhysics)])[self.member]
        air = float(getattr(spec.simulation.solvers[solver].settings, "air_density", 0.0))
        self.lift: F64 = (self.mass - air * volume)[:, None] * np.array(spec.simulation.gravity, dtype=np.float64)

    def at(self, frame: int) -> tuple[F64, F64]:
        """Positions and velocities (n, 3) [m, m/s]."""
        held = self.cache.read(frame, ("origin", "particle/position", "particle/velocity"))
        return held["origin"] + held["particle/position"].astype(np.float64), held["particle/velocity"].astype(np.float64)

    def impulse(self, frame: int) -> F64:
        """Recorded impulse of weight, lift and drag since frame 0 [N s], shape (3,)."""
        names = [[f"record/{kind}_impulse_{axis}" for kind in ("lift", "drag")] for axis in "xyz"]
        held = self.cache.read(frame, tuple(n for pair in names for n in pair))
        return np.array([sum(float(held[n]) for n in pair) for pair in names])


def _worst(open_shares: list[float], text: str) -> Finding:
    """The finding about shares of a balance that stay open, one per frame from frame 1 on."""
    worst = max(open_shares, default=0.0)
    late = next((k + 1 for k, share in enumerate(open_shares) if not share <= ROUNDING), None)
    hints = (bake_again("the cache is of another engine, or damaged"),)
    return Finding("pass" if late is None else "fail", f"{text} by {worst:.3g}", worst, ROUNDING, frame=late, hints=hints)


def _ledger(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    flight = _Flight(candidate, solver, cache)
    start = flight.mass @ flight.at(0)[1]
    scale = float(np.abs(flight.lift).sum()) * flight.step
    shares = [
        float(np.linalg.norm(flight.mass @ flight.at(k)[1] - start - flight.impulse(k))) / (scale * k)
        for k in range(1, flight.frames)
    ]
    return _worst(shares, "momentum differs from the recorded impulses")


def _balance(candidate: Candidate, solver: str, cache: Cache) -> Finding:
    flight = _Flight(candidate, solver, cache)
    scale = float(np.linalg.norm(flight.lift, axis=1).max()) * flight.step
    shares = []
    for k in range(1, flight.frames):
        (place, velocity), (last, before) = flight.at(k), flight.at(k - 1)
        gained = flight.mass[:, None] * (velocity - before)
        given = flight.lift * flight.step - flight.drag[:, None] * (place - last)
        shares.append(float(np.linalg.norm(gained - given, axis=1).max()) / scale)
    return _worst(shares, "change of momentum differs from lift less drag")


class BalloonJudge(Loose):
    """Balloons."""

    name: ClassVar[str] = "balloons"
    goes_on: ClassVar[str] = "rise on"
    still: ClassVar[float] = 0.01

    def category_rows(self, candidate: Candidate, solver: str) -> list[Row]:
        """Rows of one instance."""
        return answers(candidate, solver, {LEDGER: _ledger, BALANCE: _balance})

    def numerical_rows(self, candidate: Candidate, solver: str) -> list[Row]:
        """Rows of the cache of one instance."""
        return rows_about(candidate, solver, {})

    def sample(self, candidate: Candidate, solver: str, row: int, frame: int) -> Sample:
        """Balloons of one member at a frame."""
        flight = candidate.memo(("flight", solver), lambda: _Flight(candidate, solver, self.caches(candidate)[solver]))
        position, velocity = flight.at(frame)
        own = flight.member == row
        return Sample(position[own], velocity[own], flight.mass[own])

    def outline(self, candidate: Candidate, entity: str, frame: int) -> TriangleMesh:
        """Spheres of the balloons; before any simulation, at their declared places."""
        if candidate.stage == "static":
            return super().outline(candidate, entity, frame)
        solver, cache, row = self.held(candidate, entity)
        flight = _Flight(candidate, solver, cache)
        way = (flight.at(frame)[0] - flight.at(0)[0])[flight.member == row]
        parts = sorted(candidate.entity(entity).parts, key=lambda p: p.part)
        return joined(
            [TriangleMesh(candidate.surface(entity, p.part, 0) + w, p.render.faces) for p, w in zip(parts, way, strict=True)]
        )

    def mechanical_energy(self, candidate: Candidate, solver: str) -> F64 | None:
        """Kinetic energy and that of weight and buoyancy together, which drag alone lessens [J], shape (frames,)."""
        flight = _Flight(candidate, solver, self.caches(candidate)[solver])
        moments = (flight.at(frame) for frame in range(flight.frames))
        return np.array([0.5 * flight.mass @ (v**2).sum(axis=1) - float((flight.lift * x).sum()) for x, v in moments])

    def lines(self, candidate: Candidate) -> list[dict[str, str]]:
        """Lines of the approximation register."""
        balloons = [n for n, e in candidate.spec.entities.items() if e.physics.category == self.name]
        return [
            {"what": f"balloons of {n!r} rise through still air", "effect": "they meet neither each other nor bodies"}
            for n in balloons
        ]

    def domain(self, instance: SolverInstance) -> tuple[F64, F64] | None:
        """None: they are followed wherever they go, and `lines` tells whom they meet."""
        return None
