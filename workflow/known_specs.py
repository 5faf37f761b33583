"""Specifications that this process read lately, so that calls on an unchanged world do not validate it again.

The key is the digest of both texts, of `world.json` and of the ledger's revision: equal bytes mean the same specification,
whoever wrote them and whatever the clock says. Specifications are frozen, so calls may share one.
"""

from __future__ import annotations

import hashlib
import threading
from collections import OrderedDict

from ..worlds.spec import WorldSpec

__all__ = ["KEPT_BYTES", "KnownSpecs"]

KEPT_BYTES = 4_000_000
"""Text of the specifications kept at most [bytes]; a parsed one takes about ten times its text. Own choice."""


class KnownSpecs:
    """The latest ones, safe from several threads."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._found: OrderedDict[str, tuple[int, WorldSpec]] = OrderedDict()
        self._size = 0

    def get(self, text: bytes, recorded: str) -> WorldSpec | None:
        """The specification whose two texts these are, if it is known."""
        key = _key(text, recorded)
        with self._lock:
            if key not in self._found:
                return None
            self._found.move_to_end(key)
            return self._found[key][1]

    def put(self, text: bytes, recorded: str, spec: WorldSpec) -> None:
        """Keep a specification; the ones not asked for longest go."""
        key, size = _key(text, recorded), len(text)
        if size > KEPT_BYTES:
            return
        with self._lock:
            self._size += size - self._found.pop(key, (0, spec))[0]
            self._found[key] = (size, spec)
            while self._size > KEPT_BYTES:
                self._size -= self._found.popitem(last=False)[1][0]


def _key(text: bytes, recorded: str) -> str:
    state = hashlib.sha256(text)
    state.update(b"\x00")
    state.update(recorded.encode())
    return state.hexdigest()
