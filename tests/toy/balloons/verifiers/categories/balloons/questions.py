"""Questions about balloons, and the bound of their answers."""

from __future__ import annotations

from ...rows.questions import Question

__all__ = ["BALANCE", "LEDGER", "QUESTIONS", "ROUNDING"]

ROUNDING = 1e-4
"""Share of an impulse up to which float32 channels leave a balance open. Own choice: ten times their rounding."""
LEDGER = Question(
    "category:balloons:ledger",
    "momentum of the balloons of {0} is what weight, lift and drag gave them",
    "largest open share of the impulse since frame 0",
    "1",
    "<=",
    "ROUNDING",
    ("solver",),
)
BALANCE = Question(
    "category:balloons:balance",
    "over every frame, mass times change of velocity of each balloon of {0} is its lift less its drag times its way",
    "largest open share of the impulse over a frame",
    "1",
    "<=",
    "ROUNDING",
    ("solver",),
)
QUESTIONS = (LEDGER, BALANCE)
