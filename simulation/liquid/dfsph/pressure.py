"""The two pressure solves of a step: one set of kernels, two right sides."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from . import solve_kernels as kernels

if TYPE_CHECKING:
    from .bodies import Coupling
    from .passes import Passes
    from .store import Work

__all__ = ["Solved", "solve"]

RELAXATION = 0.4
"""Step along the gradient scaled by the diagonal, at first; it is cut to what the iterates show of the largest eigenvalue."""
RECOVERY = 1.02
"""Growth of that step from solve to solve."""
RESIDUAL = 0.2
"""Share of the compression asked away that may be left: keeps tall columns from sagging, whose bottom alone is compressed."""
SMALL = 0.02
"""Share of the tolerance below which that does not matter."""
CHUNK = 2
"""Iterations per graph on a GPU, between two looks at the error."""


@dataclass(frozen=True)
class Solved:
    """How one solve ended."""

    iterations: int
    error: float
    """Mean compression (of the density solve), or mean rate of compression times dt."""
    capped: bool
    relaxation: float
    """To begin the next solve with."""


def solve(
    passes: Passes,
    work: Work,
    p: Any,
    v: Any,
    volume: Any,
    *,
    count: int,
    density: bool,
    settings: Any,
    tolerance: float,
    most: int,
    coupling: Coupling,
    relaxation: float,
) -> Solved:
    """Raise p >= 0 [Pa] until nothing is compressed, and change v by it; p starts where the last step ended.

    Args:
        passes: prepared kernels.
        work: arrays of the step; `settings` and neighbours are filled in.
        p: pressure of this solve.
        v: velocities.
        volume: of the particles [m^3].
        count: particles.
        density: the constant-density solve; else the divergence-free one.
        settings: host values of `work.settings`.
        tolerance: mean error at which to stop.
        most: iterations at most.
        coupling: bodies that move with the pressure.
        relaxation: step along the scaled gradient to begin with.
    """
    w, name = work, "density" if density else "divergence"
    lists = [w.count, w.near, w.gradient, w.row, w.stride]
    coupling.moving_walls()
    passes(name + "rates", kernels.rates, count, [v, w.lean, *lists, w.moving, w.rate])()
    passes(name + "source", kernels.source, count, [w.fill, w.rate, w.settings, int(density), w.b, w.sums])()
    passes(name + "begin", kernels.begin, count, [p, w.y])()
    settings[2:6] = (0.0, 1.0, 0.0, relaxation)
    w.settings.assign(settings)
    lane_sums = passes("lane_sums", kernels.lane_sums, w.lanes, [w.sums, count, w.lanes, w.partial])
    lane_sums()
    passes("first_sums", kernels.close_sums, 1, [w.lanes, w.partial, w.settings, 1])()
    reaction = coupling.reaction(w.y)
    chain: list[Callable[[], None]] = [
        passes("accelerate", kernels.accelerate, count, [w.y, w.lightness, w.lean, *lists, w.a]),
        *reaction,
        passes(
            name + "relax",
            kernels.relax,
            count,
            [
                w.a,
                w.lean,
                *lists,
                coupling.taken,
                w.stiffness,
                w.b,
                volume,
                w.settings,
                p,
                w.y,
                w.last_y,
                w.last_r,
                w.sums,
            ],
        ),
        lane_sums,
        passes("close_sums", kernels.close_sums, 1, [w.lanes, w.partial, w.settings, 0]),
    ]
    chunk = 1 if passes.device == "cpu" else CHUNK
    run = passes.chain(name, chain * chunk)
    done, error, good, found = 0, np.inf, False, w.settings.numpy()
    while done < most:
        run()
        done += chunk
        found = w.settings.numpy()
        error, left, asked = (float(found[k]) for k in (4, 8, 9))
        good = error <= tolerance and left <= max(RESIDUAL * asked, SMALL * tolerance)
        if good or not np.isfinite(error):
            break
    passes(name + "accelerate", kernels.accelerate, count, [p, w.lightness, w.lean, *lists, w.a])()
    coupling.book(p)
    passes(name + "end", kernels.end, count, [w.a, w.settings, v])()
    return Solved(done, error, not good, min(RELAXATION, RECOVERY * float(found[5])))
