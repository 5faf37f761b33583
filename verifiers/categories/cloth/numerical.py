"""Numbers of cloth: finite, and no faster than allowed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...rows.findings import Finding
from .frames import at_most, halved

if TYPE_CHECKING:
    from .frames import ClothRun

__all__ = ["finite", "slow"]


def finite(run: ClothRun) -> Finding:
    """Every channel and record."""
    for k in range(run.candidate.frame_count):
        for name, values in run.cache.read(k).items():
            count = int((~np.isfinite(values)).sum())
            if count:
                hint = halved(run, "the step is too long for the sheet")
                return at_most(f"channel {name!r} is not finite at frame {k}", float(count), 0.0, "1", k, hint)
    return Finding("pass", "every channel is finite on every frame", 0.0, 0.0, "1")


def slow(run: ClothRun) -> Finding:
    """Fastest vertex, by its recorded peak and as written."""
    bound = run.candidate.spec.simulation.limits.max_speed
    written = [float(np.linalg.norm(run.frame(k)[1], axis=1).max()) for k in range(run.candidate.frame_count)]
    speed = np.maximum(run.record("max_speed"), written)
    k = int(speed.argmax())
    text = f"the fastest vertex has {speed[k]:.4g} m/s at frame {k}, allowed {bound:g} m/s"
    hint = halved(run, "the step is too long for the sheet")
    return at_most(text, float(speed[k]), bound, "m/s", k, hint)
