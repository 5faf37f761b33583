"""Add one server to a client's list without losing anything else that stands in the file.

JSON is read, changed and written again; TOML is changed as text, since comments stand in it. Either way the result is
read back and compared before it replaces the file, the old file is kept beside it, and a file that is not understood
is left alone.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import time
import tomllib
from pathlib import Path
from typing import Any

from ..worlds.errors import InputError
from .clients import Format

__all__ = ["read_list", "render", "with_entry", "write_list"]

LARGEST_BYTES = 16_000_000
"""No client's settings are larger; Claude Code's file with its history is some megabytes."""
_BARE = re.compile(r"[A-Za-z0-9_-]+")


def read_list(file: Path, kind: Format) -> tuple[str, dict[str, Any]]:
    """Text and content of a file; empty when there is none.

    Raises:
        InputError: It can't be read or holds something else than an object.
    """
    try:
        if file.exists() and file.stat().st_size > LARGEST_BYTES:
            raise InputError(f"{file} is larger than {LARGEST_BYTES} bytes; it is left alone")
        text = file.read_bytes().decode("utf-8-sig") if file.exists() else ""
        if not text.strip():
            return text, {}
        content = json.loads(text, object_pairs_hook=_once) if kind == "json" else tomllib.loads(text)
    except (OSError, ValueError) as error:
        raise InputError(
            f"{file} can't be read as {kind.upper()} ({error}); it is left alone. Mend it, or add the entry by hand"
        ) from error
    if not isinstance(content, dict):
        raise InputError(f"{file} holds no object; it is left alone")
    return text, content


def render(kind: Format, key: str, name: str, entry: dict[str, Any]) -> str:
    """The entry alone, as it would stand in an empty file."""
    return with_entry(Path("-"), "", {}, kind, key, name, entry)


def with_entry(file: Path, text: str, content: dict[str, Any], kind: Format, key: str, name: str, entry: dict[str, Any]) -> str:
    """The text with `content[key][name]` set to `entry` and nothing else changed.

    Raises:
        InputError: The place is taken by something else than an object, or the file is written in a way that an
            entry can't be put into safely.
    """
    servers = content.get(key, {})
    if not isinstance(servers, dict):
        raise InputError(f"{key!r} in {file} is no object; it is left alone")
    wanted = {**content, key: {**servers, name: entry}}
    if kind == "json":
        result = _json(wanted, _indent(text))
        found = json.loads(result)
    else:
        result = _toml_with(text, key, name, entry)
        try:
            found = tomllib.loads(result)
        except tomllib.TOMLDecodeError:
            found = None
    if found != wanted:
        raise InputError(f"{file} is written in a way that the entry can't be put into safely; add it by hand")
    return result


def write_list(file: Path, before: str, after: str) -> Path | None:
    """Replace the file in one step; where its copy was put, None when there was no file.

    A link is followed, so that settings kept elsewhere stay linked.

    Raises:
        InputError: The file has changed since it was read, or it can't be written.
    """
    target = file.resolve()
    kept: Path | None = None
    temporary = target.with_name(f".{target.name}.{os.getpid()}.tmp")
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        mode = target.stat().st_mode & 0o777 if target.exists() else 0o600
        if target.exists():
            raw = target.read_bytes()
            if raw.decode("utf-8-sig") != before:
                raise InputError(f"{file} was changed by another program meanwhile; run this again")
            kept = _free_name(target)
            _write(kept, raw, mode)
        _write(temporary, after.encode(), mode)
        temporary.replace(target)
    except OSError as error:
        with contextlib.suppress(OSError):
            temporary.unlink()
        raise InputError(f"{file} can't be written: {error.strerror}; nothing was changed") from error
    return kept


def _write(path: Path, data: bytes, mode: int) -> None:
    handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, mode)
    with os.fdopen(handle, "wb") as out:
        out.write(data)
        out.flush()
        os.fsync(out.fileno())
    path.chmod(mode)


def _free_name(file: Path) -> Path:
    stamp = time.strftime("%Y%m%d-%H%M%S")
    names = [f"{file.name}.{stamp}.bak", *(f"{file.name}.{stamp}-{k}.bak" for k in range(2, 100))]
    return next(file.with_name(name) for name in names if not file.with_name(name).exists())


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """An object whose names differ: of two equal names only one would survive."""
    names = [name for name, _ in pairs]
    twice = next((name for name in names if names.count(name) > 1), None) if len(set(names)) < len(names) else None
    if twice is not None:
        raise ValueError(f"{twice!r} stands twice in one object")
    return dict(pairs)


def _json(value: dict[str, Any], indent: int | str) -> str:
    text = json.dumps(value, indent=indent, ensure_ascii=False) + "\n"
    try:
        text.encode()
    except UnicodeEncodeError:  # half of a surrogate pair, as histories of chats hold them
        return json.dumps(value, indent=indent) + "\n"
    return text


def _indent(text: str) -> int | str:
    """Blanks by which the file is indented, 2 where it does not show."""
    found = re.search(r"\n([ \t]+)\S", text)
    if found is None:
        return 2
    return "\t" if "\t" in found.group(1) else min(len(found.group(1)), 8)


def _toml_with(text: str, key: str, name: str, entry: dict[str, Any]) -> str:
    """The text with the table `[key.name]` in place of the one it has, or at its end."""
    header = re.compile(rf"^\s*\[\s*{key}\s*\.\s*(?:{re.escape(name)}|\"{re.escape(name)}\")\s*(\.[^\]]+)?\]")
    kept: list[str] = []
    held: list[str] = []
    inside, place = False, None
    for line in text.splitlines():
        if line.lstrip().startswith("["):
            inside = header.match(line) is not None
            if inside and place is None:
                place = len(kept)
            if not inside:
                kept.extend(held)
            held = []
        if not inside:
            kept.append(line)
        elif not line.strip() or line.lstrip().startswith("#"):
            held.append(line)  # belongs to the table below it
        else:
            held = []
    kept.extend(held)
    table = [f"[{key}.{_toml_key(name)}]", *(f"{_toml_key(k)} = {_toml_value(v)}" for k, v in entry.items())]
    if place is None:
        lines = [*kept, *([""] if kept and kept[-1].strip() else []), *table]
    else:
        rest = kept[place:]
        lines = [*kept[:place], *table, *([""] if rest and rest[0].strip() else []), *rest]
    return "\n".join(lines) + "\n"


def _toml_key(name: str) -> str:
    return name if _BARE.fullmatch(name) else json.dumps(name)


def _toml_value(value: Any) -> str:
    """A string, number, truth value, list or table. JSON's escapes are among those of TOML's basic strings."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_toml_key(k)} = {_toml_value(v)}" for k, v in value.items()) + " }"
    if isinstance(value, list):
        return f"[{', '.join(_toml_value(item) for item in value)}]"
    return json.dumps(value, ensure_ascii=False)
