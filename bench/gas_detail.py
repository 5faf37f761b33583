"""Detail of a flow on a grid: enstrophy over energy, and the spectrum of kinetic energy by wave number.

Both are shares of the flow's own energy, so that two solvers with other units of speed can be compared at the same stage of one scene.
"""

from __future__ import annotations

import numpy as np

from ..worlds.arrays import F64

__all__ = ["centred", "detail", "spectrum"]

RIM = 2
"""Own choice: cells at the sides that enstrophy leaves out, where solvers treat the air beyond in their own ways."""
SHARES = (16, 8, 4)
"""Wave numbers, as cells of the side over these, from which on the energy is told; a side over 4 is a vortex of 4 cells."""


def centred(faces: F64) -> F64:
    """Velocities in the middle of cells, shape (nx, ny, nz, 3), of those of lower faces, shape (nx + 1, ny + 1, nz + 1, 3)."""
    cells = tuple(slice(0, n - 1) for n in faces.shape[:3])
    found = np.empty((*(n - 1 for n in faces.shape[:3]), 3))
    for axis in range(3):
        upper = tuple(slice(1, None) if a == axis else s for a, s in enumerate(cells))
        found[..., axis] = 0.5 * (faces[cells][..., axis] + faces[upper][..., axis])
    return found


def _curl(velocity: F64) -> F64:
    """Vorticity by central differences [speed / cell]."""
    slope = [[np.gradient(velocity[..., component], axis=along) for along in range(3)] for component in range(3)]
    return np.stack([slope[2][1] - slope[1][2], slope[0][2] - slope[2][0], slope[1][0] - slope[0][1]], axis=-1)


def spectrum(velocity: F64) -> F64:
    """Share of the kinetic energy at each whole wave number, [waves / side], of a cube of cells, faded out towards its sides (Hann)."""
    cells = velocity.shape[0]
    window = np.hanning(cells + 2)[1:-1]
    faded = velocity * (window[:, None, None] * window[None, :, None] * window[None, None, :])[..., None]
    energy = (np.abs(np.fft.fftn(faded, axes=(0, 1, 2))) ** 2).sum(axis=-1)
    wave = np.fft.fftfreq(cells) * cells
    number = np.sqrt(wave[:, None, None] ** 2 + wave[None, :, None] ** 2 + wave[None, None, :] ** 2).round().astype(np.int64)
    found = np.bincount(number.ravel(), energy.ravel())[: cells // 2 + 1]
    return np.asarray(found / found.sum())


def detail(velocity: F64) -> dict[str, float]:
    """Enstrophy over energy [1 / cell^2] and the shares of the energy in small waves, of velocities in a cube of cells (n, n, n, 3)."""
    inner = (slice(RIM, -RIM),) * 3
    shares, cells = spectrum(velocity), velocity.shape[0]
    found = {"enstrophy_per_energy": float(np.square(_curl(velocity)[inner]).sum() / np.square(velocity[inner]).sum())}
    return found | {f"energy_from_n_{part}_on": float(shares[cells // part :].sum()) for part in SHARES}
