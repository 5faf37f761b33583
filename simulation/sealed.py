"""Checkpoints: a stamp, sums since frame 0 and the engine's arrays, under a seal that tells damage."""

from __future__ import annotations

import hashlib
import io
import json
import zipfile
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..worlds.errors import EngineError

__all__ = ["Stamp", "from_bytes", "seal", "to_bytes", "unseal"]

MAGIC = b"WACHECK1"
SEAL_BYTES = 32
AGAIN = "delete the candidate's checkpoints and bake again"


@dataclass(frozen=True)
class Stamp:
    """The engine, instance and frame of a checkpoint."""

    engine: str
    instance: str
    frame: int

    @contextmanager
    def fits(self) -> Iterator[None]:
        """While a state is taken over: what does not fit the instance is of another one.

        Raises:
            EngineError: it does not fit.
        """
        try:
            yield
        except (KeyError, ValueError, IndexError, TypeError, RuntimeError) as error:
            raise EngineError(
                f"the checkpoint of frame {self.frame} is not of {self.instance!r} as it is specified ({error}); {AGAIN}"
            ) from error


def seal(stamp: Stamp, ledger: Mapping[str, Any], state: bytes) -> bytes:
    """The bytes of a checkpoint; `ledger` holds what JSON can."""
    head = {"engine": stamp.engine, "instance": stamp.instance, "frame": stamp.frame, "ledger": ledger}
    front = json.dumps(head, sort_keys=True).encode()
    held = b"".join((len(front).to_bytes(4, "little"), front, state))
    return b"".join((MAGIC, hashlib.sha256(held).digest(), held))


def unseal(stamp: Stamp, data: bytes) -> tuple[dict[str, Any], bytes]:
    """Ledger and engine's state of a checkpoint that is to be of `stamp`.

    Raises:
        EngineError: it is damaged, of another version, engine, instance or frame.
    """
    start = len(MAGIC) + SEAL_BYTES
    if data[: len(MAGIC)] != MAGIC:
        raise EngineError(f"frame {stamp.frame} of {stamp.instance!r} has no checkpoint of this version; {AGAIN}")
    if hashlib.sha256(data[start:]).digest() != data[len(MAGIC) : start]:
        raise EngineError(f"the checkpoint of frame {stamp.frame} of {stamp.instance!r} is damaged; delete it and bake again")
    size = int.from_bytes(data[start : start + 4], "little")
    head = json.loads(data[start + 4 : start + 4 + size])
    found = Stamp(head["engine"], head["instance"], head["frame"])
    if found != stamp:
        raise EngineError(f"the checkpoint is of {found}, wanted is {stamp}; {AGAIN}")
    return head["ledger"], data[start + 4 + size :]


def to_bytes(arrays: Mapping[str, Any]) -> bytes:
    """Arrays as one container without pickles."""
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)
    return buffer.getvalue()


def from_bytes(data: bytes, names: Collection[str] = ()) -> dict[str, NDArray[Any]]:
    """The arrays of `to_bytes`.

    Raises:
        EngineError: the bytes are no such container, or one of `names` is missing.
    """
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as file:
            found = {name: file[name] for name in file.files}
    except (KeyError, ValueError, OSError, EOFError, zipfile.BadZipFile) as error:
        raise EngineError(f"these bytes are no state of an engine; {AGAIN}") from error
    missing = sorted(set(names) - set(found))
    if missing:
        raise EngineError(f"the state of an engine lacks {missing}; {AGAIN}")
    return found
