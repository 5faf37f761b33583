"""The two pressure solves of a step, of velocities and of places: one set of kernels, two right sides."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from . import solve_kernels as kernels

if TYPE_CHECKING:
    from ...passes import Passes
    from .bodies import Coupling
    from .store import Work

__all__ = ["Solved", "solve"]

RELAXATION = 0.4
"""Step along the gradient scaled by the diagonal, at first; it is cut to what the iterates show of the largest eigenvalue."""
RECOVERY = 1.02
"""Growth of that step from solve to solve."""


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
    s: Any,
    *,
    count: int,
    density: bool,
    settings: Any,
    tolerance: float,
    most: int,
    coupling: Coupling,
    relaxation: float,
) -> Solved:
    """Raise p >= 0 [Pa] until nothing is compressed; p starts where the last step ended.

    The velocity solve changes v and moves bodies; the density solve writes the velocity of travel into `work.way` and leaves v and
    bodies as they are.

    Args:
        passes: prepared kernels.
        work: arrays of the step; `settings` and neighbours are filled in.
        p: pressure of this solve.
        s: particles.
        count: particles.
        density: the constant-density solve of places; else the divergence-free one of velocities.
        settings: host values of `work.settings`.
        tolerance: mean error at which to stop.
        most: iterations at most.
        coupling: bodies that move with the pressure.
        relaxation: step along the scaled gradient to begin with.
    """
    w, name = work, "density" if density else "divergence"
    coupling.moving_walls()
    passes(name + "rates", kernels.rates, count, [s.v, w.lean, *w.lists, w.moving, w.rate])()
    passes(name + "source", kernels.source, count, [w.fill, w.rate, w.settings, int(density), w.b])()
    passes(name + "begin", kernels.begin, count, [p, w.y])()
    settings[2:6] = (0.0, 1.0, 0.0, relaxation)
    settings[12:16] = (tolerance, most, 0.0, 0.0)
    w.settings.assign(settings)
    passes.fold("asked", kernels.asked, count, [w.b, w.partial])()
    passes.close("before", kernels.judge, count, [w.partial, w.settings, 1, w.going])()
    reaction = coupling.reaction(w.y, moves=not density)
    chain: list[Callable[[], None]] = [
        passes("accelerate", kernels.accelerate, count, [w.y, w.lightness, w.lean, *w.lists, w.a]),
        *reaction,
        passes(
            name + "relax",
            kernels.relax,
            count,
            [
                w.a,
                w.lean,
                *w.lists,
                coupling.taken,
                w.firm if density else w.stiffness,
                w.b,
                s.volume,
                w.settings,
                p,
                w.y,
                w.last_y,
                w.last_r,
                w.sums,
            ],
        ),
        passes.fold("gather", kernels.gather, count, [w.sums, w.partial]),
        passes.close("judge", kernels.judge, count, [w.partial, w.settings, 0, w.going]),
    ]
    passes.chain(name, chain, going=w.going)()
    passes(name + "accelerate", kernels.accelerate, count, [p, w.lightness, w.lean, *w.lists, w.a])()
    if density:
        passes("shift", kernels.shift, count, [s.v, w.a, w.settings, w.way])()
    else:
        coupling.book(p)
        passes("end", kernels.end, count, [w.a, w.settings, s.v])()
    found = w.settings.numpy()
    return Solved(int(found[14]), float(found[4]), found[15] == 0.0, min(RELAXATION, RECOVERY * float(found[5])))
