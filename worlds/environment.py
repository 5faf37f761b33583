"""Environment of a verdict: this program, Python, and the class of machines that gives equal bytes (S14)."""

from __future__ import annotations

import platform

__all__ = ["environment"]


def environment() -> dict[str, str]:
    """Versions of the program and of Python, and the device class: operating system and instruction set."""
    from .. import __version__

    return {
        "worldagent": __version__,
        "python": f"{platform.python_implementation()} {platform.python_version()}",
        "device": f"{platform.system()}-{platform.machine()}".lower(),
    }
