"""Arguments that several tools take alike: their types, ranges and descriptions, which are part of the tools' schemas."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from .rows import Detail

__all__ = ["Hypothesis", "RowDetail", "WaitSeconds", "WorldId"]

WorldId = Annotated[str, Field(description="World id")]
WaitSeconds = Annotated[
    float,
    Field(ge=0, le=240, description="Seconds to wait for the result (50 at most, unless the server allows more), then a job id"),
]
RowDetail = Annotated[Detail, Field(description="full: open rows with all evidence and causes")]
Hypothesis = Annotated[str, Field(description="After a failed row: what causes it and why this cures it")]
