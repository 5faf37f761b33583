"""Courses of rivers and streams over the cells of a grid."""

from __future__ import annotations

import numpy as np

from ..worlds.arrays import F64

__all__ = ["centre_line"]

SMOOTHING = (2.0, 1.0)
"""Cells, and widths of the channel, over which its course is smoothed, whichever is more: eight directions are too few for a
river, and bends are some ten widths long (Leopold & Wolman 1960)."""


def centre_line(cells: np.ndarray, width: float, shape: tuple[int, int], cell: float) -> F64:
    """Smoothed course [m] of a reach, shape (n, 2); its ends stay where they are.

    Args:
        cells: flat indices of the cells along the reach, shape (n,).
        width: of the channel [m].
        shape: (rows, cols) of the grid, which is centred at the origin with row 0 south.
        cell: side of a cell [m].
    """
    from scipy import ndimage

    rows, cols = shape
    column, row = cells % cols, cells // cols
    line = np.stack([column - 0.5 * (cols - 1), row - 0.5 * (rows - 1)], axis=1) * cell
    sigma = max(SMOOTHING[0], SMOOTHING[1] * width / cell)
    if len(line) < 4:
        return np.asarray(line)
    more = min(len(line) - 1, int(np.ceil(4.0 * sigma)))
    longer = np.pad(line, ((more, more), (0, 0)), mode="reflect", reflect_type="odd")
    smooth = ndimage.gaussian_filter1d(longer, sigma, axis=0, mode="nearest")[more:-more]
    smooth[0], smooth[-1] = line[0], line[-1]
    return np.asarray(smooth)
