"""Fire: what burnt is what came, its heat is that of its fuel, and flames are where something lights or keeps them (R100, R106).

The contents are summed here from the cells. Flames of a frame are those of its last step, which the velocities of the frame belong to: where
they were, what was burnt stands within a few cells of them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ....physics.combustion import greatest_power, soot_power
from ....worlds.arrays import F64
from ....worlds.categories.gas.facts import ignitions_of, lit
from ...rows.findings import Finding
from .books import declared
from .bounds import BOOKS, BURNT, FLAMES, RADIATED, RELEASED, SEEP
from .cells import most_near
from .questions import FIRES
from .reach import reach_of, within_reach
from .rows import kept_within, recomputed

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...rows.questions import Question
    from .cells import FireCells, GasFrame, Mask
    from .combustion import Combustion
    from .frames import GasBox

__all__ = ["Fires"]

TINY = 1e-12
FADED = 1e-6
"""Own choice: of the greatest power of a cell, below which nothing burns."""
NEAR = 5
"""Own choice: cells across of the neighbourhood of a flame: its gas goes two cells at most in the step."""
SLACK = 2.0
"""Own choice: times as much as at the end of the step may soot radiate in it: gas that burns swells by half at most, mixes and cools."""
KEPT = 0.8
"""Own choice: of the excess over the ambient temperature from which on fuel burns, what gas that burnt has at the end of the step at least."""

POWERS = ("flames", "lit")
"""Questions about shares of all power."""


class Fires:
    """Fire of every frame."""

    questions: ClassVar[Mapping[str, Question]] = FIRES

    def __init__(self, box: GasBox) -> None:
        self.box = box
        self.ignitions = ignitions_of(box.candidate.spec, box.solver)
        self.sums: list[tuple[float, float, float]] = []
        """Fuel and fuel burnt or not in the box [kg], greatest power of a cell [W/m^3]."""
        self.power: list[tuple[float, float]] = []
        """Released and radiated [W]."""
        self.off: dict[str, list[float]] = {name: [] for name in ("flames", "lit", "oxygen", "radiated")}
        self.most = TINY
        """Most that a cell radiates, or should [W/m^3]."""
        self.where: dict[tuple[str, int], list[float]] = {}

    def see(self, now: GasFrame, before: GasFrame | None) -> None:
        """Look at one frame."""
        box = self.box
        if box.combustion is None or now.fire is None:
            return
        fire, room = now.fire, now.room.astype(np.float64) * box.volume
        atoms = box.tracer(now)
        self.sums.append((float((fire.fuel * room).sum()), float((atoms * room).sum()), float(fire.released.max())))
        self.power.append((float((fire.released * room).sum()), float((fire.radiated * room).sum())))
        self._keep("flames", now, self._strange(now, fire, box.combustion))
        self._keep("lit", now, self._unlit(now, before, fire, box.combustion))
        self._keep("oxygen", now, self._airless(now, fire))
        self._keep("radiated", now, self._dark(now, fire, box.combustion))

    def _keep(self, name: str, now: GasFrame, cells: F64) -> None:
        """The worst cell, or the sum of powers."""
        self.off[name].append(float(cells.sum() if name in POWERS else cells.max(initial=0.0)))
        if self.off[name][-1] > 0.0:
            self.where[name, now.index] = now.place(np.unravel_index(int(cells.argmax()), cells.shape))

    def _burning(self, fire: FireCells) -> F64:
        """Power of each cell [W]; 0 where nothing burns."""
        power = fire.released.astype(np.float64)
        return power * self.box.volume * (power > FADED * greatest_power(self.box.cell))

    def _strange(self, now: GasFrame, fire: FireCells, combustion: Combustion) -> F64:
        """Power of cells without fuel or heat about them, or beyond what a flame gives."""
        least = combustion.ambient + KEPT * (combustion.fuel.ignition - combustion.ambient)
        hot = (now.temperature >= least) & now.open | self._sparks(now, now)
        about = most_near(hot & now.open, NEAR // 2) & most_near(self.box.tracer(now) > 0.0, NEAR // 2)
        fierce = fire.released > (1.0 + 1e-3) * greatest_power(self.box.cell)
        return np.where(~about | fierce | ~now.open, self._burning(fire), 0.0)

    def _unlit(self, now: GasFrame, before: GasFrame | None, fire: FireCells, combustion: Combustion) -> F64:
        """Power of cells that neither a spark nor gas that was hot enough a frame ago reaches."""
        if before is None or not fire.released.any():
            return np.zeros(self.box.shape)
        box = self.box
        way, walls = reach_of(box, now, before)
        hot = (before.temperature >= combustion.fuel.ignition) & before.open | self._sparks(before, now)
        if combustion.temperature >= combustion.fuel.ignition:
            hot |= np.any([s.cells(now, box.cell, box.duration) for s in box.sources], axis=0)
        reached = within_reach(hot.astype(np.float64), way, walls, (0.0,) * 6) > 0.0
        return np.where(reached, 0.0, self._burning(fire))

    def _sparks(self, before: GasFrame, now: GasFrame) -> Mask:
        """Cells that an ignition lights at some time between two frames."""
        start, end = (self.box.duration * f.index for f in (before, now))
        found = np.zeros(self.box.shape, dtype=bool)
        for driver in self.ignitions.values():
            if driver.start <= end and (driver.end is None or start < driver.end + self.box.duration * (before is now)):
                found |= lit(driver, now.centers)
        return found

    def _airless(self, now: GasFrame, fire: FireCells) -> F64:
        """Fuel and products beyond the gas that there is, or below none, as a share of it."""
        density = self.box.density(now)
        over = (fire.fuel + fire.product) / density - 1.0
        under = np.maximum(-fire.fuel, -fire.product) / density
        return np.where(now.open, np.maximum(over, under), 0.0)

    def _dark(self, now: GasFrame, fire: FireCells, combustion: Combustion) -> F64:
        """Power that is radiated beyond what flames and soot give, or short of what flames do [W/m^3]."""
        flames = combustion.fuel.radiant * fire.released.astype(np.float64)
        soot = soot_power(now.soot.astype(np.float64), now.temperature.astype(np.float64)) * now.open
        most = np.maximum(flames, SLACK * most_near(soot, NEAR // 2))
        wrong = np.maximum(fire.radiated - most, flames - fire.radiated)
        self.most = max(self.most, float(fire.radiated.max()), float(flames.max()))
        return np.asarray(wrong)

    def findings(self) -> dict[str, Finding]:
        """Findings on the seven questions by name."""
        if self.box.combustion is None:
            return {name: Finding("not_applicable", "it has no fuel") for name in FIRES}
        given = declared(self.box)["tracer"]
        return {
            "fuel": self._fuel(given),
            "burnt": self._burnt(self.box.combustion, given),
            "released": self._released(),
            "flames": self._cells("flames", FLAMES, "of the heat is released where nothing can burn, or beyond what a flame gives"),
            "lit": self._cells("lit", FLAMES, "of the heat is released where neither a spark nor hot gas comes"),
            "oxygen": self._cells("oxygen", SEEP, "more fuel and products than gas are in a cell, or less than none"),
            "radiated": self._cells("radiated", RADIATED, "of the greatest power is radiated by nothing, or kept that flames radiate"),
        }  # fmt: skip

    def _fuel(self, given: F64) -> Finding:
        box, inside = self.box, np.array([s[1] for s in self.sums])
        left = box.escaped_tracer()
        off = np.abs(inside[0] + given - left + left[0] - inside) / max(float(given.max()), inside[0], TINY)

        def told(frame: int | None) -> str:
            k = -1 if frame is None else frame
            at = "by the last frame" if frame is None else f"by frame {frame}"
            return f"{given[k]:.4g} kg of fuel came {at}, {left[k]:.4g} left, burnt or not, {inside[k]:.4g} are there"

        return kept_within(off, BOOKS, "1", told, recomputed(box))

    def _burnt(self, combustion: Combustion, given: F64) -> Finding:
        """Heat and soot of what is neither there nor gone."""
        box, fuel = self.box, combustion.fuel
        inside, left = np.array([s[0] for s in self.sums]), box.record("escaped_fuel")
        burnt = inside[0] + given - (left - left[0]) - inside
        scale = max(float(given.max()), inside[0], TINY)
        heat, soot = (box.record(n) - box.record(n)[0] for n in ("released_heat", "made_soot"))
        off = np.maximum(np.abs(heat / fuel.heat - burnt), np.abs(soot - fuel.soot * burnt)) / scale
        off = np.maximum(off, np.abs(box.record("burnt_fuel") - box.record("burnt_fuel")[0] - burnt) / scale)

        def told(frame: int | None) -> str:
            k = -1 if frame is None else frame
            at = "by the last frame" if frame is None else f"by frame {frame}"
            return (
                f"{heat[k]:.5g} J were released {at}, {fuel.name} that is neither there nor gone has {burnt[k] * fuel.heat:.5g} J; "
                f"{soot[k]:.3g} kg of soot were made, it makes {burnt[k] * fuel.soot:.3g} kg"
            )

        evidence = {"released_J": float(heat[-1]), "burnt_kg": float(burnt[-1]), "share_burnt": float(burnt[-1] / scale)}
        return kept_within(off, BURNT, "1", told, recomputed(box), evidence)

    def _released(self) -> Finding:
        """Recorded sums against the power of the frames, beyond what these leave open between them."""
        box, step = self.box, self.box.duration
        power = np.array(self.power)
        light = box.record("lost_heat") - (0.0 if box.surfaces is None else box.record("taken_heat"))
        records = np.stack([box.record("released_heat"), light], axis=1)
        scale = max(float(records.max()), TINY)
        mean = np.concatenate([np.zeros((1, 2)), np.cumsum(0.5 * step * (power[1:] + power[:-1]), axis=0)])
        loose = np.concatenate([np.zeros((1, 2)), np.cumsum(0.5 * step * np.abs(np.diff(power, axis=0)), axis=0)])
        off = (np.maximum(np.abs(records - records[0] - mean) - loose, 0.0) / scale).max(axis=1)

        def told(frame: int | None) -> str:
            k = -1 if frame is None else frame
            (heat, lost), (own, light), (doubt, other) = records[k] - records[0], mean[k], loose[k]
            return (
                f"{heat:.4g} J released and {lost:.4g} J radiated are recorded by frame {k % box.frames}; the flames of the frames give "
                f"{own:.4g} +- {doubt:.2g} and {light:.4g} +- {other:.2g}"
            )

        return kept_within(off, RELEASED, "1", told, recomputed(box))

    def _cells(self, name: str, bound: float, words: str) -> Finding:
        off = np.array(self.off[name])
        if name in POWERS:
            off = off / max(float(np.array(self.power)[:, 0].max(initial=0.0)), TINY)
        elif name == "radiated":
            off = off / self.most

        def told(frame: int | None) -> str:
            if frame is None:
                return f"{off.max():.2g} {words}, at most"
            return f"{off[frame]:.3g} {words} at frame {frame}, first at {self.where[name, frame]}"

        at = {"at": self.where[name, int(np.argmax(off > bound))]} if (off > bound).any() else None
        return kept_within(off, bound, "1", told, recomputed(self.box), at)
