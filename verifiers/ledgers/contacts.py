"""Contacts that the log of a rigid instance holds, in one piece."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...worlds.arrays import F64
from ...worlds.errors import EvidenceError

__all__ = ["CONTACT_CHANNELS", "Contacts", "logged_contacts"]

CONTACT_CHANNELS = ("contact/pair", "contact/impulse", "contact/vector")
"""Channels that the log is read from."""


@dataclass(frozen=True)
class Contacts:
    """All logged contacts, one row per pair and frame; row i is of the interval that ends at `frame[i]`."""

    frame: NDArray[np.int64]
    a: NDArray[np.int64]
    """Index into `CacheIndex.colliders`."""
    b: NDArray[np.int64]
    impulse: F64
    """Normal impulse [N s]."""
    given: F64
    """Impulse on b, friction included [N s], shape (contacts, 3); the opposite acts on a."""


def logged_contacts(frames: Sequence[Mapping[str, Any]]) -> Contacts:
    """The log of all frames in one piece; what frame 0 holds is of no interval.

    Args:
        frames: the channels of every frame.

    Raises:
        EvidenceError: rows of the channels do not fit.
    """
    counts = [len(f["contact/impulse"]) for f in frames]
    for name, width in (("pair", 2), ("vector", 3)):
        if any(f[f"contact/{name}"].shape != (n, width) for f, n in zip(frames, counts, strict=True)):
            raise EvidenceError(f"contact/{name} and contact/impulse have different lengths; bake again")
    pairs = np.concatenate([f["contact/pair"] for f in frames]).astype(np.int64).reshape(-1, 2)
    impulse = np.concatenate([f["contact/impulse"] for f in frames]).astype(np.float64)
    given = np.concatenate([f["contact/vector"] for f in frames]).astype(np.float64)
    frame = np.repeat(np.arange(len(frames)), counts)
    later = frame > 0
    return Contacts(frame[later], pairs[later, 0], pairs[later, 1], impulse[later], given[later])
