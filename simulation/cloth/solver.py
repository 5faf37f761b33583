"""A cloth instance as a solver: what its engine is given, and what its frames hold."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from ...worlds.cache import CacheIndex
from ...worlds.categories.cloth.facts import release_time
from ...worlds.errors import EngineError
from ..boundaries import BodyState, MovingSurface, Surround
from ..coupled_solver import CoupledSolver, motion_records
from ..protocol import SHORTEST
from ..sealed import from_bytes, to_bytes
from .energy import bending_energy, edge_ratios, membrane_energy
from .engine import Cloth
from .scene import build_scene
from .setup import ClothReport
from .tear_log import TearEvent, cause_of, tear_channels, torn_length
from .wake import Breeze, Wake

__all__ = ["SolverCloth"]

SUMS = ("air", "hold", "cut", "solid", "load")
"""Momentum given to cloth by each origin, summed since frame 0."""


class SolverCloth(CoupledSolver):
    """One cloth instance."""

    KIND = "cloth"
    REMEDY = "shorten max_step"
    PASSES = True

    # ------------------------------------------------------------------ set up

    def set_up(self) -> None:
        """Make the sheets and the engine."""
        self.scene = build_scene(
            self.spec, self.built, self.name, without=self._done.without, apart=frozenset(self._done.apart), media=self.media
        )
        self.engine = Cloth(self.scene.setup)
        self._tears = any(p.tearing is not None for p in self.scene.pieces)
        self._let_go = release_time(self.spec, self.name, self._done.without)

    @property
    def surround(self) -> Surround:
        """The bodies that it meets."""
        return self.scene.surround

    def open_ledger(self) -> dict[str, Any]:
        """Impulse and work that it was given since frame 0, by origin."""
        return {name: [0.0] * 4 for name in SUMS}

    def _rows(self, entity: str) -> slice:
        ends = np.cumsum([0, *self.scene.counts])
        own = [k for k, name in enumerate(self.scene.deformables) if name.split("/", 1)[0] == entity]
        return slice(int(ends[own[0]]), int(ends[own[-1] + 1]))

    def surface(self, entity: str) -> MovingSurface:
        """An entity's vertices at present."""
        own, (places, speeds) = self.scene.weld[self._rows(entity)], self.engine.vertices()
        lightness = np.where(self.engine.holder == -2, 1.0 / self.engine.mass, 0.0)
        return MovingSurface(places[own], speeds[own], lightness[own], lightness[own], self.engine.pace())

    def load(self, forces: Mapping[str, F64]) -> None:
        """Forces of others at the vertices of its entities from now on, each (v, 3) [N]."""
        if not forces and self.engine.loads is None:
            return
        self.engine.loads = np.zeros((self.engine.n, 3))
        for entity, given in forces.items():
            np.add.at(self.engine.loads, self.scene.weld[self._rows(entity)], given)

    def open_tally(self) -> dict[str, Any]:
        """Sums of a frame."""
        return {
            "steps": 0, "exchanges": 0, "time": 0.0, "contacts": 0, "cut": 0, "fastest": 0.0,
            "impulse": np.zeros((len(self.surround.boundaries), 6)), "tears": [],
        }  # fmt: skip

    def max_stable_dt(self) -> float:
        """Longest time of one exchange [s]; the engine's own steps are shorter."""
        return self.engine.stable_dt()

    # ------------------------------------------------------------------ stepping

    def held(self, time: float) -> bool:
        """True if a release driver or an intervention keeps this cloth where it is at `time` [s]."""
        return super().held(time) or time < self._let_go - SHORTEST

    def step(self, limit: float, bodies: BodyState, time: float) -> ClothReport:
        """One exchange of at most `limit` seconds from `time`, counted into the frame."""
        if self.held(time):
            left = self._let_go - time
            return ClothReport.still(min(limit, left) if left > SHORTEST else limit, self.surround)
        report = self._blow(limit, bodies, time)
        tally, ledger = self._tally, self._ledger
        tally["steps"] += report.steps
        tally["exchanges"] += 1
        tally["time"] += report.dt
        tally["impulse"] += report.impulse
        tally["contacts"] = max(tally["contacts"], report.contacts)
        tally["fastest"] = max(tally["fastest"], report.fastest)
        tally["cut"] += int(report.cut[3])
        solid = np.array([*(-report.contact[:, :3].sum(0)), report.work])
        for name, given in zip(
            SUMS, (report.air, report.held, np.array([*report.cut[:3], 0.0]), solid, report.load), strict=True
        ):
            ledger[name] = [a + float(b) for a, b in zip(ledger[name], given, strict=True)]
        if self._tears and time > -SHORTEST:
            self._tear(report, time + report.dt)
        return report

    def _blow(self, limit: float, bodies: BodyState, time: float) -> ClothReport:
        """An exchange of the engine, and what it takes out of a medium that feels the sheets."""
        setup = self.scene.setup
        if not (isinstance(setup.air, Breeze) and setup.air.yields):
            return self.engine.step(limit, bodies, time)
        x = self.engine.vertices()[0]
        wake = Wake(self.engine, setup.air, time, limit)
        report = self.engine.step(limit, bodies, time)
        pull = np.zeros(3) if setup.acceleration is None else self.engine.mass @ setup.acceleration(x, time)
        wake.take(report.air[:3] - report.dt * pull, report.dt)
        return report

    def _tear(self, report: ClothReport, time: float) -> None:
        """Open what is pulled too hard at `time` [s], and go on with the sheets that are left."""
        x, v = self.engine.vertices()
        vertex, corner, torn = 0, 0, False
        for piece, sheet in zip(self.scene.pieces, self.scene.setup.sheets, strict=True):
            count = len(sheet.mass)
            if piece.tearing is not None:
                found = piece.tearing.tear(sheet, x[vertex : vertex + count])
                self._tally["tears"] += [TearEvent(time, corner, cause_of(report, self.surround), t) for t in found]
                torn = torn or bool(found)
            vertex, corner = vertex + count, corner + len(piece.rest)
        if torn:
            weld, loads = self.scene.weld, self.engine.loads
            share = None if loads is None else (loads / self.engine.mass[:, None])[weld]
            self.scene = self.scene.laid(x[weld], v[weld])
            self.engine = Cloth(self.scene.setup)
            if share is not None:
                first = np.unique(self.scene.weld, return_index=True)[1]
                self.engine.loads = share[first] * self.engine.mass[:, None]

    # ------------------------------------------------------------------ state

    def pack(self) -> bytes:
        """State of the engine, and the sides that are open."""
        return to_bytes({"opened": self._opened(), "engine": np.frombuffer(self.engine.checkpoint(), dtype=np.uint8)})

    def unpack(self, state: bytes) -> None:
        """Continue from such a state."""
        found, opened = from_bytes(state, ("opened", "engine")), self._opened()
        wanted = found["opened"]
        if len(wanted) != len(opened):
            raise ValueError(f"{len(wanted)} sides for a cloth of {len(opened)}")
        if not np.array_equal(opened, wanted):
            start = 0
            for piece in self.scene.pieces:
                if piece.tearing is not None:
                    piece.tearing.opened[:] = wanted[start : start + len(piece.rest)]
                    start += len(piece.rest)
            self.scene = self.scene.laid()
            self.engine = Cloth(self.scene.setup)
        self.engine.restore(found["engine"].tobytes())

    def rested(self, state: bytes) -> bytes:
        """A state with the vertices where they are, at rest."""
        found = from_bytes(state, ("opened", "engine"))
        held = from_bytes(found["engine"].tobytes(), ("x", "v"))
        still = to_bytes({**held, "v": np.zeros_like(held["v"])})
        return to_bytes({**found, "engine": np.frombuffer(still, dtype=np.uint8)})

    def end_of_settling(self) -> bytes:
        """The present state; EngineError where a sheet tore."""
        if self._opened().any():
            raise EngineError(
                f"a sheet of {self.name!r} tore while it settled; place it nearer to where it rests, or leave it out of simulation.settle"
            )
        return super().end_of_settling()

    def _opened(self) -> NDArray[np.uint8]:
        """Which sides are open, of all parts that can tear."""
        found = [p.tearing.opened for p in self.scene.pieces if p.tearing is not None]
        return np.concatenate(found).astype(np.uint8) if found else np.empty(0, dtype=np.uint8)

    # ------------------------------------------------------------------ output

    def coordinates(self) -> tuple[F64, F64]:
        """Positions [m] and velocities [m/s] of the vertices, shape (n, 3) each."""
        return self.engine.vertices()

    def measured(self) -> dict[str, Any]:
        """Channels and records of the frame that ends."""
        x, v = self.engine.vertices()
        setup, tally, mass = self.scene.setup, self._tally, self.engine.mass
        place, weld = np.cumsum([0, *(len(s.mass) for s in setup.sheets)]), self.scene.weld
        own = [x[a:b] for a, b in pairwise(place)]
        ratios = np.concatenate([edge_ratios(s, p) for s, p in zip(setup.sheets, own, strict=True)])
        moved = motion_records(mass, x, v, setup.gravity)
        records = {
            **moved,
            "stretch_energy": sum(membrane_energy(s, p) for s, p in zip(setup.sheets, own, strict=True)),
            "bending_energy": sum(bending_energy(s, p) for s, p in zip(setup.sheets, own, strict=True)),
            "max_speed": max(tally["fastest"], moved["max_speed"]),
            "stretch_max": float(ratios.max()) - 1.0,
            "stretch_min": float(ratios.min()) - 1.0,
            "steps": tally["steps"],
            "exchanges": tally["exchanges"],
            "step": tally["time"] / max(tally["steps"], 1),
            "contacts_max": tally["contacts"],
            "cut_vertices": tally["cut"],
        }
        for name in SUMS:
            given = self._ledger[name]
            records |= {f"{name}_impulse_{axis}": given[k] for k, axis in enumerate("xyz")}
            if name != "cut":
                records[f"{name}_work"] = given[3]
        if self._tears:
            records["torn_length"] = torn_length(self.scene.pieces)
        return {
            "vertex/position": x[weld],
            "vertex/velocity": v[weld].astype(np.float32),
            "exchange/impulse": tally["impulse"].copy(),
            **(tear_channels(self.scene.pieces, tally["tears"]) if self._tears else {}),
            **{f"record/{name}": np.float64(value) for name, value in records.items()},
        }

    def index(self) -> CacheIndex:
        """Names behind the channels' rows."""
        return replace(super().index(), deformables=self.scene.deformables, vertices=self.scene.counts)
