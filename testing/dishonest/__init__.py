"""Dishonest worlds: tricks on honest ones, by mechanism, each with the row or line that must give it away.

Written before it was tried what the gates catch. A case that is accepted is a hole, and stays in the list until it is closed.
"""

from __future__ import annotations

from collections.abc import Mapping

from . import bindings, claims, deeds, physics, pictures, words
from .cases import Case, Twin

__all__ = ["MECHANISMS", "Case", "Twin"]

MECHANISMS: Mapping[str, tuple[Case, ...]] = {
    **words.MECHANISMS,
    **claims.MECHANISMS,
    **bindings.MECHANISMS,
    **pictures.MECHANISMS,
    **physics.MECHANISMS,
    **deeds.MECHANISMS,
}
"""Cases by mechanism."""
