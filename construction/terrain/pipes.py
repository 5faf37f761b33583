"""Rain that runs off over the land and wears it: virtual pipes with friction, with ledgers of water and matter.

Water goes through pipes between neighbouring cells, driven by the difference of their levels (Mei, Decaudin & Hu 2007,
doi:10.1109/PG.2007.15). A pipe is as deep as its water and brakes by Manning's law, as in the local inertial form of the shallow
water equations (Bates, Horritt & Fewtrell 2010, doi:10.1016/j.jhydrol.2010.03.027). Load goes with the water over the faces, so
that nothing is lost. What a flow can carry grows with speed times slope (unit stream power, Yang 1972).
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...geometry.launch import chosen_device, launch, load, warp
from ...worlds.arrays import F64
from ...worlds.errors import InputError, LimitError
from .erosion import Ground, MassBalance

__all__ = ["Rain", "RainRecord", "run_off"]

COURANT = 0.4
"""Part of a cell that waves may pass in a step; the scheme is stable below 0.7 (Bates et al. 2010)."""
LOOK = 4
"""Steps between two looks at the fastest wave."""
SLOWEST = 1.5
"""Least speed of waves that steps are chosen for [m/s]: that of a depth of a quarter of a metre."""
ROCK_SHARE = 0.1
"""Factor by which rock wears slower than loose ground. Own choice."""
SLICE = 32768
"""Cells of one slice on the CPU."""
USUAL = 6.0
"""Speed of the fastest wave of a storm, for the estimate [m/s]; measured 4 to 8 on the landforms of the skill."""
MOST_WORK = 4e9
"""Cells times steps on the CPU: about six minutes on two cores (190 ns each on one)."""
GRAVITY = 9.81


@dataclass(frozen=True)
class Rain:
    """An event of rain and what it does to the ground."""

    rate: float = 2.8e-5
    """[m/s]"""
    duration: float = 1800.0
    """[s]"""
    capacity: float = 5.0
    """Load over water, by volume, that a flow of 1 m/s carries down a vertical: concentration over speed times sine [s/m]."""
    dissolving: float = 0.02
    """Part of the free capacity that is taken up from loose ground per second [1/s]."""
    settling: float = 0.02
    """Part of the load above capacity that settles per second [1/s]."""
    evaporation: float = 0.0
    """[m/s]"""
    roughness: float = 0.05
    """Manning's n [s/m^(1/3)]."""


@dataclass(frozen=True)
class RainRecord:
    """Water, load and volumes of a storm. Fields of shape (rows, cols), volumes in m^3."""

    depth: F64
    """Water at the end [m]."""
    speed: F64
    """Its speed [m/s]."""
    flow: F64
    """Flow per width at the end [m^2/s]."""
    rained: float
    evaporated: float
    left: float
    """Over the edge and into the sea."""
    stored: float
    """On the land at the end, less what was there before."""
    steps: int
    seconds: float
    """Wall time."""
    device: str

    @property
    def water_residual(self) -> float:
        """Water that is missing, relative to the rain and what was there."""
        return abs(self.rained - self.evaporated - self.left - self.stored) / max(self.rained, abs(self.stored), 1e-12)


def run_off(
    ground: Ground,
    rain: Rain,
    *,
    sea: np.ndarray | None = None,
    sea_level: float = 0.0,
    valid: np.ndarray | None = None,
    depth: F64 | None = None,
    device: str | None = None,
    say: Callable[[float], None] = lambda done: None,
) -> tuple[Ground, MassBalance, RainRecord]:
    """Let rain fall, run off, take up ground and lay it down.

    Args:
        ground: the land.
        rain: how much, for how long, how strong its work.
        sea: cells that take all water and load; their water stands at `sea_level`.
        sea_level: [m]
        valid: where there is land; water leaves over its edge.
        depth: water at the start [m]; default none.
        device: of `geometry.launch`.
        say: hears the part done.

    Raises:
        InputError: a number is out of range.
        LimitError: the estimate of the work exceeds what a CPU does in some minutes.
    """
    rates = rain.rate, rain.capacity, rain.dissolving, rain.settling, rain.evaporation
    if min(rain.duration, rain.roughness) <= 0 or min(rates) < 0:
        raise InputError(f"{rain}: duration and roughness must be > 0, all others >= 0")
    where = chosen_device(device)
    start = time.perf_counter()
    expected = rain.duration * USUAL / (COURANT * ground.grid.cell)
    work = expected * ground.bedrock.size
    if where == "cpu" and work > MOST_WORK:
        raise LimitError(
            f"about {expected:,.0f} steps over {ground.bedrock.size:,} cells is {work:.1e} cell steps, cap {MOST_WORK:.0e} on a CPU; "
            f"shorten the duration {rain.duration:g} s, take a coarser cell, or a GPU (WORLDAGENT_DEVICE=cuda)"
        )
    run = _Run(ground, rain, sea, sea_level, valid, depth, where)
    steps = run.to_end(say)
    return run.ended(steps, time.perf_counter() - start)


