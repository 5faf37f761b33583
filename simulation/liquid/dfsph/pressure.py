"""The two pressure solves of a step, of velocities and of places: one set of kernels, two right sides."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ....geometry.launch import warp
from . import solve_kernels as kernels
from .step_slots import Slot

if TYPE_CHECKING:
    from ...passes import Passes
    from .bodies import Coupling
    from .settings import DfsphSettings
    from .store import Work

__all__ = ["PressureSolves", "Solved"]

RELAXATION = 0.4
"""Step along the gradient scaled by the diagonal, at first; it is cut to what the iterates show of the largest eigenvalue."""
RECOVERY = 1.02
"""Growth of that step from solve to solve."""


@dataclass(frozen=True)
class Solved:
    """End of one solve."""

    iterations: int
    error: float
    """Mean compression (of the density solve), or mean rate of compression times dt."""
    capped: bool


class PressureSolves:
    """Raises p >= 0 [Pa] until nothing is compressed; p starts where the last step ended.

    The velocity solve changes v and moves bodies; the density solve writes the velocity of travel into `work.way` and leaves v and
    bodies as they are.

    Args:
        passes: prepared kernels.
        coupling: bodies that move with the pressure.
        settings: tolerances and the most iterations.

    Attributes:
        relaxation: steps along the scaled gradient to begin the velocity and the density solve with.
    """

    def __init__(self, passes: Passes, coupling: Coupling, settings: DfsphSettings) -> None:
        self._passes, self._coupling, self._settings = passes, coupling, settings
        self.relaxation = [RELAXATION, RELAXATION]

    def solve(self, w: Work, s: Any, count: int, *, density: bool) -> None:
        """One solve. How it ends is told by `ended`, so that nothing waits for it.

        Args:
            w: arrays of the step; its numbers and neighbours are filled in.
            s: particles.
            count: particles.
            density: the constant-density solve of places; else the divergence-free one of velocities.
        """
        passes, coupling, name = self._passes, self._coupling, "density" if density else "divergence"
        p = s.push if density else s.pressure
        self._begin(w, s, p, count, density=density)
        passes.chain(name, self._iteration(w, s, p, count, density=density), going=w.going)()
        passes(name + "accelerate", kernels.accelerate, count, [p, w.lightness, w.lean, *w.lists, w.a])()
        if density:
            passes("shift", kernels.shift, count, [s.v, w.a, w.settings, w.way])()
        else:
            coupling.book(p)
            passes("end", kernels.end, count, [w.a, w.settings, s.v])()
        warp().copy(w.ended[int(density)], w.settings)

    def ended(self, w: Work) -> list[Solved]:
        """The ends of the velocity and the density solve of this step; the next ones begin with what they found."""
        rows = w.ended.numpy()
        self.relaxation = [min(RELAXATION, RECOVERY * float(found[Slot.OMEGA])) for found in rows]
        return [Solved(int(found[Slot.DONE]), float(found[Slot.ERROR]), found[Slot.MET] == 0.0) for found in rows]

    def _begin(self, w: Work, s: Any, p: Any, count: int, *, density: bool) -> None:
        """The right side and what is asked of the solve."""
        passes, name, k = self._passes, "density" if density else "divergence", self._settings
        self._coupling.moving_walls()
        passes(name + "rates", kernels.rates, count, [s.v, w.lean, *w.lists, w.moving, w.rate])()
        passes(name + "source", kernels.source, count, [w.fill, w.rate, w.settings, int(density), w.b])()
        passes(name + "begin", kernels.begin, count, [p, w.y])()
        tolerance = k.density_error if density else k.divergence_error
        w.put(BETA=0.0, NESTEROV=1.0, ERROR=0.0, OMEGA=self.relaxation[int(density)])
        w.put(TOLERANCE=tolerance, MOST=k.iterations, DONE=0.0, MET=0.0)
        w.send()
        passes.fold("asked", kernels.asked, count, [w.b, w.partial])()
        passes.close("before", kernels.judge, count, [w.partial, w.settings, 1, w.going])()

    def _iteration(self, w: Work, s: Any, p: Any, count: int, *, density: bool) -> list[Callable[[], None]]:
        """Passes of one iteration."""
        passes, coupling, name = self._passes, self._coupling, "density" if density else "divergence"
        reaction = coupling.reaction(w.y, moves=not density)
        bounds = [coupling.taken, w.firm if density else w.stiffness, w.b, s.volume, w.settings]
        ends = [p, w.y, w.last_y, w.last_r, w.sums]
        sums = count
        if w.swift is None:
            accelerate = passes("accelerate", kernels.accelerate, count, [w.y, w.lightness, w.lean, *w.lists, w.a])
            relax = passes(name + "relax", kernels.relax, count, [w.a, w.lean, *w.lists, *bounds, *ends])
        else:
            from . import solve_gpu_kernels as swift

            sums = -(-count // swift.WARP)
            accelerate = passes("accelerate", swift.accelerate, count, [w.y, w.lightness, w.lean, *w.lists, w.swift])
            inputs = [count, w.swift, w.lean, *w.lists, *bounds, *ends]
            relax = passes(name + "relax", swift.relax, swift.WARP * sums, inputs)
        return [
            accelerate,
            *reaction,
            relax,
            passes.fold("gather", kernels.gather, sums, [w.sums, w.partial]),
            passes.close("judge", kernels.judge, sums, [w.partial, w.settings, 0, w.going]),
        ]
