"""Vocabulary shared by specification and predicates: ids, references, vectors, intervals."""

from __future__ import annotations

import math
import posixpath
from dataclasses import dataclass
from typing import Annotated, Any, Literal, cast

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, GetCoreSchemaHandler, StringConstraints
from pydantic_core import core_schema

__all__ = [
    "BeatRef",
    "EntityRef",
    "Finite",
    "FrameInterval",
    "Id",
    "InAssets",
    "JointRef",
    "MaterialRef",
    "NodeRef",
    "NonNegative",
    "OwnerRef",
    "Positive",
    "Ref",
    "RegionRef",
    "SolverRef",
    "SpecModel",
    "Text",
    "Vec2",
    "Vec3",
]

ID_PATTERN = r"^[A-Za-z][A-Za-z0-9_-]{0,63}$"


class SpecModel(BaseModel):
    """Base of every specification model: unknown keys are errors, numbers are finite."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, frozen=True, ser_json_inf_nan="null")


RefTarget = Literal["entity", "part", "region", "node", "beat", "solver", "driver", "joint", "material", "owner"]


@dataclass(frozen=True)
class Ref:
    """Marks a string field as a reference, so that the audit can resolve every one of them.

    `node` is an entity or a region; `owner` is a solver instance or a driver.
    """

    target: RefTarget


Id = Annotated[str, StringConstraints(pattern=ID_PATTERN)]
EntityRef = Annotated[str, StringConstraints(pattern=ID_PATTERN), Ref("entity")]
RegionRef = Annotated[str, StringConstraints(pattern=ID_PATTERN), Ref("region")]
NodeRef = Annotated[str, StringConstraints(pattern=ID_PATTERN), Ref("node")]
BeatRef = Annotated[str, StringConstraints(pattern=ID_PATTERN), Ref("beat")]
SolverRef = Annotated[str, StringConstraints(pattern=ID_PATTERN), Ref("solver")]
JointRef = Annotated[str, StringConstraints(pattern=ID_PATTERN), Ref("joint")]
MaterialRef = Annotated[str, StringConstraints(pattern=ID_PATTERN), Ref("material")]
OwnerRef = Annotated[str, StringConstraints(pattern=ID_PATTERN), Ref("owner")]

Text = Annotated[str, StringConstraints(max_length=2000)]


def _in_assets(path: str) -> str:
    # Links inside the folder are judged where the file is opened.
    if posixpath.isabs(path) or posixpath.normpath(path).split("/")[0] == "..":
        raise ValueError(f"path {path!r} leads out of 'assets'; give a relative path inside it")
    return path


InAssets = AfterValidator(_in_assets)
"""Marks the path of a file as one inside the world's `assets/` folder."""


def _bounded(value: float) -> float:
    if not math.isfinite(value) or abs(value) > 1e9:
        raise ValueError("must be finite and within +-1e9")
    return value


Finite = Annotated[float, AfterValidator(_bounded)]


@dataclass(frozen=True)
class _AtMost:
    """Upper bound of numbers whose field gives none of its own. Of two `le` pydantic would keep the type's and drop the field's."""

    value: float

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        schema: Any = handler(source)
        if schema["type"] == "float":
            schema["le"] = min(schema.get("le", self.value), self.value)
        return cast("core_schema.CoreSchema", schema)


Positive = Annotated[float, Field(gt=0), _AtMost(1e9)]
NonNegative = Annotated[float, Field(ge=0), _AtMost(1e9)]
Vec2 = tuple[Finite, Finite]
Vec3 = tuple[Finite, Finite, Finite]


def _ordered(value: tuple[int, int]) -> tuple[int, int]:
    if value[1] < value[0]:
        raise ValueError("frames [first, last]: last must be >= first")
    return value


FrameInterval = Annotated[
    tuple[Annotated[int, Field(ge=0)], Annotated[int, Field(ge=0)]],
    AfterValidator(_ordered),
    Field(description="[first, last], 0-based, inclusive"),
]
