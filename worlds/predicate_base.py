"""What several predicate models share: subjects, when a truth per frame becomes a verdict, and bands of values."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import StringConstraints, model_validator

from .vocabulary import Finite, Ref, SpecModel

__all__ = ["Band", "Subject", "When"]

When = Literal["eventually", "always", "end"]
Subject = Annotated[str, StringConstraints(pattern=r"^[A-Za-z][A-Za-z0-9_-]{0,63}$"), Ref("entity")]
"""An entity id, or `each` inside `count`."""


class Band(SpecModel):
    """A measured value that must lie in [min, max]; one of them may be left out."""

    min: Finite | None = None
    max: Finite | None = None

    @model_validator(mode="after")
    def _some_bound(self) -> Band:
        if self.min is None and self.max is None:
            raise ValueError("give min, max or both")
        if self.min is not None and self.max is not None and self.min > self.max:
            raise ValueError("min must be <= max")
        return self
