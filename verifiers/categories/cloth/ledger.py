"""Mass, momentum and energy of cloth: what the vertices have against what was recorded and given."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ....worlds.arrays import F64
from ...rows.corrections import bake_again
from .bounds import BOOKS, CUT, ROUNDING, SINGLE
from .frames import at_most, halved

if TYPE_CHECKING:
    from ...rows.findings import Finding
    from .frames import ClothRun

__all__ = ["energy", "kept_mass", "kept_records", "momentum", "uncut"]

GIVERS = ("air", "hold", "solid", "load", "cut")


def _worst(series: F64, bound: F64) -> tuple[int, float, float]:
    """Frame where a series is largest against its bound, and both there."""
    k = int(np.argmax(series / np.maximum(bound, 1e-300)))
    return k, float(series[k]), float(bound[k])


def kept_mass(run: ClothRun) -> Finding:
    """Recorded mass against area times area density."""
    recorded, wanted = run.record("mass"), float(run.mass.sum())
    off = np.abs(recorded - wanted) / wanted
    k = int(off.argmax())
    text = f"the cloth weighs {recorded[k]:.6g} kg at frame {k}, by its area {wanted:.6g} kg"
    return at_most(text, float(off[k]), ROUNDING, "1", k, bake_again("the cache is of another run"))


def kept_records(run: ClothRun) -> Finding:
    """Recorded momentum and energies against those of the vertices."""
    momenta, kinetic, potential = run.sums
    told = np.stack([run.record(f"momentum_{a}") for a in "xyz"], axis=1)
    size = np.sqrt(2.0 * run.mass.sum() * np.maximum(kinetic, 0.0))
    pairs = [
        (np.linalg.norm(told - momenta, axis=1), SINGLE * size + 1e-12),
        (np.abs(run.record("kinetic_energy") - kinetic), 2 * SINGLE * kinetic + 1e-12),
        (np.abs(run.record("potential_energy") - potential), ROUNDING * (np.abs(potential) + np.abs(potential).max()) + 1e-12),
    ]
    share = np.max([value / bound for value, bound in pairs], axis=0)
    k = int(share.argmax())
    text = f"records differ from the vertices by at most {share[k]:.3g} of what single precision allows (frame {k})"
    return at_most(text, float(share[k]), 1.0, "1", k, bake_again("the cache was edited"))


def _given(run: ClothRun) -> F64:
    """Impulses since frame 0, (givers, F, 3) [N s]."""
    return np.stack([np.stack([run.record(f"{g}_impulse_{a}") for a in "xyz"], axis=1) for g in GIVERS])


def _through(run: ClothRun) -> F64:
    """Momentum that has passed through the cloth since frame 0, at least (F,) [N s]."""
    momenta, kinetic, _ = run.sums
    time = np.arange(len(momenta)) / run.candidate.spec.simulation.fps
    weight = float(run.mass.sum() * np.linalg.norm(run.candidate.spec.simulation.gravity))
    parts = np.abs(np.diff(_given(run), axis=1)).sum(axis=(0, 2))
    return np.asarray(
        weight * time + np.concatenate([[0.0], np.cumsum(parts)]) + np.sqrt(2 * run.mass.sum() * kinetic.max()) + 1e-9
    )


def momentum(run: ClothRun) -> Finding:
    """Change of momentum since frame 0 against gravity and all that gave some."""
    momenta, _, _ = run.sums
    spec = run.candidate.spec.simulation
    moving = np.maximum(np.arange(len(momenta)) / spec.fps - run.start, 0.0)
    wanted = run.mass.sum() * moving[:, None] * np.array(spec.gravity) + _given(run).sum(axis=0)
    off = np.linalg.norm(momenta - momenta[0] - wanted, axis=1)
    k, value, bound = _worst(off, BOOKS * _through(run))
    text = f"momentum is off by {value:.3g} N s at frame {k}, allowed {bound:.3g} N s"
    return at_most(text, value, bound, "N s", k, bake_again("the cache was edited, or an impulse is missing"))


def energy(run: ClothRun) -> Finding:
    """Energy beyond that of frame 0 and all work done on the cloth, against the scale of the energies."""
    _, kinetic, potential = run.sums
    total = kinetic + potential + run.record("stretch_energy") + run.record("bending_energy")
    work = sum(run.record(f"{giver}_work") for giver in GIVERS if giver != "cut")
    gain = total - total[0] - work
    moved = np.abs(np.diff(work, prepend=0.0)).cumsum()
    scale = max(float(kinetic.max()), float(np.ptp(potential)), float(moved[-1]), 1e-9)
    growth = run.candidate.spec.simulation.limits.energy_growth
    share = gain / scale
    k = int(share.argmax())
    text = f"energy from nowhere is {share[k]:.3%} of {scale:.4g} J at frame {k}, allowed {growth:.1%}"
    return at_most(text, float(share[k]), growth, "1", k, halved(run, "the step is too long"))


def uncut(run: ClothRun) -> Finding:
    """Momentum lost where ways were cut short, frame by frame, against what passed through the cloth."""
    lost = np.linalg.norm(np.diff(_given(run)[GIVERS.index("cut")], axis=0, prepend=0.0), axis=1).cumsum()
    k, value, bound = _worst(lost, CUT * _through(run))
    text = f"{value:.3g} N s were lost by frame {k}, allowed {bound:.3g} N s; {int(run.record('cut_vertices').sum())} vertices were cut short"
    hint = halved(run, "sheets meet faster than a step resolves")
    return at_most(text, value, bound, "N s", k, hint)
