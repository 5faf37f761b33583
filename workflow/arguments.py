"""Arguments that several tools take alike: their types, ranges and descriptions, which are part of the tools' schemas."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from .rows import Detail

__all__ = ["Hypothesis", "Repair", "RowDetail", "Sketch", "WaitSeconds", "WeakeningReason", "WorldId"]

WorldId = Annotated[str, Field(description="World id")]
WaitSeconds = Annotated[
    float,
    Field(ge=0, le=240, description="Seconds to wait for the result (50 at most, unless the server allows more), then a job id"),
]
RowDetail = Annotated[Detail, Field(description="full: open rows with all evidence and causes")]
Hypothesis = Annotated[str, Field(description="After a failed row: what causes it and why this cures it")]
WeakeningReason = Annotated[
    str,
    Field(description="Only when the edit makes a requirement easier after evidence against it; printed with the acceptance"),
]


class Repair(BaseModel):
    """One of several repairs in one edit."""

    model_config = ConfigDict(extra="forbid")
    row: Annotated[str, Field(description="failing row that it answers")]
    group: Annotated[str, Field(description="parameter group, or field, that it changes")]
    expect: Annotated[Literal["higher", "lower"], Field(description="where the row's measured value should go")]
    hypothesis: Annotated[str, Field(min_length=10, max_length=2000)]


class Sketch(BaseModel):
    """Part of a motion to simulate, and how coarse."""

    model_config = ConfigDict(extra="forbid")
    until: Annotated[int | str, Field(description="last frame, or a beat: to its last frame")]
    coarser: Annotated[float, Field(ge=1, le=4, description="factor of spacings, cells and radii")] = 2.0
    steps: Annotated[float, Field(ge=1, le=4, description="factor of the step of rigid instances")] = 1.0
    only: Annotated[
        list[str] | None,
        Field(min_length=1, max_length=16, description="instances; those that they exchange with or read run along"),
    ] = None
