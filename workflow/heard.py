"""Warnings that a client has been told: each is told once where a server has one client, and counted from then on."""

from __future__ import annotations

import re
import threading
from collections.abc import Iterable

__all__ = ["AT_START", "Heard"]

AT_START = "not so at frame 0"
"""Beginning of a warning that stands as long as a world does, though all is as it shall be: what is thrown over stands at frame 0."""
NAMED = 4
"""Warnings that a count names."""
_NUMBERS = re.compile(r"\d+(\.\d+)?(e-?\d+)?")


class Heard:
    """The warnings of one session, by world. Numbers do not make a warning another one."""

    def __init__(self) -> None:
        self._told: set[tuple[str, str]] = set()
        self._lock = threading.Lock()

    def news(self, world: str, lines: Iterable[str]) -> list[str]:
        """Lines that this session has not been told of a world yet, and one that counts the others; from now on all are told."""
        fresh: list[str] = []
        known: list[str] = []
        with self._lock:
            for line in lines:
                key = (world, _NUMBERS.sub("#", line))
                (known if key in self._told else fresh).append(line)
                self._told.add(key)
        return [*fresh, *_counted(known)]

    def without_repeats(self, world: str, lines: Iterable[str]) -> list[str]:
        """Lines without those of standing warnings that this session was told already, which are counted; the others are told whenever they come up."""
        with self._lock:
            told = {text for name, text in self._told if name == world}
        standing: list[str] = []
        others: list[str] = []
        for line in lines:
            (standing if line.startswith(AT_START) or _NUMBERS.sub("#", line) in told else others).append(line)
        return [*others, *self.news(world, standing)]


def _counted(known: list[str]) -> list[str]:
    if not known:
        return []
    named = ", ".join(dict.fromkeys(_name(line) for line in known[:NAMED]))
    many = (
        f"{len(known)} warnings stand as this session was told them before"
        if len(known) > 1
        else "1 warning stands as told before"
    )
    return [f"{many}: {named}{', ...' if len(known) > NAMED else ''}"]


def _name(line: str) -> str:
    """The beginning of a warning, which says what it is about."""
    rest = line.removeprefix(f"{AT_START}: ")
    return rest.split(": ", 1)[0][:80]
