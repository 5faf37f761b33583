"""One thing that `worldagent doctor` looks at, what its failure costs, and how it is mended."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

__all__ = ["Check", "reinstall"]


@dataclass(frozen=True)
class Check:
    """An outcome. `cost`, `remedy` and `mend` belong to a failure."""

    name: str
    ok: bool
    detail: str
    required: bool = True
    """True if the server does not work without it."""
    cost: str = ""
    """Loss for the user where it is missing, in plain words."""
    remedy: str = ""
    """The exact command, or what to change where."""
    mend: Callable[[], str] | None = None
    """Does what is safe to do unasked; returns what was done."""

    def as_json(self) -> dict[str, Any]:
        """For `--json`; what does not apply is left out."""
        told: dict[str, Any] = {"name": self.name, "ok": self.ok, "required": self.required, "detail": self.detail}
        if not self.ok:
            told |= {"cost": self.cost, "remedy": self.remedy, "repairable": self.mend is not None}
        return told


def reinstall() -> str:
    """The command that installs this package anew, the way it was installed."""
    parts = Path(sys.prefix).resolve().parts
    if "uv" in parts and "tools" in parts:
        return "uv tool install --reinstall worldagent"
    if "pipx" in parts:
        return "pipx reinstall worldagent"
    return f"{sys.executable} -m pip install --force-reinstall worldagent"
