"""Flow of the gas by its recorded velocities: what it lets pass, and what drives it (R100).

A frame has velocities at the middles of cells, each the mean of those of two faces. Weighted 1, 2, 1 along both other axes, their differences
over two cells are the net outflow of a cell and its 26 neighbours, so weighted, exactly: no error of interpolation hides what a cell lets out
of nothing. It is looked at where all these cells are open and nothing emits or heats.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ....worlds.arrays import F64
from ....worlds.fields import fields_of
from ...rows.findings import Finding
from .bounds import DIVERGENT, EMITTED, ENERGY, PROJECTED
from .cells import WHOLE, most_near
from .outflow import outflow
from .questions import FLOW
from .rows import kept_within, recomputed

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...rows.questions import Question
    from .cells import GasFrame, Mask
    from .frames import GasBox
    from .sources import Source

__all__ = ["Flow", "net_outflow"]

TINY = 1e-12
SLOW = 1e-3
"""[m/s] Slower gas is as good as still; where all is slower, errors are shares of this."""
AMBIENT = 0.5
"""[K] Gas nearer to the ambient temperature neither heats nor cools what is about it."""


def mirrored(velocity: Any, sides: tuple[str, ...]) -> F64:
    """Velocities with one more cell beyond each side: mirrored at closed ones, which nothing passes; NaN beyond open ones."""
    from .flow_kernels import mirrored as found

    return np.asarray(found(np.ascontiguousarray(velocity), np.array([kind == "closed" for kind in sides])))


def net_outflow(velocity: F64, cell: float) -> F64:
    """Net outflow per volume [1/s] of inner cells and their neighbours, weighted 1, 2, 1 along each axis, shape (nx - 2, ny - 2, nz - 2)."""
    from .flow_kernels import netted

    return np.asarray(netted(np.ascontiguousarray(velocity, dtype=np.float64), 2.0 * cell))


def _within(now: GasFrame) -> Mask:
    """Cells of the active part whose neighbours all lie in it, or beyond sides of the box."""
    found = np.zeros(now.room.shape, dtype=bool)
    found[now.active] = True
    for side in now.inner_sides:
        at: list[Any] = list(now.active)
        place = at[side // 2]
        at[side // 2] = place.stop - 1 if side % 2 else place.start
        found[tuple(at)] = False
    return found


MET = 2
"""[cells] How far from its middle a piece of cloth meets gas."""


class Flow:
    """Velocities of every frame."""

    questions: ClassVar[Mapping[str, Question]] = FLOW

    def __init__(self, box: GasBox) -> None:
        self.box = box
        self.net: list[float] = []
        self.where: list[list[float]] = []
        self.short: list[float] = []
        self.judged = 0
        self.struck: list[bool] = []
        """True where a source begins or ends within the interval before a frame: its push moves all air at once."""
        self.kinetic: list[tuple[float, float]] = []
        """Least and most [J]: without cells that bodies cut, and as if they were whole."""
        self.given: list[float] = []
        self.dragged: list[tuple[float, float]] = []
        """Work of what it carries and feels over the interval before a frame, and how far that is uncertain [J]."""
        self.taken_in: list[float] = []
        """Energy of the motion that a frame is the first to tell, since its active part has grown [J]."""

    def see(self, now: GasFrame, before: GasFrame | None) -> None:
        """Look at one frame."""
        box = self.box
        net = net_outflow(mirrored(now.velocity, box.sides), box.cell)
        if now.fire is not None:
            net -= self._asked(now)
        free = (now.room > WHOLE) & (box.bodies.depth(now) == -np.inf) & box.bodies.apart(now, box.sides) & ~self._burning(now)
        whole = ~most_near(~free, 2) & np.isfinite(net) & _within(now)
        calm = whole & ~np.any([s.cells(now, 2.0 * box.cell, box.duration) for s in box.sources], axis=0)
        if self._heats:
            calm &= ~most_near(~(np.abs(now.temperature - box.ambient) < AMBIENT), 1)
        fastest = max(float(now.speed.max()), SLOW)
        error = np.where(calm, np.abs(net), 0.0) * box.cell / fastest
        at = np.unravel_index(int(error.argmax()), error.shape)
        self.net.append(float(error[at]))
        self.where.append(now.place(tuple(int(i) for i in at)))
        self.short.append(max([0.0, *(self._outflow(now, net, whole, s) for s in box.sources)]))
        self._work(now, before)

    def _burning(self, now: GasFrame) -> Mask:
        """Cells that cloth meets which is not consumed: it takes heat from them, and gives gas; bodies that burn count as bodies."""
        surfaces = self.box.surfaces
        if surfaces is None or not surfaces.thin.any():
            return np.zeros(now.room.shape, dtype=bool)
        return surfaces.beside(now, surfaces.thin & (surfaces.state[max(now.index - 1, 0)].left > 0.0), MET)

    def _asked(self, now: GasFrame) -> F64:
        """Net outflow that the heat of fire asks for [1/s], weighted as `net_outflow` is."""
        from .flow_kernels import blurred

        return np.asarray(blurred(self.box.heating(now) / self.box.joule))

    @property
    def _heats(self) -> bool:
        """True where gas heats or cools the air about it, by what no frame tells."""
        lost = self.box.combustion is None and bool(self.box.record("lost_heat").any())
        return bool(self.box.expands and self.box.settings.diffusivity > 0.0) or lost

    def _outflow(self, now: GasFrame, net: F64, whole: Mask, source: Source) -> float:
        """Difference of the outflow of a box about a source from its rate, over that; 0 where bodies or other sources are about it."""
        box = self.box
        rate = source.rate(box.duration * (now.index - 0.5))
        about = source.cells(now, 2.0 * box.cell, box.duration)
        others = [s for s in box.sources if s is not source and (s.cells(now, 3.0 * box.cell, box.duration) & about).any()]
        if source.changes(box.duration * (now.index - 1), box.duration * now.index + TINY):
            return 0.0
        if now.index == 0 or rate <= 0.0 or others or self._heats or not whole[about].all():
            return 0.0
        self.judged += 1
        return abs(float(net[about].sum()) * box.volume - rate) / rate

    def _work(self, now: GasFrame, before: GasFrame | None) -> None:
        from .flow_kernels import driven, moving

        box = self.box
        motion = moving(0.5 * box.volume, box.density(now), now.room, box.velocity(now))
        whole = box.bodies.depth(now) == -np.inf
        total = float(motion.sum())
        self.kinetic.append((float(motion[whole].sum()), total))
        self.taken_in.append(0.0 if before is None else total - float(motion[before.active].sum()))
        heavier = driven(now.soot, box.lightness(now), box.air, now.room, box.volume)
        power = float(np.sum(heavier * (box.velocity(now) @ box.gravity)))
        time = box.duration * now.index
        self.struck.append(any(s.changes(time - box.duration, time) for s in box.sources))
        for source in box.sources:
            near = source.cells(now, box.cell, box.duration)
            blown = float(now.speed[near].max(initial=0.0))
            power += box.air * blown**2 * source.rate(max(0.0, time - 0.5 * box.duration))
        given, unsure = self._returned(now, before)
        self.dragged.append((given, unsure))
        power += self._spread(now)
        self.given.append(power + outflow(box, now).inward)

    def _returned(self, now: GasFrame, before: GasFrame | None) -> tuple[float, float]:
        """Work over the interval of what it carries and feels, by the mean of the velocities at both ends, and half of what their difference makes [J]."""
        taken = None if before is None else self.box.returned(now.index)
        if before is None or taken is None:
            return 0.0, 0.0
        start, end = (self.box.velocity(f) for f in (before, now))
        return 0.5 * float((taken * (start + end)).sum()), 0.5 * float(np.abs(taken * (end - start)).sum())

    def _spread(self, now: GasFrame) -> float:
        """Power of gas that fire makes swell or shrink, at the pressure of the fastest gas about it [W]."""
        box = self.box
        if box.combustion is None:
            return 0.0
        made = np.abs(box.heating(now)) / box.joule * now.room * box.volume
        return float(box.air * np.sum(made * np.square(most_near(now.speed, 1).astype(np.float64))))

    def findings(self) -> dict[str, Finding]:
        """Findings on the four questions by name."""
        net, short = np.array(self.net), np.array(self.short)
        hints = recomputed(self.box)

        def told(frame: int | None) -> str:
            if frame is None:
                return f"net outflow of cells is {net.max():.2g} of the largest speed at most"
            return f"cells at {self.where[frame]} let out {net[frame]:.3g} of the largest speed per cell at frame {frame}, and nothing emits there"

        first = int(np.argmax(net > DIVERGENT)) if (net > DIVERGENT).any() else None
        flown = Finding("not_applicable", "no source that emits stands clear of bodies, sides and others")
        if self.judged:
            flown = kept_within(
                short, EMITTED + DIVERGENT, "1",
                lambda k: f"what flows out around sources differs by {short[-1 if k is None else k]:.2g} of their rate" + ("" if k is None else f" at frame {k}"),
                hints,
            )  # fmt: skip
        left = self.box.record("divergence")
        return {
            "divergence": kept_within(net, DIVERGENT, "1", told, hints, None if first is None else {"at": self.where[first]}),
            "outflow": flown,
            "projection": kept_within(
                left, PROJECTED, "1",
                lambda k: f"the recorded divergence is {left.max() if k is None else left[k]:.2g} of the largest speed per cell" + ("" if k is None else f" at frame {k}"),
                hints,
            ),
            "energy": self._energy(),
        }  # fmt: skip

    def _energy(self) -> Finding:
        box = self.box
        if box.settings.confinement > 0.0:
            return Finding("not_applicable", "confinement puts energy in, which the register tells")
        if box.bodies.moving:
            return Finding("not_applicable", "moving bodies stir the gas, and no record tells with what work")
        if any(fields_of(box.candidate.spec, m) for m in box.members):
            return Finding("not_applicable", "wind works on the air at open sides, and no record tells with what")
        least, most = np.array(self.kinetic).T
        power = np.array(self.given)
        work = np.concatenate([[0.0], np.cumsum(0.5 * box.duration * (power[1:] + power[:-1]))])
        dragged = np.cumsum(np.array(self.dragged), axis=0)
        doubt = np.concatenate([[0.0], np.cumsum(0.5 * box.duration * np.abs(np.diff(power)))]) + dragged[:, 1]
        pushed = np.where(self.struck, np.maximum(np.diff(most, prepend=0.0), 0.0), 0.0)
        work = work + np.cumsum(pushed) + np.cumsum(self.taken_in) + dragged[:, 0]
        scale = max(float(most.max()), float(np.abs(work).max()), TINY)
        growth = least - work - doubt - np.minimum.accumulate(most - work - doubt)
        over = np.maximum(growth, 0.0) / scale

        def told(frame: int | None) -> str:
            most_of_all = f"{growth.max():.3g} J, {growth.max() / scale:.2%} of the {scale:.3g} J in play"
            head = f"energy of motion grows by {most_of_all} at most beyond what drives it gives"
            return head if frame is None else f"{head}, from frame {frame} on by more than {ENERGY:.0%}"

        return kept_within(over, ENERGY, "1", told, recomputed(box), {"growth_J": float(growth.max()), "scale_J": scale})
