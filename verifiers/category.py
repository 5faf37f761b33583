"""Category-specific checks (R99-R104). Rigid bodies are in `rigid.py`; no other category has an engine in this build."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..worlds.requirements import Row
from . import rigid
from .verdicts import correction, make_row

if TYPE_CHECKING:
    from ..worlds.candidate import Candidate

__all__ = ["check"]


def check(candidate: Candidate) -> list[Row]:
    """Rows of every solver instance, and one per entity whose category nothing here can simulate."""
    rows: list[Row] = []
    for solver in candidate.spec.simulation.rigid:
        rows += rigid.check_instance(candidate, solver)
    for name, entity in candidate.spec.entities.items():
        category = entity.physics.category
        if category == "rigid":
            continue
        rows.append(
            make_row(
                candidate,
                f"category:{name}",
                check="category",
                group="physical",
                predicate=f"{name} behaves as {category}",
                status="unverified",
                explanation=f"{name} is {category}, and this build has no engine for it, so there is nothing to inspect",
                entities=(name,),
                corrections=[
                    correction(
                        "no engine", "story", f"make {name} rigid, or leave it out", pointers=(f"/entities/{name}/physics",)
                    )
                ],
                evidence={"category": category, "pointers": [f"/entities/{name}/physics"]},
            )
        )
    return rows
