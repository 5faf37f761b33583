"""Speeds and turns of bodies, as the laws of rigid bodies compare them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ....worlds.arrays import F64
    from ...ledgers.balance import Books

__all__ = ["angle_of", "most_of_bodies", "surface_speeds"]


def angle_of(turn: F64) -> F64:
    """Angles of rotation matrices [rad], (..., 3, 3) to (...): |R - 1| (Frobenius) = 2 sqrt(2) sin(angle / 2)."""
    half = np.linalg.norm(turn - np.eye(3), axis=(-2, -1)) / np.sqrt(8.0)
    return np.asarray(2.0 * np.arcsin(np.clip(half, 0.0, 1.0)))


def most_of_bodies(books: Books, values: F64) -> F64:
    """Largest value of each entity's bodies, (n, bodies) to (n, entities)."""
    result = np.full((len(values), len(books.entities)), -np.inf)
    np.maximum.at(result.T, books.owner, values.T)
    return result


def surface_speeds(books: Books) -> F64:
    """Most that a point of each entity's surface can move at each frame [m/s], shape (F, E)."""
    return most_of_bodies(books, np.linalg.norm(books.velocity, axis=2) + np.linalg.norm(books.spin, axis=2) * books.body_reach)
