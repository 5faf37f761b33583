"""worldagent: prompts become verified physical worlds, over the Model Context Protocol."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

__all__ = ["__version__"]

__version__ = "0.1.0"

# numba reads this when it is imported. Without it, compiled kernels are written beside the installed modules.
with suppress(RuntimeError):  # no home folder
    _CACHE = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    os.environ.setdefault("NUMBA_CACHE_DIR", str(_CACHE / "worldagent" / "numba"))
