"""Frames that are made of a finished cache of a liquid and stand beside it: surfaces and wet maps."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ...worlds.cache import Cache
from ...worlds.derived import Derived
from ...worlds.folder import write_atomically

__all__ = ["Make", "make_frames", "take_frames"]

Make = Callable[[int], tuple[dict[str, Any], frozenset[str]]]
"""Channels of a frame without its `source`, and their writers."""


def make_frames(
    made: Derived,
    start: int,
    make: Make,
    about: Mapping[str, Any],
    *,
    progress: Callable[[int, int, str], None] | None = None,
    check: Callable[[], None] | None = None,
) -> None:
    """Write all frames from `start` on; those before are kept.

    Args:
        made: where they stand, and of which cache they are made.
        start: the first frame to make.
        make: makes one.
        about: what they are made with, for the note beside them.
        progress: called with (done, total, message).
        check: called between frames; raises to stop.
    """
    index, files, digests = made.cache.index, made.files, made.cache.digests()
    files.folder.mkdir(parents=True, exist_ok=True)
    files.write_index(index)
    if start < index.frames or made.count() > index.frames:
        files.begin_digests(files.digests()[:start] if start else [])
        write_atomically(files.folder / made.note, json.dumps(about, indent=1, sort_keys=True).encode())
    for frame in range(start, index.frames):
        channels, writers = make(frame)
        channels["source"] = np.frombuffer(bytes.fromhex(digests[frame]), dtype=np.uint8)
        files.write(frame, channels, writers)
        if progress is not None:
            progress(frame + 1, index.frames, f"{index.solver}: {made.one} of frame {frame + 1} of {index.frames}")
        if check is not None:
            check()


def take_frames(made: Derived, earlier: Derived, *, frames: int | None = None) -> None:
    """Put a copy of what was made of another cache where this one's stands, if that has more frames.

    Whoever goes on from there tests recipe, digest and source of every frame, as of those that an interrupted run left.

    Args:
        made: where the copy goes.
        earlier: what is copied, made of the same frames.
        frames: how many at the start are of the same; default all.
    """
    count = earlier.count() if frames is None else min(frames, earlier.count())
    if count <= made.count():
        return
    folder = made.files.folder
    spare = folder.with_name(f".{folder.name}.taken")
    shutil.rmtree(spare, ignore_errors=True)  # what a kill left
    spare.mkdir(parents=True)
    dropped = {earlier.files.path(k).name for k in range(count, earlier.count())}
    for path in earlier.present():
        if path.name not in dropped:
            shutil.copy2(path, spare)
    Cache(spare).begin_digests(earlier.files.digests()[:count])
    shutil.rmtree(folder, ignore_errors=True)
    spare.rename(folder)