class _Run:
    """Arrays on the device and the steps over them."""

    def __init__(
        self,
        ground: Ground,
        rain: Rain,
        sea: np.ndarray | None,
        sea_level: float,
        valid: np.ndarray | None,
        depth: F64 | None,
        device: str,
    ) -> None:
        from . import pipe_kernels as kernels

        wp = warp()
        self.kernels, self.ground, self.rain, self.device = kernels, ground, rain, device
        rows, cols = ground.grid.shape
        known = np.ones((rows, cols), dtype=bool) if valid is None else valid
        self.sink = ~known if sea is None else sea | ~known
        standing = np.where(known, np.maximum(sea_level - ground.height, 0.0), 0.0)
        self.before = np.where(self.sink, standing, 0.0 if depth is None else depth)
        load(kernels.push, device)

        def put(values: Any) -> Any:
            return wp.array(np.ascontiguousarray(values, dtype=np.float64).reshape(-1), dtype=wp.float64, device=device)

        def none(count: int = rows * cols) -> Any:
            return wp.zeros(count, dtype=wp.float64, device=device)

        faces = (rows + 1) * (cols + 1)
        self.land = kernels.Land()
        self.land.rows, self.land.cols, self.land.cell, self.land.friction = rows, cols, ground.grid.cell, rain.roughness
        self.land.sink = wp.array(self.sink.reshape(-1).astype(np.uint8), dtype=wp.uint8, device=device)
        self.rock, self.soil, self.top = put(ground.bedrock), put(ground.sediment), [put(ground.height), none()]
        self.depth, self.load = [put(self.before), none()], [none(), none()]
        self.east, self.north = [none(faces), none(faces)], [none(faces), none(faces)]
        self.share, self.speed, self.wear, self.laid = none(), none(), none(), none()
        self.water_out, self.load_out, self.evaporated = none(), none(), none()
        self.waves = none(-(-rows * cols // kernels.BLOCK))
        self.rained = 0.0

    def to_end(self, say: Callable[[float], None]) -> int:
        """Step until the rain is over; returns the steps."""
        passed, steps, step = 0.0, 0, 0.0
        while passed < self.rain.duration * (1 - 1e-12):
            if steps % LOOK == 0:
                self._do(self.kernels.quickest, len(self.waves), self.depth[0], self.speed, self.waves)
                # On dry land water gathers before the next look.
                fastest = max(float(self.waves.numpy().max()), SLOWEST)
                step = COURANT * self.ground.grid.cell / fastest
                say(passed / self.rain.duration)
            self.once(min(step, self.rain.duration - passed))
            passed, steps = passed + step, steps + 1
        return steps

    def once(self, step: float) -> None:
        """One step of `step` seconds."""
        rain, land, cells = self.rain, self.land, self.sink.size
        land.step = step
        water = rain.rate * step
        self.rained += water
        self._do(
            self.kernels.push,
            (land.rows + 1) * (land.cols + 1),
            self.top[0],
            self.depth[0],
            self.east[0],
            self.north[0],
            self.east[1],
            self.north[1],
        )
        self.east.reverse()
        self.north.reverse()
        self._do(self.kernels.limit, cells, self.depth[0], self.east[0], self.north[0], self.share)
        self._do(
            self.kernels.carry, cells, water, rain.evaporation * step, self.depth[0], self.load[0], self.east[0], self.north[0],
            self.share, self.depth[1], self.load[1], self.speed, self.water_out, self.load_out, self.evaporated,
        )  # fmt: skip
        self.depth.reverse()
        self.load.reverse()
        up, down = (1.0 - float(np.exp(-rate * step)) for rate in (rain.dissolving, rain.settling))
        self._do(
            self.kernels.scour, cells, rain.capacity, up, up * ROCK_SHARE, down, self.top[0], self.depth[0], self.speed,
            self.load[0], self.rock, self.soil, self.wear, self.laid, self.top[1],
        )  # fmt: skip
        self.top.reverse()

    def ended(self, steps: int, seconds: float) -> tuple[Ground, MassBalance, RainRecord]:
        """The land, its ledger and the record; what still floats settles where it is."""
        afloat, wear, laid, gone = (self._back(a) for a in (self.load[0], self.wear, self.laid, self.load_out))
        depth, speed, area = self._back(self.depth[0]), self._back(self.speed), self.ground.grid.cell_area
        land = replace(
            self.ground,
            bedrock=self._back(self.rock),
            sediment=self._back(self.soil) + afloat,
            wear=self.ground.wear + wear,
            deposit=self.ground.deposit + laid + afloat,
        )
        balance = MassBalance(float(wear.sum()), float(laid.sum() + afloat.sum()), float(gone.sum())).times(area)
        on_land = np.where(self.sink, 0.0, depth)
        return (
            land,
            balance,
            RainRecord(
                depth=on_land,
                speed=speed,
                flow=on_land * speed,
                rained=self.rained * float((~self.sink).sum()) * area,
                evaporated=float(self._back(self.evaporated).sum()) * area,
                left=float(self._back(self.water_out).sum()) * area,
                stored=float((on_land - np.where(self.sink, 0.0, self.before)).sum()) * area,
                steps=steps,
                seconds=seconds,
                device=self.device,
            ),
        )

    def _back(self, values: Any) -> F64:
        return np.array(values.numpy(), dtype=np.float64).reshape(self.ground.grid.shape)

    def _do(self, kernel: Any, count: int, *inputs: Any) -> None:
        launch(kernel, count, [self.land, *inputs], device=self.device, slice_size=SLICE)
