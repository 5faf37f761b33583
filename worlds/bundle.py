"""Acceptance bundles: one zip file with everything that a verdict rests on. Format, writer and reader; no judgement.

| member | holds |
|---|---|
| `manifest.json` | format and version, what the bundle is about, and SHA-256 and size of every other member |
| `verdict.json` | the record of the fresh process: rows with evidence, clauses, approximations, versions, seed |
| `history.json` | every revision with its specification, patch, hypothesis, weakenings and reason; iterations of repair |
| `events.json` | contact beginnings, and the first true frame of every beat |
| `world/` | a world folder: `world.json` (RFC 8785), the mesh files it names, built geometry, the candidate's record, digests and checkpoints of its caches, its plates, and the frames of its caches unless they are held by digest only |

Its bytes depend only on the content (and on the version of zlib). The digest of a bundle is the SHA-256 of its manifest.
"""

from __future__ import annotations

import hashlib
import json
import re
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from .errors import EvidenceError, InputError, LimitError
from .folder import safe_join, temporary_name
from .limits import check_cap

__all__ = ["FORMAT", "FORMAT_VERSION", "Bundle", "WrittenBundle", "json_bytes", "open_bundle", "write_bundle"]

FORMAT = "worldagent-bundle"
FORMAT_VERSION = 1
JSON_BYTES = 256_000_000
"""Largest JSON member [bytes]; a verdict over 2,000 bodies has about 30 MB."""
MANIFEST = "manifest.json"
RECORDS = ("events.json", "history.json", "verdict.json")
_WORLD = re.compile(
    r"world/(world\.json"
    r"|assets/[A-Za-z0-9_.-]+(/[A-Za-z0-9_.-]+)*"
    r"|built/[A-Za-z0-9_-]+\.[0-9a-f]{16}\.zip"
    r"|candidates/[0-9a-f]{16}/(candidate\.json|plates/(index\.json|frame_\d{6}\.npz)"
    r"|(bake|probe)/[A-Za-z0-9_-]+/(index\.json|digests\.txt|frame_\d{6}\.npz|checkpoints/\d{6}\.bin"
    r"|(surface|wet|settled)/(index\.json|digests\.txt|frame_\d{6}\.npz|surface\.json|wet\.json|settled\.json|texels\.npz))))"
)
"""Names allowed below `world/`: nothing that a verdict does not need."""
_BLOCK = 1 << 20


class WrittenBundle(NamedTuple):
    """A bundle on disk."""

    path: Path
    digest: str
    """SHA-256 of the manifest, hex: tell it apart from the file to make a later exchange of the file noticeable."""
    size: int
    """[bytes]"""


def json_bytes(value: Any) -> bytes:
    """Compact JSON with sorted keys: equal values give equal bytes."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False, ensure_ascii=False).encode()


def write_bundle(path: Path, head: Mapping[str, Any], members: Mapping[str, bytes | Path]) -> WrittenBundle:
    """Write a bundle through a temporary name.

    Args:
        path: the zip file.
        head: further fields of the manifest.
        members: content by name, or the file that holds it.

    Raises:
        InputError: a name is not one of the format's.
        LimitError: too many members or bytes.
        EvidenceError: a file changed while it was written.
    """
    listed = {}
    for name in sorted(members):
        if not _allowed(name):
            raise InputError(f"{name!r} is no member of a bundle; see worlds/bundle.py for what is")
        listed[name] = _listing(members[name])
    check_cap("bundle_members", len(listed), what="this bundle")
    check_cap("bundle_bytes", sum(item["bytes"] for item in listed.values()), what="this bundle")
    manifest = json_bytes({**head, "format": FORMAT, "format_version": FORMAT_VERSION, "members": listed})
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = temporary_name(path)
    try:
        with zipfile.ZipFile(temporary, "w", zipfile.ZIP_DEFLATED, compresslevel=6) as archive:
            for name, source in [(MANIFEST, manifest), *((n, members[n]) for n in sorted(members))]:
                info = zipfile.ZipInfo(name)
                info.compress_type, info.create_system, info.external_attr = zipfile.ZIP_DEFLATED, 3, 0o100644 << 16
                data = source if isinstance(source, bytes) else source.read_bytes()
                if name in listed and _listing(data) != listed[name]:
                    raise EvidenceError(
                        f"{name!r} changed while it was bundled; wait until no job of the world runs, then repeat"
                    )
                archive.writestr(info, data)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)
    return WrittenBundle(path, hashlib.sha256(manifest).hexdigest(), path.stat().st_size)


def _allowed(name: str) -> bool:
    """True if a name is one of the format's; no name of it can lead out of a folder."""
    return name in RECORDS or (bool(_WORLD.fullmatch(name)) and not {".", ".."} & set(name.split("/")))


def _listing(source: bytes | Path) -> dict[str, Any]:
    if isinstance(source, bytes):
        return {"bytes": len(source), "sha256": hashlib.sha256(source).hexdigest()}
    with source.open("rb") as stream:
        return {"bytes": source.stat().st_size, "sha256": hashlib.file_digest(stream, "sha256").hexdigest()}


