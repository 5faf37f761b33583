"""Solids and cloth that catch fire: what they give off is what they lose, where they are hot, by heat that gas and flames give them (R100).

What heat a surface can get is bounded from the frames alone: natural convection from the hottest gas about it at both ends of a frame, and the
light of all cells as if each piece faced them. Cloth gets that of both its sides, and none once no more than its char is left.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ....worlds.arrays import F64
from ...rows.findings import Finding
from .bounds import BOOKS, BURNT, CARRIED, FLAMES, HEATED
from .cells import most_near
from .fires import KEPT
from .questions import KINDLING
from .rows import kept_within, recomputed

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...rows.questions import Question
    from .cells import GasFrame
    from .frames import GasBox
    from .kindled import KindledSurfaces

__all__ = ["Kindling"]

TINY = 1e-12
NEAR = 5
"""Own choice: cells across of the gas about a surface: what warms it within a frame comes from there."""
LAMP = 2
"""[cells] Side of the blocks whose light is added up."""
ABSORBED = 0.95
"""Most of the light that wood, paper or char takes up (Holman 1990, table A-10)."""
CONVECTED = 1.52
"""[W/(m^2 K^(4/3))] Natural convection above a hot plate, the strongest of a still surface (Holman 1990, table 7-2)."""


class Kindling:
    """Surfaces at every frame."""

    questions: ClassVar[Mapping[str, Question]] = KINDLING

    def __init__(self, box: GasBox) -> None:
        self.box = box
        self.unlit: list[float] = [0.0]
        """Mass that cold pieces gave over each frame [kg]."""
        self.over: list[float] = [0.0]
        """Heat beyond what can have come [J]."""
        self.gained: list[float] = [0.0]
        """Heat that pieces got [J]."""
        self.astray: list[float] = []
        """Farthest that a piece is from its place on its part [cells]."""
        self.where: dict[tuple[str, int], list[float]] = {}

    def see(self, now: GasFrame, before: GasFrame | None) -> None:
        """Look at one frame."""
        surfaces = self.box.surfaces
        if surfaces is None:
            return
        off = surfaces.carried.astray(now.index) / self.box.cell
        self.astray.append(float(off.max()))
        self.where["carried_along", now.index] = [round(float(c), 3) for c in surfaces.state[now.index].point[int(off.argmax())]]
        if before is None:
            return
        old, new = surfaces.state[before.index], surfaces.state[now.index]
        ignition = surfaces.of("ignition")
        hot = np.maximum(old.temperature, new.temperature) >= self.box.ambient + KEPT * (ignition - self.box.ambient)
        cold = np.where(hot, 0.0, np.abs(surfaces.giving(now.index)))
        gain = new.heat - old.heat + surfaces.of("gasification") * (old.left - new.left)
        excess = np.maximum(gain - self._offered(surfaces, now, before), 0.0) * surfaces.area
        for name, kept, values in (("kindled", self.unlit, cold), ("heated", self.over, excess)):
            kept.append(float(values.sum()))
            if kept[-1] > 0.0:
                self.where[name, now.index] = [round(float(c), 3) for c in new.point[int(values.argmax())]]
        self.gained.append(float(np.maximum(gain, 0.0) @ surfaces.area))

    def _offered(self, surfaces: KindledSurfaces, now: GasFrame, before: GasFrame) -> F64:
        """Most heat that gas and flames can give each piece over a frame [J/m^2]."""
        box = self.box
        gas = np.maximum(*(np.where(f.open, f.temperature, 0.0) for f in (now, before)))
        gas = most_near(gas, NEAR // 2)
        old, new = surfaces.state[before.index], surfaces.state[now.index]
        # What moves goes through all the gas between its places.
        places = [np.floor((p - now.corner) / box.cell).astype(np.int64) for p in surfaces.along(now.index, box.cell)]
        inside = [((at >= 0) & (at < np.array(box.shape))).all(axis=1) for at in places]
        last = np.array(box.shape) - 1
        about = np.max(
            [np.where(i, gas[tuple(np.clip(at, 0, last).T)], 0.0) for at, i in zip(places, inside, strict=True)], axis=0
        )
        rise = np.maximum(about - np.minimum(new.temperature, old.temperature), 0.0)
        sides = np.where(surfaces.thin, 2.0, 1.0)
        offered = box.duration * (sides * CONVECTED * rise ** (4.0 / 3.0) + ABSORBED * self._light(old.point, before))
        consumed = surfaces.thin & (old.left <= 0.0)
        return np.where(np.any(inside, axis=0) & ~consumed, offered, 0.0)

    def _light(self, points: F64, frame: GasFrame) -> F64:
        """Light of all flames on pieces at points (n, 3) [m] that face them all [W/m^2]; as engines take it, that of the frame before."""
        box, found = self.box, np.zeros(len(points))
        if frame.fire is None:
            return found
        watts = frame.fire.radiated.astype(np.float64) * frame.room * box.volume
        at = np.argwhere(watts > 0.0)
        block, member = np.unique(at // LAMP, axis=0, return_inverse=True)
        power = np.bincount(member.reshape(-1), watts[tuple(at.T)], minlength=len(block))
        reach = 0.5 * np.sqrt(3.0) * LAMP * box.cell
        for place, strength in zip(frame.corner + box.cell * LAMP * (block + 0.5), power, strict=True):
            far = np.maximum(np.linalg.norm(points - place, axis=1) - reach, box.cell)
            found += strength / (4.0 * np.pi * far * far)
        return found

    def findings(self) -> dict[str, Finding]:
        """Findings on the six questions by name."""
        surfaces = self.box.surfaces
        if surfaces is None:
            return {name: Finding("not_applicable", "nothing in its box may burn") for name in KINDLING}
        lost = surfaces.lost()
        return {
            "surfaces": self._surfaces(surfaces),
            "carried_along": self._carried_along(),
            "gasified": self._gasified(surfaces, lost),
            "kindled": self._shares("kindled", self.unlit, max(float(lost[-1]), TINY), FLAMES, "was given off by surfaces that were not hot enough"),
            "stored": self._stored(surfaces),
            "heated": self._shares("heated", np.cumsum(self.over).tolist(), max(float(np.sum(self.gained)), TINY), HEATED, "of the heat of surfaces is more than gas and flames about them give"),
        }  # fmt: skip

    def _surfaces(self, surfaces: KindledSurfaces) -> Finding:
        """Area and mass of the pieces at frame 0 against the parts."""
        count = len(surfaces.parts)
        area = np.bincount(surfaces.part, surfaces.area, minlength=count)
        fuel = np.bincount(surfaces.part, surfaces.area * surfaces.state[0].left, minlength=count)
        own = np.array([(p.area, p.fuel) for p in surfaces.parts])
        off = np.abs(np.stack([area, fuel], axis=1) / np.maximum(own, TINY) - 1.0).max(axis=1)
        worst = int(off.argmax())
        part = surfaces.parts[worst]
        text = (
            f"pieces of {part.entity!r} part {part.part!r} have {area[worst]:.4g} m^2 and {fuel[worst]:.4g} kg that can become gas; the part has "
            f"{part.area:.4g} m^2 and {part.fuel:.4g} kg"
        )
        return kept_within(np.array([off[worst]]), BURNT, "1", lambda _: text, recomputed(self.box))

    def _carried_along(self) -> Finding:
        """Places of pieces against those of their parts."""
        off = np.array(self.astray)

        def told(frame: int | None) -> str:
            if frame is None:
                return f"pieces of surface stay on their parts to {off.max() * self.box.cell:.2g} m"
            return f"a piece is {off[frame] * self.box.cell:.3g} m from its place on its part at frame {frame}, at {self.where['carried_along', frame]}"

        return kept_within(off, CARRIED, "cells", told, recomputed(self.box))

    def _gasified(self, surfaces: KindledSurfaces, lost: F64) -> Finding:
        """Records of what was given off against the mass of the pieces, which only falls, to none at least."""
        box = self.box
        held = np.stack([s.left for s in surfaces.state])
        scale = max(float(lost[-1]), BOOKS * float(surfaces.state[0].left @ surfaces.area), TINY)
        grown = np.concatenate([[0.0], (np.maximum(np.diff(held, axis=0), 0.0) @ surfaces.area)])
        under = np.maximum(-held, 0.0) @ surfaces.area
        recorded = box.record("gasified_fuel") - box.record("gasified_fuel")[0]
        off = np.maximum(np.abs(recorded - lost), np.maximum(grown, under)) / scale

        def told(frame: int | None) -> str:
            k = -1 if frame is None else frame
            at = "by the last frame" if frame is None else f"by frame {frame}"
            return f"{recorded[k]:.4g} kg are recorded as given off {at}, surfaces lost {lost[k]:.4g} kg, regained {grown[k]:.2g} kg and lack {under[k]:.2g} kg"

        evidence = {
            "given_off_kg": float(lost[-1]),
            "share": float(lost[-1] / max(float(surfaces.state[0].left @ surfaces.area), TINY)),
        }
        return kept_within(off, BOOKS, "1", told, recomputed(box), evidence)

    def _stored(self, surfaces: KindledSurfaces) -> Finding:
        """Heat in surfaces and in the gas that they gave against what they took."""
        box = self.box
        inside = np.array([s.heat @ surfaces.area for s in surfaces.state])
        cost = np.array(
            [((surfaces.state[0].left - s.left) * surfaces.of("gasification")) @ surfaces.area for s in surfaces.state]
        )
        took = sum(box.record(n) - box.record(n)[0] for n in ("taken_heat", "taken_light"))
        books = [np.abs(box.record(n) - value) for n, value in (("surface_heat", inside), ("gasification_heat", cost))]
        scale = max(float(np.abs(took).max()), float(np.abs(inside).max()), TINY)
        off = np.max([np.abs(inside[0] + took - cost - inside), *books], axis=0) / scale

        def told(frame: int | None) -> str:
            k = -1 if frame is None else frame
            at = "by the last frame" if frame is None else f"by frame {frame}"
            return f"surfaces took {took[k]:.4g} J {at}; {inside[k]:.4g} J are in them, and gas took {cost[k]:.4g} J"

        return kept_within(off, BOOKS, "1", told, recomputed(box))

    def _shares(self, name: str, values: list[float], scale: float, bound: float, words: str) -> Finding:
        off = np.array(values) / scale

        def told(frame: int | None) -> str:
            if frame is None:
                return f"{off.max():.2g} {words}, at most"
            return f"{off[frame]:.3g} {words} at frame {frame}, first at {self.where.get((name, frame))}"

        return kept_within(off, bound, "1", told, recomputed(self.box))
