"""Steam where hot matter meets water: it is what the contacts boil, of heat that the hot matter loses, and little of the water (R100)."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ....physics.boiling import BOILING, steam_heat
from ....worlds.arrays import F64
from ....worlds.categories.gas.steam_facts import steams_of, water_temperature
from ....worlds.errors import EvidenceError
from ...rows.findings import Finding
from .bounds import BOILED, BOOKS, EMITTED
from .questions import STEAM
from .rows import kept_within, recomputed

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...rows.questions import Question
    from .boils import Boils
    from .cells import GasFrame
    from .frames import GasBox

__all__ = ["Steaming"]

TINY = 1e-12


class Steaming:
    """Steam, hot matter and water over all frames."""

    questions: ClassVar[Mapping[str, Question]] = STEAM

    def __init__(self, box: GasBox) -> None:
        self.box = box

    def see(self, now: GasFrame, before: GasFrame | None) -> None:
        """Nothing: what boils is worked out from other caches."""

    def findings(self) -> dict[str, Finding]:
        """Findings on the four questions by name."""
        boils = self.box.boils
        if boils is None:
            return {name: Finding("not_applicable", "no driver makes steam in its box") for name in STEAM}
        return {
            "boiled": self._boiled(boils),
            "quenched": self._quenched(boils),
            "above": self._above(boils),
            "kept": self._kept(boils),
        }

    def _recorded(self, boils: Boils, name: str) -> F64:
        """A channel of hot entities, shape (frames, hot).

        Raises:
            EvidenceError: it has another shape, or is not finite.
        """
        found = np.asarray(self.box.cache.series(name), dtype=np.float64)[: self.box.frames]
        if found.shape != boils.area.shape or not np.isfinite(found).all():
            raise EvidenceError(f"{name} of {self.box.solver!r} has shape {found.shape}, planned {boils.area.shape}; bake again")
        return found

    def _boiled(self, boils: Boils) -> Finding:
        """Recorded areas, heat and mass against those of the contacts."""
        held = {
            "area": (self._recorded(boils, "steam_area"), boils.area, "m^2"),
            "heat": (self._recorded(boils, "steam_given"), boils.given, "J"),
            "steam": (self.box.record("steam_mass")[:, None], boils.mass[:, None], "kg"),
        }
        off = {
            n: np.abs(r - o).max(axis=1) / max(float(np.abs(o).max()), float(np.abs(r).max()), TINY)
            for n, (r, o, _) in held.items()
        }
        worst = max(off, key=lambda n: float(off[n].max()))

        def told(frame: int | None) -> str:
            recorded, own, unit = held[worst]
            if frame is None:
                return (
                    f"{boils.mass[-1]:.4g} kg of water became steam by {boils.given[-1].sum():.4g} J of heat through at most {boils.area.sum(axis=1).max():.3g} m^2, "
                    f"as recorded"
                )
            return f"{recorded[frame].sum():.4g} {unit} of {worst} are recorded at frame {frame}, contacts of hot matter with water give {own[frame].sum():.4g} {unit}"

        evidence = {"steam_kg": float(boils.mass[-1]), "heat_J": float(boils.given[-1].sum()), "area_m2": float(boils.area.max())}
        return kept_within(off[worst], EMITTED, "1", told, recomputed(self.box), evidence)

    def _quenched(self, boils: Boils) -> Finding:
        """Heat that hot matter lost by its recorded temperature, against what it is recorded to have given and what the steam holds."""
        hot = boils.hot
        temperature, given = self._recorded(boils, "steam_temperature"), self._recorded(boils, "steam_given")
        first, capacity = np.array([h.temperature for h in hot]), boils.body * np.array([h.heat_capacity for h in hot])
        lost = np.where(capacity > 0.0, capacity * (first - temperature), 0.0)
        spec = self.box.candidate.spec
        drivers = steams_of(spec, self.box.solver)
        costs = np.array([steam_heat(water_temperature(spec, drivers[h.driver])) for h in hot])
        held = self.box.record("steam_mass")
        scale = max(float(given.sum(axis=1).max()), BOOKS * float((capacity * (first - BOILING)).sum(axis=1).max()), TINY)
        rounding = 1e-9 * float((capacity * first).sum(axis=1).max())
        apart = np.maximum(np.abs(lost - given).max(axis=1) - rounding, 0.0)
        mixed = np.abs(held * costs.max() - given.sum(axis=1)) if np.ptp(costs) == 0.0 else np.zeros(len(held))
        beyond = np.maximum(given - capacity * (first - BOILING), 0.0).max(axis=1) + capacity.max() * np.maximum(
            BOILING - temperature, 0.0
        ).max(axis=1)
        off = np.maximum(np.maximum(apart, mixed), beyond) / scale

        def told(frame: int | None) -> str:
            k = -1 if frame is None else frame
            at = "by the last frame" if frame is None else f"by frame {frame}"
            hottest = ", ".join(f"{h.entity} {t:.4g} K" for h, t in zip(hot, temperature[k], strict=True))
            return f"hot matter lost {lost[k].sum():.4g} J {at} ({hottest}) and is told to have given {given[k].sum():.4g} J; {held[k]:.4g} kg of steam hold {held[k] * costs.mean():.4g} J"

        return kept_within(off, BOOKS, "1", told, recomputed(self.box))

    def _above(self, boils: Boils) -> Finding:
        """Share of the steam that would come outside of the box."""
        box = self.box
        corner = box.read(0).corner
        out = np.zeros(box.frames)
        for puff in boils.puffs:
            if (puff.point < corner).any() or (puff.point > corner + box.size).any():
                out[round(puff.end / box.duration)] += puff.volume
        whole = max(float(sum(p.volume for p in boils.puffs)), TINY)
        off = np.cumsum(out) / whole

        def told(frame: int | None) -> str:
            if frame is None:
                return f"{off[-1]:.2g} of the steam comes outside the box"
            return f"{off[frame]:.2g} of the steam comes outside the box by frame {frame}: its cells there are elsewhere; widen the domain"

        return kept_within(off, EMITTED, "1", told)

    def _kept(self, boils: Boils) -> Finding:
        """Share of the water that boils off, which its liquid keeps."""
        share = self.box.record("steam_mass") / max(boils.water, TINY)

        def told(frame: int | None) -> str:
            k = -1 if frame is None else frame
            return f"{self.box.record('steam_mass')[k]:.4g} kg of {boils.water:.4g} kg of water boiled off, {share[k]:.2g} of it, which the liquid keeps"

        return kept_within(share, BOILED, "1", told, evidence={"share": float(share[-1]), "water_kg": boils.water})