@dataclass(frozen=True)
class Bundle:
    """An opened bundle whose every member has the listed size and digest."""

    path: Path
    digest: str
    manifest: Mapping[str, Any]

    def json(self, name: str) -> Any:
        """A record of the bundle.

        Raises:
            EvidenceError: it is no JSON.
        """
        with zipfile.ZipFile(self.path) as archive:
            return _parsed(archive.read(name), name)

    def extract(self, into: Path) -> Path:
        """Write `world/` as a folder below `into`, which must be new; returns it.

        Raises:
            EvidenceError: a member changed since the bundle was opened.
        """
        root = into / "world"
        root.mkdir(parents=True)
        listed = self.manifest["members"]
        with zipfile.ZipFile(self.path) as archive:
            for name in (n for n in listed if n.startswith("world/")):
                target = safe_join(into, name)
                target.parent.mkdir(parents=True, exist_ok=True)
                data = archive.read(name)
                if hashlib.sha256(data).hexdigest() != listed[name]["sha256"]:
                    raise EvidenceError(f"member {name!r} changed while it was read")
                target.write_bytes(data)
        return root


def _parsed(data: bytes, name: str) -> Any:
    try:
        return json.loads(data)
    except (ValueError, RecursionError) as error:
        raise EvidenceError(f"member {name!r} is no JSON: {error}") from error


def open_bundle(path: Path) -> Bundle:
    """Open a bundle and check it against its manifest, before anything in it is believed.

    Raises:
        InputError: there is no such file, or it is no zip file.
        EvidenceError: members are missing, added, doubled, renamed, too large, or not what the manifest lists.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            infos = _checked_infos(archive)
            data = archive.read(MANIFEST)
            manifest = _parsed(data, MANIFEST)
            _check_manifest(manifest, infos)
            for name, listed in manifest["members"].items():
                if _digest(archive, infos[name]) != listed["sha256"]:
                    raise EvidenceError(f"member {name!r} is not what the manifest lists")
    except (OSError, zipfile.BadZipFile, NotImplementedError) as error:
        if not path.is_file() or not zipfile.is_zipfile(path):
            raise InputError(f"{path.name!r} is no bundle ({error}); give a world folder or a file of its acceptance/") from error
        raise EvidenceError(f"bundle {path.name!r} is damaged: {error}") from error
    except (zlib.error, EOFError, RuntimeError, ValueError, TypeError, KeyError, AttributeError) as error:
        raise EvidenceError(f"bundle {path.name!r} is damaged: {type(error).__name__} {error}") from error
    return Bundle(path, hashlib.sha256(data).hexdigest(), manifest)


def _checked_infos(archive: zipfile.ZipFile) -> dict[str, zipfile.ZipInfo]:
    """Members by name, if their headers alone are in order: nothing is unpacked yet."""
    infos = archive.infolist()
    names = [info.filename for info in infos]
    if len(set(names)) < len(names):
        raise EvidenceError("two members have one name")
    try:
        check_cap("bundle_members", len(infos), what="this bundle")
        check_cap("bundle_bytes", sum(info.file_size for info in infos), what="this bundle")
    except LimitError as error:
        raise EvidenceError(str(error)) from error
    for info in infos:
        if info.filename != MANIFEST and not _allowed(info.filename):
            raise EvidenceError(f"{info.filename!r} is no member of a bundle")
        kind = info.external_attr >> 16
        if info.is_dir() or info.flag_bits & 1 or (kind and kind & 0o170000 not in (0, 0o100000)):
            raise EvidenceError(f"{info.filename!r} is no plain file")
        if info.filename.endswith(".json") and info.file_size > JSON_BYTES:
            raise EvidenceError(f"{info.filename!r} has {info.file_size} bytes, at most {JSON_BYTES} are read")
    return {info.filename: info for info in infos}


def _check_manifest(manifest: Any, infos: Mapping[str, zipfile.ZipInfo]) -> None:
    if manifest.get("format") != FORMAT or manifest.get("format_version") != FORMAT_VERSION:
        raise EvidenceError(
            f"the manifest says {manifest.get('format')!r} version {manifest.get('format_version')!r}; "
            f"this program reads {FORMAT!r} version {FORMAT_VERSION}"
        )
    listed = manifest["members"]
    missing, extra = sorted(set(listed) - set(infos)), sorted(set(infos) - set(listed) - {MANIFEST})
    absent = sorted({*RECORDS, "world/world.json"} - set(listed))
    if missing or extra or absent:
        raise EvidenceError(f"members missing: {(missing + absent)[:5]}, not listed: {extra[:5]}")
    for name, item in listed.items():
        if item["bytes"] != infos[name].file_size:
            raise EvidenceError(f"member {name!r} has {infos[name].file_size} bytes, the manifest lists {item['bytes']}")


def _digest(archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> str:
    state = hashlib.sha256()
    with archive.open(info) as stream:
        while block := stream.read(_BLOCK):
            state.update(block)
    return state.hexdigest()
