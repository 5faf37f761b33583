"""Fluvial and thermal erosion of a landscape, with a ledger of the mass moved.

Outputs stay fields: what is bedrock, what lies loose on it, where it wore and where it was deposited.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import ndimage

from ...worlds.arrays import F64
from ...worlds.errors import InputError
from .flood import drain
from .grid import Grid
from .slices import SLICE, in_slices

__all__ = ["Ground", "MassBalance", "Rivers", "erode_rivers", "relax_slopes"]

AREA_EXPONENT = 0.45
"""m / n of the stream power law, the concavity of graded rivers: 0.4 to 0.6 (Whipple & Tucker 1999; Kirby & Whipple 2012)."""
TALUS_RATE = 0.5
TALUS_RESIDUAL = 1e-3
"""Excess of slope at which relaxation counts as done [m/m]."""


@dataclass(frozen=True)
class MassBalance:
    """Volumes of one process [m^3], solid matter without pores."""

    worn: float
    deposited: float
    exported: float
    uplifted: float = 0.0

    def __add__(self, other: MassBalance) -> MassBalance:
        return MassBalance(
            self.worn + other.worn,
            self.deposited + other.deposited,
            self.exported + other.exported,
            self.uplifted + other.uplifted,
        )

    def times(self, factor: float) -> MassBalance:
        """In another unit."""
        return MassBalance(self.worn * factor, self.deposited * factor, self.exported * factor, self.uplifted * factor)

    @property
    def residual(self) -> float:
        """Imbalance of the ledger, relative to the volume worn."""
        return abs(self.worn - self.deposited - self.exported) / max(self.worn, 1e-12)


@dataclass(frozen=True)
class Ground:
    """Rock and what lies on it. Fields of shape (rows, cols), in metres."""

    grid: Grid
    bedrock: F64
    sediment: F64
    """Loose matter on the bedrock, >= 0."""
    wear: F64
    """Removed so far, >= 0."""
    deposit: F64
    """Laid down so far, >= 0."""
    uplift: F64
    """Raised so far, >= 0."""
    earthworks: F64
    """Raised (positive) or cut by late layers."""

    @classmethod
    def bare(cls, grid: Grid, height: F64, *, soil: F64 | float = 0.0) -> Ground:
        """Rock with a layer of soil [m] below the given surface [m]."""
        loose = np.broadcast_to(np.asarray(soil, dtype=np.float64), grid.shape).copy()
        none = np.zeros(grid.shape)
        return cls(grid, height - loose, loose, none, none, none, none)

    @property
    def height(self) -> F64:
        """Surface of the ground [m]."""
        return self.bedrock + self.sediment

    def copied(self) -> Ground:
        """With fields of its own."""
        return Ground(
            self.grid, *(a.copy() for a in (self.bedrock, self.sediment, self.wear, self.deposit, self.uplift, self.earthworks))
        )

    def reshaped(self, change: F64) -> Ground:
        """After people or late layers raised or cut the surface by `change` [m]: cuts take loose matter first."""
        loose = np.minimum(np.maximum(-change, 0.0), self.sediment)
        return replace(
            self,
            bedrock=self.bedrock + change + loose,
            sediment=self.sediment - loose,
            earthworks=self.earthworks + change,
        )


@dataclass(frozen=True)
class Rivers:
    """Law of rivers and creep, and the time for which it holds."""

    years: float
    """Time modelled."""
    steps: int
    """Time steps; the drainage is found anew in each."""
    erodibility: F64 | float
    """K [m^(1-2m)/year], a number or a field."""
    creep: float = 0.0
    """D [m^2/year]."""
    uplift: F64 | float = 0.0
    """U [m/year]; not applied to cells that keep their height."""
    exponent: float = AREA_EXPONENT
    """m."""

    def __post_init__(self) -> None:
        if self.years <= 0 or not 1 <= self.steps <= 1000:
            raise InputError(f"years {self.years} must be > 0 and steps {self.steps} from 1 to 1000")


def erode_rivers(
    ground: Ground, rivers: Rivers, *, base: np.ndarray | None = None, valid: np.ndarray | None = None
) -> tuple[Ground, MassBalance]:
    """Let rivers cut valleys and slopes creep: dz/dt = U - K A^m S + D laplace(z) (n = 1), implicit, stable at any step.

    What rivers wear away travels downstream in the same step and fills the basins on its way; the rest leaves the grid.
    Creep rounds what is narrower than it reaches, so that valleys have a size of their own and not that of the cells
    (Perron, Kirchner & Dietrich 2009, doi:10.1038/nature08174).

    Args:
        ground: the land.
        rivers: law and time.
        base: cells that keep their height (the sea), shape (rows, cols).
        valid: where there is land; default everywhere.

    References:
        Braun & Willett 2013, doi:10.1016/j.geomorph.2012.10.008
    """
    grid, dt = ground.grid, rivers.years / rivers.steps
    known = np.ones(grid.shape, dtype=bool) if valid is None else valid
    fixed = ~known if base is None else base | ~known
    factor, rise = (
        np.where(fixed, 0.0, np.broadcast_to(np.asarray(rate, dtype=np.float64), grid.shape) * dt)
        for rate in (rivers.erodibility, rivers.uplift)
    )
    # Of the sea only the shore takes part: water that is there is gone.
    drained = known if base is None else known & (~base | ndimage.binary_dilation(known & ~base, np.ones((3, 3))))
    if not drained.any():
        drained = known
    ground = ground.copied()
    total = MassBalance(0.0, 0.0, 0.0)
    for _ in range(rivers.steps):
        ground.bedrock[...] += rise
        ground.uplift[...] += rise
        worn, laid, left = _incised(ground, drained, fixed, rivers.exponent, factor)
        if rivers.creep > 0:
            change, out = _crept(ground.height, fixed, known, rivers.creep * dt / grid.cell_area)
            _move(ground, change)
            worn, laid, left = worn - float(change[change < 0].sum()), laid + float(change[change > 0].sum()), left + out
        total = total + MassBalance(worn, laid, left, float(rise.sum())).times(grid.cell_area)
    return ground, total


def _incised(ground: Ground, drained: np.ndarray, fixed: np.ndarray, exponent: float, factor: F64) -> tuple[float, float, float]:
    """Heights worn, laid down and carried out of the grid [m], summed over cells, by one step of the rivers; changes the ground."""
    from .erosion_kernels import incise, settle_sediment

    grid, height = ground.grid, ground.height
    drainage = drain(grid, height, valid=drained)
    receiver = drainage.receiver.ravel()
    strength = _strength(drainage.accumulation(), exponent, factor).ravel()
    new = incise(height.ravel(), drainage.filled.ravel(), receiver, drainage.order, grid.cols, grid.cell, strength)
    removed = np.where(drained, height - new.reshape(grid.shape), 0.0)
    depth = np.where(fixed, 0.0, np.nan_to_num(drainage.depth, copy=False))
    label, count = ndimage.label(depth > 0, np.ones((3, 3)))
    volume = np.bincount(label.ravel(), weights=depth.ravel(), minlength=count + 1)
    kept, left = settle_sediment(removed.ravel(), label.ravel(), volume.copy(), receiver, drainage.order)
    # Fine matter settles out of the whole column: more where the water is deep.
    share = np.divide(kept, volume, out=np.zeros_like(kept), where=volume > 0)
    _move(ground, depth * share[label] - removed)
    return float(removed.sum()), float(kept.sum()), float(left)


def _strength(area: F64, exponent: float, factor: F64) -> F64:
    """`factor` times `area` to the power `exponent`."""
    found = np.empty_like(area)

    def work(first: int, last: int) -> None:
        np.power(area[first:last], exponent, out=found[first:last])
        found[first:last] *= factor[first:last]

    in_slices(len(area), work)
    return found


def _move(ground: Ground, change: F64) -> None:
    """Raise or lower the surface by `change` [m] in place: loose matter goes first, then rock wears."""
    from .erosion_kernels import move

    flat = [a.reshape(-1) for a in (ground.bedrock, ground.sediment, ground.wear, ground.deposit, change)]
    in_slices(change.size, lambda first, last: move(*flat, first, last), size=SLICE * change.shape[1])


def _crept(height: F64, fixed: np.ndarray, known: np.ndarray, number: float) -> tuple[F64, float]:
    """Change of height [m] by implicit diffusion, along rows and then along columns, and what flowed into fixed cells [m]."""
    from .erosion_kernels import creep_cols, creep_rows

    half, new = np.empty_like(height), np.empty_like(height)
    rows, cols = height.shape
    gone = in_slices(rows, lambda first, last: creep_rows(height, fixed, known, number, half, first, last))
    gone += in_slices(cols, lambda first, last: creep_cols(half, fixed, known, number, new, first, last))
    return new - height, float(sum(gone))


def relax_slopes(
    ground: Ground,
    *,
    talus: float = 0.65,
    talus_rock: float = 1.7,
    sweeps: int = 20000,
    valid: np.ndarray | None = None,
) -> tuple[Ground, float, int]:
    """Let slopes slide until none is steeper than its angle of repose.

    Args:
        ground: the land.
        talus: tangent of the angle of repose of loose matter; 0.65 is 33 degrees (dry scree 30 to 38).
        talus_rock: tangent of the steepest slope that rock keeps; 1.7 is 60 degrees.
        sweeps: most passes; they end when the residual is reached.
        valid: where there is land.

    Returns:
        the land, the largest excess of slope that is left [m/m], passes done.
    """
    from .erosion_kernels import slump

    if not 0 < talus <= talus_rock:
        raise InputError(f"talus {talus} must be > 0 and not above talus_rock {talus_rock}")
    grid = ground.grid
    known = np.ones(grid.shape, dtype=bool) if valid is None else valid
    rock, loose, done, worst = slump(
        ground.bedrock.ravel(), ground.sediment.ravel(), known.ravel(), grid.rows, grid.cols, grid.cell,
        talus, talus_rock, TALUS_RATE, sweeps, TALUS_RESIDUAL,
    )  # fmt: skip
    bedrock, sediment = rock.reshape(grid.shape), loose.reshape(grid.shape)
    change = bedrock + sediment - ground.height
    return (
        replace(
            ground,
            bedrock=bedrock,
            sediment=sediment,
            wear=ground.wear + np.maximum(-change, 0.0),
            deposit=ground.deposit + np.maximum(change, 0.0),
        ),
        float(worst),
        int(done),
    )
