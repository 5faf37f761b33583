"""Density of particles by the judge's own count, beside what the engine says of it (R57, R99).

- `density`: particles fill no more space than there is: mean compression by an own sum over the neighbours of some, and the recorded one.
- `recorded_density`: what is recorded per particle is what its neighbours give.
- `divergence`: velocities of neighbours agree: the liquid does not boil.
Walls are not counted, so liquid at a wall looks thinner than it is and is not judged: only crowding is.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from ....geometry.launch import launch, warp
from ....worlds.arrays import F64
from ...rows.corrections import bake_again, double_iterations, halve_step
from ...rows.findings import Finding
from .bounds import BOILING, BULK, CROWDED, DISAGREE, RECORDED
from .corrections import refine
from .questions import DENSITY
from .rows import first_over

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ....worlds.requirements import Correction
    from ...rows.questions import Question
    from .frames import Frame, Liquid, Rows, Step

__all__ = ["Density", "crowding_of"]

SUPPORT = {"dfsph": 2.0, "flip": 3.0}
"""Support of the sum over neighbours, in distances of particles; markers of a grid lie unevenly and need more."""
MOST_CELLS = 1_000_000
"""Own choice: in larger spaces far cells share their places."""
SLICE = 4096
"""Elements of a slice of the kernel: some milliseconds of work."""
ASKED = 30_000
"""Own choice: most particles whose neighbours are counted in a frame, taken evenly from all cells: so many tell means within 1 %."""
FULL = {"dfsph": 28.0, "flip": 100.0}
"""Neighbours in a cubic lattice within the support."""


def crowding_of(liquid: Liquid, frame: Frame, most: int | None = None) -> tuple[F64, F64, F64, Rows]:
    """Share of space filled around particles, divergence of velocity [1/s], number of neighbours, and which particles; each shape (n,).

    Args:
        liquid: whose particles they are.
        frame: where they are.
        most: how many are asked for, evenly in the order of their cells; all when left out.
    """
    if not frame.count:
        return np.zeros(0), np.zeros(0), np.zeros(0), np.zeros(0, dtype=np.intp)
    from .kernels import crowding

    wp = warp()
    support = SUPPORT[liquid.plan.engine] * liquid.pitch
    size = 0.5 * support * (1.0 + 1e-5)
    points = (frame.position - frame.position.min(axis=0)).astype(np.float32)
    cell = (points / np.float32(size)).astype(np.int64)
    cells = np.maximum(cell.max(axis=0) + np.array([1, 1, 5]), 5)
    while np.prod(cells) > max(MOST_CELLS, frame.count) and cells[:2].max() > 10:
        cells[int(np.argmax(cells[:2]))] //= 2
    key = ((cell[:, 0] % cells[0]) * cells[1] + cell[:, 1] % cells[1]) * cells[2] + cell[:, 2] + 2
    order = np.argsort(key, kind="stable")
    starts = np.searchsorted(key[order], np.arange(int(np.prod(cells)) + 1)).astype(np.int32)
    vectors = (np.ascontiguousarray(a[order], dtype=np.float32) for a in (points, frame.velocity))
    sorted_points, velocity = (wp.array(v, dtype=wp.vec3, device="cpu") for v in vectors)
    volume = wp.array(frame.volume[order].astype(np.float32), dtype=float, device="cpu")
    number = min(frame.count, most or frame.count)
    chosen = (np.arange(number) * frame.count // number).astype(np.int32)
    rows = order[chosen]
    back = np.argsort(rows)
    filled, spread = (wp.zeros(number, dtype=float, device="cpu") for _ in range(2))
    count = wp.zeros(number, dtype=wp.int32, device="cpu")
    given = [wp.array(starts, dtype=wp.int32, device="cpu"), wp.vec3i(*map(int, cells)), float(size), sorted_points, velocity]
    asked = wp.array(chosen, dtype=wp.int32, device="cpu")
    launch(crowding, number, [*given, volume, support, asked, filled, spread, count], device="cpu", slice_size=SLICE)
    share, divergence, neighbours = (np.asarray(a.numpy()[back], dtype=np.float64) for a in (filled, spread, count))
    return share, divergence, neighbours, rows[back]


class Density:
    """Crowding of every frame."""

    questions: ClassVar[Mapping[str, Question]] = DENSITY

    def __init__(self, liquid: Liquid) -> None:
        self.liquid = liquid
        self.crowded: list[float] = []
        self.apart: list[float] = []
        self.boiling: list[float] = []
        self.recorded: list[float] = []
        self.shown: list[float] = []
        self.capped: list[bool] = []
        """True where a solve of the frame ended at its cap of iterations."""
        self.steps: list[float] = []
        """Steps of the frames [s]."""

    def see(self, step: Step) -> None:
        """Count one frame."""
        frame, engine = step.now, self.liquid.plan.engine
        filled, spread, neighbours, asked = crowding_of(self.liquid, frame, ASKED)
        thick = neighbours >= BULK * FULL[engine]
        filled, spread, bulk = filled[thick], spread[thick], asked[thick]
        self.recorded.append(float(frame.others.get("record/density_error_mean", np.nan)))
        self.capped.append(float(frame.others.get("record/iterations_capped", 0.0)) > 0.0)
        self.steps.append(float(frame.others.get("record/step", np.inf)) or np.inf)
        if len(bulk) < 20:
            self.crowded.append(np.nan)
            self.apart.append(np.nan)
            self.boiling.append(np.nan)
            return
        weight = frame.mass[bulk]
        self.crowded.append(max(0.0, float(np.average(filled, weights=weight)) - 1.0))
        recorded = frame.density[bulk] / self.liquid.rest_density[frame.fluid[bulk]]
        high = filled > 1.0
        self.apart.append(abs(float(np.average(recorded[high] - filled[high], weights=weight[high]))) if high.any() else 0.0)
        speed = float(np.sqrt(np.average(frame.squared[bulk], weights=weight)))
        quiet = np.sqrt(max(self.liquid.strength, 0.1) * self.liquid.spacing)
        self.boiling.append(float(np.average(np.abs(spread), weights=weight)) * self.liquid.pitch / (speed + 0.1 * quiet))

    def findings(self) -> dict[str, Finding]:
        """Crowding, its records, and boiling."""
        recorded, most = np.array(self.recorded), RECORDED[self.liquid.plan.engine]
        if np.isnan(np.array(self.crowded)).all():
            thin = Finding("not_applicable", "the liquid is nowhere thick enough to have an inside")
            found = {"density": thin, "recorded_density": thin, "divergence": thin}
        else:
            bound = CROWDED[self.liquid.plan.engine]
            found = {
                "density": first_over(
                    np.array(self.crowded),
                    bound,
                    "1",
                    "mean crowding",
                    (*self._hints(np.array(self.crowded) > bound), refine(self.liquid, "too few particles across the liquid")),
                ),
                "recorded_density": first_over(
                    np.array(self.apart),
                    self._allowed(),
                    "1",
                    "difference of recorded and counted density",
                    (bake_again("recorded densities are not those of the particles"),),
                ),
                "divergence": first_over(
                    np.array(self.boiling), BOILING, "1", "divergence in the bulk", self._hints(np.array(self.boiling) > BOILING)
                ),
            }
        if (recorded > most).any():
            frame = int(np.argmax(recorded > most))
            text = f"the engine records a mean compression of {recorded[frame]:.3g} at frame {frame} (allowed {most:g})"
            found["density"] = Finding(
                "fail", text, float(np.nanmax(recorded)), most, "1", None, frame, self._hints(recorded > most)
            )
        return found

    def _hints(self, over: NDArray[np.bool_]) -> tuple[Correction, ...]:
        """A shorter step, and more iterations where a solve of the frames over the bound ended at their cap.

        A solve that ended before it met its own error: what is left comes from a step in which the flow, or a blow, changes too much.
        """
        candidate, solver = self.liquid.candidate, self.liquid.solver
        cause = "the step is too long for the flow, or for a blow in these frames"
        shorter = halve_step(candidate, solver, cause, in_force=min(np.array(self.steps)[over], default=np.inf))
        if not (over & np.array(self.capped)).any():
            return (shorter,)
        more = double_iterations(candidate, solver, "the pressure solve stops too early", ", or lower the error at which it ends")
        return (more, shorter)

    def _allowed(self) -> float:
        """Markers of a grid have no density of their own: theirs is that of their cell."""
        return DISAGREE if self.liquid.plan.engine == "dfsph" else 3.0 * DISAGREE
