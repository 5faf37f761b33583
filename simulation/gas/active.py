"""A gas in an active box that follows it inside a declared box: the fields of the declared box, ambient air at rest where it is not.

The active box grows by blocks of cells before anything arrives at its inner sides, and comes in where nothing is left. What its inner sides let
out nevertheless, or what it drops as it comes in, is counted (`slipped`) with what escapes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from .border import side_faces
from .engine import LIGHTNESS, MOTION, Gas, GasReport
from .far import FarGas, NearGas
from .regions import label
from .settings import GasSettings, Side
from .solids import Solids, enclosed
from .window import Cells, Window, bounds_of, fitted, shrunk

__all__ = ["ActiveGas"]

MARGIN = 8
"""Cells between what is followed and the inner sides, at least."""
SEEN = 1e-5
"""Own choice: share of the greatest amount of its kind from which on gas is followed."""
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
        gravity: [m/s^2].
        solids: what is not open.
        moves: whether they will move.
        device: where it runs.
    """

    far_field = True

    def __init__(
        self, shape: Cells, cell: float, sides: Sequence[Side], settings: GasSettings, *, start: NDArray[np.bool_],
        gravity: tuple[float, float, float] = (0.0, 0.0, -9.81), solids: Solids | None = None, moves: bool = False,
        device: str | None = None,
    ) -> None:  # fmt: skip
        self.shape, self.cell, self.sides, self.settings = shape, cell, tuple(sides), settings
        self.outer = side_faces(shape)[1]
        self._known = {"gravity": gravity, "moves": moves, "device": device}
        self._at = enclosed(shape, sides, solids, widen=not moves)
        self._moves = moves
        self._rate = self._heating = self._spark = np.zeros(shape)
        self._content: F64 = np.zeros(4)
        self._scale = np.zeros(4)
        self.slipped = np.zeros(5)
        """Amounts and volume that inner sides let out, less what came in, and amounts that were dropped [cells]."""
        self._out = np.zeros(5)
        self._sealed: list[Window] | None = None
        self.far = FarGas(shape, cell, sides, settings, solids=self._at, moves=moves, device=device) if self.far_field else None
        began = bounds_of(start)
        self._open(self._holding(fitted([began or Window((0, 0, 0), (1, 1, 1))], MARGIN, shape)))

    # ------------------------------------------------------------ the active box

    def _open(self, window: Window) -> None:
        """Make the engine of an active box, with air at rest."""
        self.near = NearGas(
            window, self.shape, self.far, self.sides, self.cell, self.settings, solids=window.solids(self._at), **self._known
        )
        self._feed()
        if self._spark.any():
            self.near.ignite(self._spark[window.cells])

    @property
    def window(self) -> Window:
        """The active box."""
        return self.near.window

    def _feed(self) -> None:
        """Let the engine have its part of the sources."""
        at = self.window.cells
        self.near.emit(self._rate[at], self._content[at] if self._content.ndim > 1 else self._content)
        self.near.heat(self._heating[at])

    def _follow(self, changed: NDArray[np.bool_] | None) -> None:
        """Grow, or come in, before a step; `changed` are cells whose room the step changes."""
        marks = [self._followed(SEEN)]
        for values in (self._rate, self._heating):
            marks.append(bounds_of(values != 0.0) if values.any() else None)
        marks.append(None if changed is None else bounds_of(changed))
        found = [w for w in marks if w is not None]
        if not found:
            return
        now = self.window
        wanted = fitted(found, MARGIN, self.shape, now)
        if self.near.steps % OFTEN == OFTEN - 1:
            wanted = shrunk(wanted, fitted(found, MARGIN, self.shape))
        wanted = self._holding(wanted)
        if wanted != now:
            self._change(wanted)

    def _followed(self, seen: float) -> Window | None:
        """Where there is gas, or where air is fast."""
        near = self.near
        inner = tuple(slice(0, n) for n in near.shape)
        state = np.abs(near.state)
        np.maximum(self._scale, state.max(axis=(0, 1, 2)), out=self._scale)
        least = np.where(self._scale > 0.0, seen * self._scale, np.inf).astype(np.float32)
        marks = (state > least).any(axis=-1)
        speed = np.abs(near.velocity[inner]).max(axis=-1)
        fastest = float(speed.max())
        if fastest > 0.0:
            marks |= speed > QUICK * fastest
        return bounds_of(marks, near.window.low)

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
        self._take()
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
        self.slipped[:4] += lost
        self._open(window)
        fields = window.solids(self._at)
        now.update({f"solids/{n}": getattr(fields, n) if self._moves else now[f"solids/{n}"] for n in ("room", "opening", "velocity")})
        now["ratio"] = np.ones(len(self.near.regions.sealed))
        self.near.unpack(now)
        self.near.fill(before)

    # ------------------------------------------------------------ sources

    def emit(self, rate: F64, content: Sequence[float] | F64) -> None:
        """As of `Gas`."""
        self._rate, self._content = rate, np.asarray(content, float)
        self._scale = np.maximum(self._scale, np.abs(self._content).reshape(-1, 4).max(axis=0))

    def heat(self, rate: F64) -> None:
        """As of `Gas`."""
        self._heating = rate

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
            after = enclosed(self.shape, self.sides, solids, widen=False)
            inner = tuple(slice(0, n) for n in self.shape)
            changed = (after.room != self._at.room)[inner] | after.velocity.any(axis=-1)[inner]
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
        self.slipped += by_side[np.array(self.window.inner(self.shape), bool)].sum(axis=0)

    def take(self) -> F64:
        """(5,) four amounts and the volume that have left since the last call, less what came in [cells]."""
        found, self._out = self._out, np.zeros(5)
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
        found = {**self.near.pack(), "active": np.array(self.window), "scale": self._scale, "slipped": self.slipped, "far": far}
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
        self._scale, self.slipped = found["scale"].copy(), found["slipped"].copy()
        if self.far is not None:
            self.far.rest()
            self.far.velocity = found["far"]


def _overlap(a: Window, b: Window, extra: int) -> tuple[tuple[slice, ...], tuple[slice, ...]]:
    """What two windows share, as parts of each; of fields with `extra` elements more than cells along each axis."""
    low = [max(x, y) for x, y in zip(a.low, b.low, strict=True)]
    high = [min(x, y) + extra for x, y in zip(a.high, b.high, strict=True)]
    mine, theirs = (tuple(slice(x - o, y - o) for x, y, o in zip(low, high, w.low, strict=True)) for w in (a, b))
    return mine, theirs
