"""A gas in an active box that follows it inside a declared box: the fields of the declared box, ambient air at rest where it is not.

The active box grows by blocks of cells before anything arrives at its inner sides, and comes in where nothing is left. What its inner sides let
out nevertheless, or what it drops as it comes in, is counted (`slipped`) with what escapes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...physics.substances import SEA_LEVEL
from ...worlds.arrays import F64
from .border import side_faces
from .engine import MOTION, PACKED, Gas, GasReport
from .far import FarGas, NearGas
from .reaction import YieldingGas
from .regions import label
from .settings import GasSettings, Side
from .solids import Solids, enclosed
from .window import Cells, Window, bounds_of, cells_of, fitted, shrunk

__all__ = ["ActiveGas", "gas_in"]

MARGIN = 4
"""Cells between what is followed and the inner sides that are left, at least, after the way of the fastest gas in a step."""
SEEN, LEFT = 1e-3, 1e-8
"""Own choice: shares of what sources let out from which on gas is followed, and up to which it is dropped as the box comes in."""
FLOOR = (0.085, 1e-3, 1e-2, 1e-1)
"""Own choice: lightness (25 K), soot, fuel and product [kg/m^3] in place of that, of what they let out none of."""
LEAST_SPEED = 1e-6
"""[m/s] Slower air is at rest."""
QUICK = 0.5
"""Share of the greatest speed from which on air is followed, whatever it holds."""
OFTEN = 16
"""Own choice: steps after which an active box may come in."""


class ActiveGas:
    """As `Gas`, in an active box.

    Args:
        shape: cells of the declared box.
        cell: their size [m].
        sides: of the declared box; none is periodic.
        settings: of the engine.
        start: cells that hold the source, (nx, ny, nz).
        solids: what is not open.
        moves: whether they will move.
        known: gravity and device, as of `Gas`.
    """

    packed = (*PACKED, "active", "scale", "far")
    """Names of what `pack` returns."""
    far_field = True
    """False: the ambient pressure stands at inner sides, for comparison."""

    def __init__(
        self, shape: Cells, cell: float, sides: Sequence[Side], settings: GasSettings, *, start: NDArray[np.bool_],
        solids: Solids | None = None, moves: bool = False, **known: Any,
    ) -> None:  # fmt: skip
        self.shape, self.cell, self.sides, self.settings = shape, cell, tuple(sides), settings
        self.outer = side_faces(shape)[1]
        self._known = {**known, "moves": moves}
        self._at = enclosed(shape, sides, solids, widen=not moves)
        self._moves = moves
        self._rate = self._heating = self._spark = np.zeros(shape)
        self._fed = self._heats = False
        self._content: F64 = np.zeros(4)
        self._scale = np.zeros(4)
        self._out = np.zeros(5)
        self._slipped = np.zeros(5)
        self._sealed: list[Window] | None = None
        self.far = (
            FarGas(shape, cell, sides, settings, solids=self._at, moves=moves, device=known.get("device"))
            if self.far_field
            else None
        )
        self.margin = MARGIN + int(np.ceil(settings.courant))
        """Cells between what is followed and the inner sides, at least."""
        began = bounds_of(start)
        self._open(self._holding(fitted([began or Window((0, 0, 0), (1, 1, 1))], self.margin, shape)))

    # ------------------------------------------------------------ the active box

    def _open(self, window: Window) -> None:
        """Make the engine of an active box, with air at rest."""
        self.near = NearGas(
            window, self.shape, self.far, self.sides, self.cell, self.settings, solids=window.solids(self._at), **self._known
        )
        self._fed = False
        if self._spark.any():
            self.near.ignite(self._spark[window.cells])

    @property
    def window(self) -> Window:
        """The active box."""
        return self.near.window

    def _feed(self) -> None:
        """Let the engine have its part of the sources, where it has not."""
        if self._fed:
            return
        self._fed, at = True, self.window.cells
        self.near.emit(self._rate[at], self._content[at] if self._content.ndim > 1 else self._content)
        if self._heats:
            self.near.heat(self._heating[at])

    def _follow(self, changed: NDArray[np.bool_] | None) -> None:
        """Grow, or come in, before a step; `changed` are cells whose room the step changes."""
        marks = [self._followed(SEEN)]
        marks += [bounds_of(values != 0.0) for values in (self._rate, self._heating)[: 1 + self._heats]]
        marks.append(None if changed is None else bounds_of(changed))
        found = [w for w in marks if w is not None]
        if not found:
            return
        now = self.window
        wanted = fitted(found, self.margin, self.shape, now)
        if self.near.steps % OFTEN == OFTEN - 1 and (left := self._followed(LEFT)) is not None:
            wanted = shrunk(wanted, fitted([*found, left], self.margin, self.shape))
        wanted = self._holding(wanted)
        if wanted != now:
            self._change(wanted)

    def _followed(self, share: float) -> Window | None:
        """Where there is more gas than a share of what sources let out, or where air is fast."""
        near, (nx, ny) = self.near, self.near.shape[:2]
        least = np.where(self._scale > 0.0, self._scale, FLOOR) * share
        found = near.extents(least, max(QUICK * near.fastest("velocity"), LEAST_SPEED))[:nx, :ny]
        rows = bounds_of((found[..., 1] > 0)[..., None])
        if rows is None:
            return None
        low, high = (
            np.array(near.window.low) + at for at in ((*rows.low[:2], found[..., 0].min()), (*rows.high[:2], found[..., 1].max()))
        )
        return Window(cells_of(low), cells_of(high))

    def _holding(self, window: Window) -> Window:
        """A window that holds all of each sealed region which it meets: its pressure is one."""
        if self._sealed is None:
            number, sealed = label(self._at.room, self._at.opening, self.sides)
            cells = number[tuple(slice(0, n) for n in self.shape)]
            self._sealed = [w for k in np.flatnonzero(sealed) if (w := bounds_of(cells == k)) is not None]
        for region in self._sealed:
            if all(a < d and c < b for a, b, c, d in zip(region.low, region.high, window.low, window.high, strict=True)):
                window = fitted([region], 0, self.shape, window)
        return window

    def _change(self, window: Window) -> None:
        """Go on in another active box."""
        old, before = self.near.pack(), self.window
        ratio = self.near.pressure / SEA_LEVEL if self.near.regions.sealed.any() else None
        self._take()
        if self.far is not None:
            self.far.collect(self.near)
        now = dict(old)
        for name, width in (("state", 4), *((n, 3) for n in MOTION)):
            extra = 0 if name == "state" else 1
            full = np.zeros((*(n + extra for n in window.shape), width), np.float32)
            here, there = _overlap(window, before, extra)
            full[here] = old[name][there]
            now[name] = full
            if name == "state":
                kept = (old[name][there].astype(np.float64) * self._at.room[before.cells][there][..., None]).sum(axis=(0, 1, 2))
                lost = (old[name].astype(np.float64) * self._at.room[before.cells][..., None]).sum(axis=(0, 1, 2)) - kept
        self._out[:4] += lost
        self._slipped[:4] += lost
        # Its memory is free before the next one takes some.
        del self.near
        self._open(window)
        fields = window.solids(self._at)
        now.update(
            {f"solids/{n}": getattr(fields, n) if self._moves else now[f"solids/{n}"] for n in ("room", "opening", "velocity")}
        )
        now["ratio"] = np.ones(len(self.near.regions.sealed)) if ratio is None else self._ratios(before, ratio)
        self.near.unpack(now)
        self.near.fill(before)

    def _ratios(self, before: Window, ratio: F64) -> F64:
        """Pressures of the regions of the active box over the ambient one, from those of the cells of the one before."""
        full = np.ones(self.shape)
        full[before.cells] = ratio
        regions, window = self.near.regions, self.window
        number = regions.number.reshape([n + 1 for n in window.shape])[tuple(slice(0, n) for n in window.shape)]
        inside, many = number >= 0, len(regions.sealed)
        weight = np.bincount(number[inside], minlength=many)
        total = np.bincount(number[inside], full[window.cells][inside], many)
        return np.where(regions.sealed, total / np.maximum(weight, 1), 1.0)

    # ------------------------------------------------------------ sources

    def emit(self, rate: F64, content: Sequence[float] | F64) -> None:
        """As of `Gas`."""
        self._rate, self._content, self._fed = rate, np.asarray(content, float), False
        self._scale = np.maximum(self._scale, np.abs(self._content).reshape(-1, 4).max(axis=0))

    def heat(self, rate: F64) -> None:
        """As of `Gas`."""
        self._heating, self._fed, self._heats = rate, False, True

    def blow(self, speeds: F64) -> None:
        """As of `Gas`; raises ValueError where the air beyond moves."""
        if np.any(speeds):
            raise ValueError(
                f"air beyond its sides moves with {np.abs(speeds).max():.3g} m/s, at most 0 where an active box follows a gas"
            )

    def ignite(self, where: F64) -> None:
        """As of `Gas`."""
        self._spark = np.asarray(where, float)
        self.near.ignite(self._spark[self.window.cells])

    # ------------------------------------------------------------ steps

    def longest(self) -> float:
        """Longest step now [s]."""
        self._feed()
        return self.near.longest()

    def step(self, seconds: float, solids: Solids | None = None) -> GasReport:
        """As of `Gas`."""
        changed, after = None, self._at
        if solids is not None:
            if self.near.steps % OFTEN == 0:
                self._sealed = None
            after = enclosed(self.shape, self.sides, solids, widen=False)
            inner = tuple(slice(0, n) for n in self.shape)
            changed = np.not_equal(after.room[inner], self._at.room[inner]) | after.velocity[inner].any(axis=-1)
        self._follow(changed)
        self._feed()
        if self.far is not None and solids is not None:
            self.far.turn(after, seconds)
        elif self.far is not None:
            self.far.rest()
        report = self.near.step(seconds, None if solids is None else self.window.solids(after))
        self._at = after
        self._take()
        return report

    def advance(self, seconds: float, solids: Any = None) -> list[GasReport]:
        """As of `Gas`."""
        found, left = [], seconds
        while left > 1e-9 * seconds:
            dt = left / np.ceil(left / min(left, self.longest()) - 1e-6)
            left -= dt
            found.append(self.step(float(dt), None if solids is None else solids(seconds - left)))
        return found

    def _take(self) -> None:
        """Count what has left through the sides of the active box."""
        by_side = self.near.border.by_side()
        self._out += by_side.sum(axis=0)
        self._slipped += by_side[np.array(self.window.inner(self.shape), bool)].sum(axis=0)

    def take(self) -> F64:
        """(5,) four amounts and the volume that have left since the last call, less what came in [cells]."""
        found, self._out = self._out, np.zeros(5)
        return found

    def slipped(self) -> F64:
        """(5,) amounts and volume that inner sides have let out since the last call, less what came in, and amounts that were dropped [cells];
        part of what `take` tells."""
        found, self._slipped = self._slipped, np.zeros(5)
        return found

    # ------------------------------------------------------------ fields

    def _whole(self, values: NDArray[Any], rest: float = 0.0, extra: int = 0) -> NDArray[Any]:
        """Values of the active box in the declared one."""
        full = np.full((*(n + extra for n in self.shape), *values.shape[3:]), rest, values.dtype)
        full[self.window.elements if extra else self.window.cells] = values
        return full

    @property
    def state(self) -> NDArray[np.float32]:
        """(nx, ny, nz, 4) lightness, soot, fuel and product of cells."""
        return self._whole(self.near.state)

    @property
    def velocity(self) -> NDArray[np.float32]:
        """(nx + 1, ny + 1, nz + 1, 3) speeds of lower faces [m/s]."""
        return self._whole(self.near.velocity, extra=1)

    def only(self, values: NDArray[np.float32]) -> NDArray[np.float32]:
        """Values of cells of the declared box, 0 outside the active one: cells along its sides have a moving face."""
        return self._whole(values[self.window.cells])

    @property
    def room(self) -> NDArray[np.float32]:
        """(nx, ny, nz) open share of cells."""
        return self._at.room[tuple(slice(0, n) for n in self.shape)]

    @property
    def temperature(self) -> F64:
        """(nx, ny, nz) [K]."""
        return self._whole(self.near.temperature, self.settings.ambient_temperature)

    @property
    def power(self) -> NDArray[np.float32]:
        """(nx, ny, nz, 2) heat that fire released, and what was radiated, per volume in the last step [W/m^3]."""
        return self._whole(self.near.power)

    @property
    def density(self) -> float:
        """Density of the ambient air [kg/m^3]."""
        return self.near.density

    @property
    def fire(self) -> Any:
        """The fire of what may burn."""
        return self.near.fire

    def totals(self) -> F64:
        """(4,) sums of lightness, soot, fuel and product over cells times their open volume [cells]."""
        return self.near.totals()

    # ------------------------------------------------------------ state

    def pack(self) -> dict[str, Any]:
        """As of `Gas`, of the active box, and where that is."""
        far = np.zeros(0, np.float32) if self.far is None else self.far.velocity
        found = {**self.near.pack(), "active": np.array(self.window), "scale": self._scale, "far": far}
        if self._moves:
            found.update({f"solids/{n}": getattr(self._at, n) for n in ("room", "opening", "velocity")})
        return found

    def unpack(self, found: Mapping[str, Any]) -> None:
        """Continue from such a state."""
        low, high = (tuple(int(v) for v in row) for row in found["active"])
        window = Window(low, high)  # type: ignore[arg-type]
        own = dict(found)
        if self._moves:
            self._at = Solids(*(found[f"solids/{n}"] for n in ("room", "opening", "velocity")))
            fields = window.solids(self._at)
            own.update({f"solids/{n}": getattr(fields, n) for n in ("room", "opening", "velocity")})
        if window != self.window:
            self._open(window)
        self.near.unpack(own)
        self._scale, self._sealed = found["scale"].copy(), None
        if self.far is not None:
            self.far.rest()
            self.far.velocity = found["far"]


def _overlap(a: Window, b: Window, extra: int) -> tuple[tuple[slice, ...], tuple[slice, ...]]:
    """Parts of two windows that both share; of fields with `extra` elements more than cells along each axis."""
    low = [max(x, y) for x, y in zip(a.low, b.low, strict=True)]
    high = [min(x, y) + extra for x, y in zip(a.high, b.high, strict=True)]
    mine, theirs = (tuple(slice(x - o, y - o) for x, y, o in zip(low, high, w.low, strict=True)) for w in (a, b))
    return mine, theirs


def gas_in(
    shape: Cells, cell: float, sides: Sequence[Side], settings: GasSettings, follows: bool, start: NDArray[np.bool_], *,
    feels: bool = False, **known: Any,
) -> Gas | ActiveGas:  # fmt: skip
    """A gas in a box, that `feels` what it carries or not, or in an active box in it that follows it from the cells of its source on."""
    if follows:
        return ActiveGas(shape, cell, sides, settings, start=start, **known)
    return (YieldingGas if feels else Gas)(shape, cell, sides, settings, **known)
