"""Parametric generators of things: parameters with units and ranges in, bodies with parts and joints out (R52, R94)."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, TypeVar

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from ...worlds.errors import InputError
from ...worlds.hints import did_you_mean
from .made import Made

__all__ = ["Generator", "Parameters", "material"]

P = TypeVar("P", bound="Parameters")


class Parameters(BaseModel):
    """Parameters of a generator: lengths in m, ranges and defaults in the schema."""

    model_config = ConfigDict(extra="forbid", frozen=True)


def material(default: str, *others: str, of: str = "") -> Any:
    """A field that names a row of the table of materials, or a material that the world declares.

    Args:
        default: name of the row.
        others: rows that suit as well, for variation.
        of: what is made of it, where an asset has several materials.
    """
    said = f"material{' of ' + of if of else ''}: {', '.join((default, *others))}, or any other of the table or the world"
    return Field(
        default=default, min_length=1, max_length=64, description=said, json_schema_extra={"choices": [default, *others]}
    )


@dataclass(frozen=True)
class Generator:
    """A kind of thing and how it is made."""

    name: str
    summary: str
    """One line: what it is, and what of it moves."""
    model: type[Parameters]
    build: Callable[[Any, np.random.Generator], Made]
    """Bodies from parameters; equal parameters and random numbers give equal bodies."""
    tags: tuple[str, ...] = ()
    """Other words by which it is found."""
    motion: Literal["static", "dynamic"] = "dynamic"
    """Motion of its main body, where nothing else is asked for."""
    stands: bool = True
    """It stands by itself on level ground."""

    def make(self, parameters: Mapping[str, Any], seed: int) -> Made:
        """Bodies of one such thing.

        Args:
            parameters: those that differ from the defaults, as JSON.
            seed: of its variation; the same seed makes the same thing.

        Raises:
            InputError: a parameter is unknown or out of range, or they leave no room for a part.
        """
        try:
            given = self.model.model_validate(dict(parameters))
        except ValidationError as error:
            raise InputError("\n".join(self._told(dict(e)) for e in error.errors(include_url=False)[:8])) from error
        return self.build(given, np.random.default_rng([seed, zlib.crc32(self.name.encode())]))

    def _told(self, error: Mapping[str, Any]) -> str:
        name = ".".join(str(p) for p in error["loc"])
        if error["type"] == "extra_forbidden":
            hint = did_you_mean(name, self.model.model_fields) or ";"
            return f"{self.name} has no parameter {name[:60]!r}{hint} it has {', '.join(self.model.model_fields)}"
        return f"parameter {name!r} of {self.name}: {error['msg']} (got {str(error.get('input'))[:60]})"
