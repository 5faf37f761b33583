"""Checkpoints of partner instances: a magic word, the SHA-256 of what follows, the ledger, and the engine's state."""

from __future__ import annotations

import hashlib
import json
from typing import Any

from ..worlds.errors import EngineError

__all__ = ["seal", "unseal"]

SEAL_BYTES = 32


def seal(magic: bytes, ledger: dict[str, Any], state: bytes) -> bytes:
    """Bytes of a checkpoint."""
    front = json.dumps(ledger, sort_keys=True).encode()
    held = b"".join((len(front).to_bytes(4, "little"), front, state))
    return b"".join((magic, hashlib.sha256(held).digest(), held))


def unseal(magic: bytes, data: bytes, frame: int, kind: str) -> tuple[dict[str, Any], bytes]:
    """Ledger and engine's state of a checkpoint.

    Args:
        magic: of such checkpoints.
        data: what `seal` made.
        frame: it was taken at, for the message.
        kind: of the instance, for the message.

    Raises:
        EngineError: it is damaged, or of something else.
    """
    if data[: len(magic)] != magic:
        raise EngineError(f"not a checkpoint of a {kind} instance; delete the candidate's checkpoints and bake again")
    start = len(magic) + SEAL_BYTES
    if hashlib.sha256(data[start:]).digest() != data[len(magic) : start]:
        raise EngineError(f"the checkpoint of frame {frame} is damaged; delete it and bake again")
    size = int.from_bytes(data[start : start + 4], "little")
    return json.loads(data[start + 4 : start + 4 + size]), data[start + 4 + size :]
