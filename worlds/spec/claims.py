"""Claims: what each span of the prompt means, and where it is judged (R2, R155)."""

from __future__ import annotations

from typing import Annotated, Literal, get_args

from pydantic import Field, StringConstraints, model_validator

from ..vocabulary import Id, SpecModel

__all__ = ["CLAIM_TYPES", "Claim", "ClaimType"]

ClaimType = Literal[
    "thing", "count", "quantity", "property", "event", "order", "negation", "place", "time", "weather", "look", "route"
]
CLAIM_TYPES: tuple[ClaimType, ...] = get_args(ClaimType)
Target = Annotated[
    str, StringConstraints(pattern=r"^/(entities|terrains|materials|graph|story|shots|simulation|look)/.+", max_length=300)
]


class Claim(SpecModel):
    """Meaning of one span of the prompt: what `by` names is judged for it, and must be what its type asks for."""

    quote: Annotated[str, StringConstraints(min_length=1, max_length=300)] = Field(description="exactly as in the prompt")
    nth: int = Field(default=1, ge=1, le=1000, description="which of the equal texts of the prompt, from 1")
    type: ClaimType
    by: Annotated[list[Target], Field(max_length=500)] = Field(default=[], description="pointers to what is judged for it")
    same_as: Id | None = Field(
        default=None, description="claim of another span that speaks of the very same, or of all of which `by` names some"
    )
    waived: Annotated[str, StringConstraints(min_length=10, max_length=300)] | None = Field(
        default=None, description="why nothing is judged for it; printed with the acceptance, and counted"
    )

    @model_validator(mode="after")
    def _one_of_two(self) -> Claim:
        if self.waived is None and not self.by and self.same_as is None:
            raise ValueError("give by (pointers to what is judged), same_as, or waived with a reason")
        if self.waived is not None and self.by:
            raise ValueError("a claim that is waived names nothing in by; give one of the two")
        return self
