"""Bodies that may break: their pieces are parts, and bricks show tones of their own before a wall breaks."""

from __future__ import annotations

import hashlib

from .layer import PartsLayer

__all__ = ["BreakableLayer"]

TONES = (0.8, 0.92, 1.0, 1.08)
"""Factors on the colour of bricks, which no two kiln loads give one colour; own choice. Without them courses show only where a wall has moved."""


class BreakableLayer(PartsLayer):
    """Walls of bricks, and bodies cut into cells."""

    def tone(self, entity: str, part: str) -> float:
        """Share of the material's colour that a part shows; 1 for all but bricks."""
        breakable = self.candidate.spec.entities[entity].breakable
        if breakable is None or breakable.pattern.kind != "bricks":
            return 1.0
        return TONES[hashlib.blake2b(f"{entity}/{part}".encode(), digest_size=1).digest()[0] % len(TONES)]
