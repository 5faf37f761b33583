"""Declared waves against the surface where they leave the zone that makes them (R57, R58, R99).

- `waves_height`: what the surface has of the declared waves there is as high as declared, within `HEIGHT`.
- `waves_period`: and it has their period, within `PERIOD`.

The surface is the volume of particles over small windows at the inner end of each zone that waves leave inwards. Its series is
fitted with that of the declared sea (linear theory, from the declaration alone) and the same a quarter period later, the clock of
the declaration stretched until the fit is best: the stretch is the ratio of periods, the two factors give height and lag. What is
not in step with the declared waves (noise, what bodies throw back at other times) counts for nothing.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ....physics.waves import Sea, wavelength
from ....worlds.arrays import F64
from ....worlds.errors import EvidenceError
from ....worlds.waves import developed, heading, inward, sea_of, waves_of
from ...rows.corrections import bake_again
from ...rows.findings import Finding
from .bounds import ENTERS, FLAT, HEIGHT, LEAST_WATER, PERIOD, PERIODS
from .corrections import lower_waves, refine
from .questions import WAVES
from .rows import place

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ....worlds.requirements import Correction, Status
    from ....worlds.spec import WavesDriver
    from ...rows.questions import Question
    from .frames import Liquid, Step

__all__ = ["Waves"]

WIDE = 1 / 12
"""Wavelengths across a window, at least two spacings."""
MOST = 12
"""Windows along one zone."""
STRETCHES = np.exp(np.linspace(np.log(0.5), np.log(2.0), 141))


class Waves:
    """Height of the surface over windows at the inner end of zones, frame by frame."""

    questions: ClassVar[Mapping[str, Question]] = WAVES

    def __init__(self, liquid: Liquid) -> None:
        self.liquid = liquid
        self.drivers = waves_of(liquid.candidate.spec, liquid.solver)
        self.windows = {name: _windows(liquid, driver) for name, driver in self.drivers.items()}
        self.heights: dict[str, list[F64]] = {name: [] for name in self.drivers}

    def see(self, step: Step) -> None:
        """Measure one frame: every particle is a cube of its volume, of which a share lies in a window."""
        edge = self.liquid.pitch
        for name, (centers, half) in self.windows.items():
            near = []
            for center in centers:
                inside = (half + 0.5 * edge - np.abs(step.now.position[:, :2] - center)) / edge
                near.append(float(step.now.volume @ inside.clip(0.0, 1.0).prod(axis=1)))
            self.heights[name].append(np.array(near) / (4.0 * half[0] * half[1]))

    def findings(self) -> dict[str, Finding]:
        """Height and period of the sea."""
        if not self.drivers:
            return {name: Finding("not_applicable", "the plan has no waves") for name in self.questions}
        name, driver = next(iter(self.drivers.items()))
        liquid = self.liquid
        gravity = liquid.strength
        sea = sea_of(driver, gravity, liquid.spacing)
        time: F64 = np.arange(len(self.heights[name]), dtype=np.float64) * np.float64(liquid.duration)
        used = time >= developed(driver, gravity)
        if float(used.sum()) * liquid.duration < PERIODS * driver.period:
            text = f"the last frame is at {time[-1] if len(time) else 0.0:.3g} s, {PERIODS:g} periods of full waves {name!r} have not passed then"
            if liquid.candidate.stage == "full":
                raise EvidenceError(text)
            return {question: Finding("not_applicable", f"{text}: judged on the bake") for question in self.questions}
        centers, _ = self.windows[name]
        measured = np.array(self.heights[name])[used]
        full = measured.mean(axis=0) / driver.depth
        if not (full > LEAST_WATER).any():
            raise EvidenceError(f"there is no water where waves {name!r} leave their zone; declare level and depth as they are")
        wet = np.flatnonzero(full > LEAST_WATER)
        centers = centers[wet]
        fits = [_fit(sea, centers[k], time[used], measured[:, w] / full[w]) for k, w in enumerate(wet)]
        gain, stretch, share = (float(np.median([f[k] for f in fits])) for k in range(3))
        evidence = {
            "driver": name,
            "declared_height_m": driver.height,
            "measured_height_m": gain * driver.height,
            "declared_period_s": driver.period,
            "measured_period_s": stretch * driver.period,
            "share_of_variance": share,
            "windows": [place(np.array([*c, driver.level])) for c in centers],
            "gain_by_window": [round(f[0], 4) for f in fits],
        }
        return {
            "waves_height": self._height(name, driver, gain, evidence),
            "waves_period": self._period(name, driver, stretch, gain, evidence),
        }

    def _height(self, name: str, driver: WavesDriver, gain: float, evidence: dict[str, object]) -> Finding:
        error = abs(gain - 1.0)
        text = (
            f"waves {name!r} are {gain * driver.height:.3g} m high where they leave their zone, declared are {driver.height:g} m: "
            f"{error:.0%} off, allowed {HEIGHT:.0%}"
        )
        hints = (*_flat(gain), refine(self.liquid, "waves die away where they are coarsely resolved"), lower_waves(name, driver))
        status: Status = "pass" if error <= HEIGHT else "fail"
        frame = None if status == "pass" else self._first(driver)
        return Finding(status, text, error, HEIGHT, "1", None, frame, hints if status == "fail" else (), evidence)

    def _period(self, name: str, driver: WavesDriver, stretch: float, gain: float, evidence: dict[str, object]) -> Finding:
        error = abs(stretch - 1.0)
        text = (
            f"waves {name!r} have a period of {stretch * driver.period:.3g} s where they leave their zone, declared are "
            f"{driver.period:g} s: {error:.1%} off, allowed {PERIOD:.0%}"
        )
        status: Status = "pass" if error <= PERIOD else "fail"
        frame = None if status == "pass" else self._first(driver)
        hints = (*_flat(gain), bake_again())
        return Finding(status, text, error, PERIOD, "1", None, frame, hints if status == "fail" else (), evidence)

    def _first(self, driver: WavesDriver) -> int:
        return min(int(np.ceil(developed(driver, self.liquid.strength) / self.liquid.duration)), self.liquid.frames - 1)


def _flat(gain: float) -> tuple[Correction, ...]:
    return (bake_again("the surface stays flat: the cache is of a run without these waves"),) if gain < FLAT else ()


def _windows(liquid: Liquid, driver: WavesDriver) -> tuple[F64, F64]:
    """Centres (k, 2) of windows at the inner end of zones that waves leave inwards, and their half sizes (2,) [m]."""
    sides = [s for s in driver.generate if float(heading(driver) @ inward(s)) > ENTERS]
    if not sides:
        raise EvidenceError(
            f"waves of {liquid.solver!r} enter the domain from no side; turn direction or generate on another one"
        )
    length = wavelength(driver.period, driver.depth, liquid.strength)
    half = 0.5 * max(WIDE * length, 2.0 * liquid.spacing)
    zones = [*driver.generate, *driver.absorb]
    low, high = (
        np.array([edge[a] + sign * driver.zone * (f"{'-' if sign > 0 else '+'}{'xy'[a]}" in zones) for a in range(2)])
        for edge, sign in ((liquid.lower, 1.0), (liquid.upper, -1.0))
    )
    found = []
    for side in sides:
        axis = "xy".index(side[1])
        other = 1 - axis
        count = int(np.clip((high[other] - low[other]) // (2.0 * half), 1, MOST))
        across = low[other] + (np.arange(count) + 0.5) * (high[other] - low[other]) / count
        along = low[axis] + half if side[0] == "-" else high[axis] - half
        found += [[along, a] if axis == 0 else [a, along] for a in across]
    halves = np.array([half, half])
    return np.array(found), np.minimum(halves, 0.5 * (high - low))


def _fit(sea: Sea, center: F64, time: F64, series: F64) -> tuple[float, float, float]:
    """Height over the declared one, period over the declared one, share of variance that is explained."""
    y = series - series.mean()
    if float(y @ y) <= 0.0:
        return 0.0, 1.0, 0.0
    middle = 0.5 * (time[0] + time[-1])
    still = replace(sea, start=-np.inf, rise=1.0)
    points = np.tile(center, (len(time), 1))

    def fit(stretch: float) -> tuple[float, float]:
        clock = middle + (time - middle) / stretch
        basis = np.stack([still.elevation(points, clock), still.elevation(points, clock, quadrature=True)], axis=1)
        basis = basis - basis.mean(axis=0)
        factors = np.linalg.lstsq(basis, y, rcond=None)[0]
        rest = y - basis @ factors
        return float(np.hypot(*factors)), 1.0 - float(rest @ rest) / float(y @ y)

    best = max(STRETCHES, key=lambda s: fit(s)[1])
    fine = best * np.exp(np.linspace(-0.01, 0.01, 21))
    best = max(fine, key=lambda s: fit(s)[1])
    gain, share = fit(best)
    return gain, float(best), share
