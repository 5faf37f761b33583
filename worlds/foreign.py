"""Refusal of world folders from strangers that hold links out of them, or anything but plain files and folders.

Reading a link would show the reader's own files to whoever asks about the world, writing through one would change them, and
opening a pipe would never return. So a folder is looked through before anything in it is opened.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from .errors import EvidenceError, LimitError

__all__ = ["MOST_ENTRIES", "foreign_entries", "refuse_foreign"]

MOST_ENTRIES = 500_000
"""Files and folders that one world may hold: twice the frames of two caches and a film at their caps, and much room."""
_SHOWN = 5


def foreign_entries(root: Path) -> Iterator[str]:
    """Relative paths, with what each is, in the order of the folders.

    Args:
        root: The world folder; itself resolved.

    Raises:
        LimitError: There are more than `MOST_ENTRIES`.
    """
    base, seen = root.resolve(), 0
    folders = [base]
    while folders:
        try:
            entries = os.scandir(folders.pop())
        except OSError:  # gone meanwhile, or not readable: nothing of it will be read either
            continue
        with entries:
            for entry in entries:
                seen += 1
                if seen > MOST_ENTRIES:
                    raise LimitError(f"{root.name!r} holds more than {MOST_ENTRIES:,} files; delete old candidates from it")
                if entry.is_symlink():
                    if not _inside(base, Path(entry.path)):
                        yield f"{Path(entry.path).relative_to(base).as_posix()} (a link out of the folder)"
                elif entry.is_dir(follow_symlinks=False):
                    folders.append(Path(entry.path))
                elif not entry.is_file(follow_symlinks=False) and os.path.lexists(entry.path):
                    yield f"{Path(entry.path).relative_to(base).as_posix()} (neither a file nor a folder)"


def refuse_foreign(root: Path) -> None:
    """Refuse a world folder that holds a link out of it, a pipe, a socket or a device.

    Raises:
        EvidenceError: Names the first of them.
        LimitError: It holds too many files.
    """
    found = foreign_entries(root)
    shown = [repr(name) for _, name in zip(range(_SHOWN), found, strict=False)]
    if shown:
        raise EvidenceError(
            f"world folder {root.name!r} is not opened: it holds {', '.join(shown)}. A world holds everything it refers to: "
            "delete these, or put the files themselves there"
        )


def _inside(base: Path, link: Path) -> bool:
    try:
        target = link.resolve()
    except (OSError, RuntimeError):  # a loop
        return False
    return base in target.parents
