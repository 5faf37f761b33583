"""Checks that an evaluation switches off on purpose (R152), and the mark that keeps what comes of it from being an acceptance.

The harness alone sets the variable, for a server of its own. Such a server's rows of those checks are `not_applicable`, its
ledger and its replies carry the name of the ablation, its freezes are other hashes, and its verdict is never `accepted`.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import get_args

from .errors import InputError, RefusedError
from .requirements import Check, Row

__all__ = ["ABLATED", "ABLATIONS", "ENV_ABLATION", "ablation", "ablation_words", "marked", "require_whole", "switched_off"]

ENV_ABLATION = "WORLDAGENT_ABLATION"
"""Environment variable of a server in evaluation: the name of its ablation."""
ABLATIONS: Mapping[str, frozenset[Check]] = {
    "navigability": frozenset({"navigability"}),
    "static": frozenset({"interpenetration", "support"}),
    "category": frozenset({"category"}),
    "causal": frozenset({"causal"}),
    "all": frozenset(get_args(Check)) - {"audit", "delivery"},
}
"""Checks that each ablation switches off. `all` leaves what tells a world from none: that its specification can be built and its
frames are those that were baked."""
ABLATED = "ablated"
"""Verdict where nothing is open and checks were switched off."""


def ablation() -> str:
    """Name of the ablation of this process; empty where every check judges.

    Raises:
        InputError: the variable names none.
    """
    name = os.environ.get(ENV_ABLATION, "")
    if name and name not in ABLATIONS:
        raise InputError(f"{ENV_ABLATION}={name!r} must be one of {', '.join(ABLATIONS)}, or unset")
    return name


def switched_off(check: Check) -> bool:
    """True if this process leaves a check out."""
    name = ablation()
    return bool(name) and check in ABLATIONS[name]


def ablation_words(name: str) -> str:
    """An ablation in words, for replies and verdicts."""
    return f"no acceptance: an evaluation without {', '.join(sorted(ABLATIONS.get(name, {name})))}"


def marked(row: Row) -> Row:
    """The row with the name of this process's ablation in its evidence, where there is one."""
    name = ablation()
    return row.model_copy(update={"evidence": {**row.evidence, "ablation": name}}) if name else row


def require_whole(purpose: str) -> None:
    """Refuse what needs every check in a process that switches some off.

    Raises:
        RefusedError: it is one.
    """
    if name := ablation():
        raise RefusedError(f"{purpose} needs every check, and {ENV_ABLATION}={name!r} switches some off; unset it")
