"""Products of a cache, made frame by frame and kept beside it: surfaces and wet maps of liquids."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any, ClassVar

from .cache import DAMAGE, Cache, digest_arrays
from .errors import EvidenceError

__all__ = ["Derived"]


class Derived:
    """Reader of what was made of a cache; notices what is missing, altered or of other frames.

    Its files are a cache of their own with the index of the first, and every frame has the digest of its `source`.
    """

    one: ClassVar[str]
    """Name of one frame of it, for messages."""
    many: ClassVar[str]
    writes: ClassVar[str] = ""
    """Kind of writer that its channels have in `worlds/channels.py`; empty where no quantity is read from it."""
    note: ClassVar[str]
    """File that says what it was made with."""
    beside: ClassVar[tuple[str, ...]] = ()
    """Further files of it that are no frames."""

    def __init__(self, cache: Cache, folder: Path) -> None:
        self.cache = cache
        self.files = Cache(folder, limit=cache.limit)

    def count(self) -> int:
        """Frames at the start that have one; 0 when none was made."""
        try:
            return min(len(self.files.digests()), self.cache.index.frames)
        except EvidenceError:
            return 0

    def present(self) -> list[Path]:
        """Files of it that are there."""
        folder = self.files.folder
        named = [folder / n for n in ("index.json", "digests.txt", self.note, *self.beside)]
        return [*(p for p in named if p.is_file()), *sorted(folder.glob("frame_[0-9][0-9][0-9][0-9][0-9][0-9].npz"))]

    def about(self) -> dict[str, Any]:
        """The note of their making: recipe, settings, versions.

        Raises:
            EvidenceError: the note is missing or damaged.
        """
        try:
            data = json.loads((self.files.folder / self.note).read_text())
            if not isinstance(data, dict):
                raise ValueError("it is no table")
            self._understand(data)
        except DAMAGE as error:
            raise EvidenceError(f"{self.many} of {self.cache.folder.name!r} have no readable {self.note} ({error})") from error
        return data

    def _understand(self, data: dict[str, Any]) -> None:
        """Refuse a note without what readers need, with a ValueError or KeyError."""

    def read(self, frame: int) -> dict[str, Any]:
        """All channels of a frame.

        Raises:
            EvidenceError: it is missing, was altered, or was made of other particles than those of the frame.
        """
        digests, own, name = self.files.digests(), self.cache.digests(), self.cache.folder.name
        if not 0 <= frame < min(len(digests), len(own)):
            raise EvidenceError(f"liquid {name!r} has no {self.one} at frame {frame}; bake again")
        found = self.files.read(frame)
        if digest_arrays(found) != digests[frame]:
            raise EvidenceError(f"the {self.one} of {name!r} at frame {frame} was altered; bake again")
        if bytes(found["source"]).hex() != own[frame]:
            raise EvidenceError(f"the {self.one} of {name!r} at frame {frame} is of other particles (stale); bake again")
        return found

    def digest(self, frames: int | None = None) -> str:
        """SHA-256 over the recorded digests of the first frames, hex; default all of the cache.

        Raises:
            EvidenceError: fewer frames have one.
        """
        wanted = self.cache.index.frames if frames is None else frames
        if self.count() < wanted:
            raise EvidenceError(
                f"liquid {self.cache.folder.name!r} has {self.count()} of {wanted} {self.many}; bake again to resume"
            )
        return hashlib.sha256("".join([*self._more(), *self.files.digests()[:wanted]]).encode()).hexdigest()

    def _more(self) -> list[str]:
        """Digests of what else belongs to them."""
        return []
