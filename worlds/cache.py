"""Frame caches: one container of named channels per solver instance and frame.

A container is an uncompressed zip of `.npy` members, so that one channel can be read without the others. Its
bytes depend only on the content. Frame k is the state at time k / fps.

What channels there are, and what each holds, is declared in `channels.py`: frames are checked against it when they are written and
when they are read.
"""

from __future__ import annotations

import hashlib
import io
import json
import math
import struct
import zipfile
import zlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from .arrays import F64, RigidPose
from .channels import CHANNELS, mismatch, names_written
from .errors import EngineError, EvidenceError
from .folder import write_atomically
from .kept import kept

__all__ = ["DAMAGE", "Cache", "CacheIndex", "array_of", "digest_arrays", "read_array", "read_container", "write_container"]


DAMAGE = (
    *(OSError, EOFError, KeyError, IndexError, ValueError, TypeError, AttributeError, OverflowError, RuntimeError),
    *(zipfile.BadZipFile, zlib.error, struct.error),
)
"""Exceptions that reading a damaged zip file of arrays may raise."""
HEADER_BYTES = 512
"""Longest head of an array in a container; those of the channels have 128."""
_LOCAL = struct.Struct("<4s22xHH")
"""Head of a member: signature, length of the name, length of what else there is."""
PAIRS = ("contact/pair", "event/pair", "impact/pair")
"""Channels of indices into `CacheIndex.colliders`."""
KEPT_BYTES = 256_000_000
"""Caches up to this size are kept in memory while a verification reads them."""
LITTLE_BYTES = 4096
"""The members of larger ones that are kept, of this size at most: records, of which a verification reads dozens, and opening a container takes longest."""


@dataclass(frozen=True)
class CacheIndex:
    """Names of the rows of the channels; `index.json` beside the frames."""

    solver: str
    engine: str
    fps: int
    frames: int
    """Number of frames the cache holds when complete."""
    bodies: tuple[str, ...]
    """`entity/body` of every moving body; of a liquid instance, its entities."""
    colliders: tuple[str, ...]
    """Entity ids, static ones included; contact pairs index into it."""
    joints: tuple[str, ...]
    drivers: tuple[str, ...]
    settings: str
    """Hash of everything that decides the motion, so that another candidate may take its frames over; empty of a rigid instance."""
    versions: dict[str, str]
    deformables: tuple[str, ...] = ()
    """`entity/part` of every deforming part, in the order of their vertices in the channels `vertex/*`."""
    vertices: tuple[int, ...] = ()
    """Number of vertices of each of them."""
    breakables: tuple[str, ...] = ()
    """Entities whose bonds the channels `bond/*` list, one after the other."""


def write_container(path: Path, channels: Mapping[str, Any]) -> str:
    """Write named arrays to `path` (temporary name, then rename); returns their digest."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for name in sorted(channels):
            raw = io.BytesIO()
            np.lib.format.write_array(raw, np.asarray(channels[name]), allow_pickle=False)
            archive.writestr(zipfile.ZipInfo(name + ".npy"), raw.getvalue())
    write_atomically(path, buffer.getvalue())
    return digest_arrays(channels)


def digest_arrays(channels: Mapping[str, Any]) -> str:
    """SHA-256 over names, dtypes, shapes and bytes of the arrays, hex."""
    state = hashlib.sha256()
    for name in sorted(channels):
        array = np.ascontiguousarray(channels[name])
        state.update(f"{name}|{array.dtype.str}|{array.shape}|".encode())
        state.update(array.reshape(-1).view(np.uint8).data)
    return state.hexdigest()


def read_array(archive: zipfile.ZipFile, name: str) -> Any:
    """One `.npy` member of a container, never larger than the file itself: a stranger's container may be a bomb.

    Raises:
        KeyError: there is no such member.
        ValueError: it is compressed, encrypted, no plain array, or its header promises another size than it has.
    """
    info = _plain(archive, name)
    return array_of(bytearray(archive.read(info)), name)


def _plain(archive: zipfile.ZipFile, name: str) -> zipfile.ZipInfo:
    info = archive.getinfo(name)
    if info.compress_type != zipfile.ZIP_STORED or info.flag_bits & 1:
        raise ValueError(f"member {name!r} is compressed or encrypted, which no container is")
    if info.comment:  # one of a false length hides the members after it
        raise ValueError(f"member {name!r} carries a comment, which none does")
    return info


def _member(stream: io.BufferedReader, info: zipfile.ZipInfo) -> bytearray:
    """Bytes of a stored member of an archive; members are many and small, and `zipfile` takes long over each."""
    stream.seek(info.header_offset)
    signature, names, more = _LOCAL.unpack(stream.read(_LOCAL.size))
    label = stream.read(names + more)[:names]
    held = bytearray(info.file_size)
    count = stream.readinto(held)
    if signature != b"PK\x03\x04" or label != info.orig_filename.encode() or count != info.file_size:
        raise ValueError(f"member {info.filename!r} is not where the archive says")
    if zlib.crc32(held) != info.CRC:
        raise ValueError(f"member {info.filename!r} has another checksum than the archive says")
    return held


def array_of(raw: bytes | bytearray, name: str) -> Any:
    """The array of an `.npy` file, which lies in its bytes: read-only where these are.

    Raises:
        ValueError: it is no plain array, or its header promises another size than it has.
    """
    shape, fortran, dtype, start = _header(bytes(raw[:HEADER_BYTES]))
    count = math.prod(shape)
    if dtype.hasobject or min(shape, default=0) < 0 or count * dtype.itemsize != len(raw) - start:
        raise ValueError(f"member {name!r} promises {shape} of {dtype} and holds {len(raw)} bytes")
    flat = np.frombuffer(raw, dtype, count, start) if count else np.empty(0, dtype)
    return flat.reshape(shape, order="F" if fortran else "C")


def _header(head: bytes) -> tuple[tuple[int, ...], bool, np.dtype[Any], int]:
    """Shape, order, type and where the values begin; the head of one channel is the same at most frames."""
    major = np.lib.format.read_magic(io.BytesIO(head))[0]
    length = int.from_bytes(head[8:10], "little") if major == 1 else int.from_bytes(head[8:12], "little")
    end = (10 if major == 1 else 12) + length
    if end > HEADER_BYTES:
        raise ValueError(f"a header of {length} bytes, which no channel has")
    return *_parsed(head[:end]), end


@lru_cache(maxsize=4096)
def _parsed(header: bytes) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    stream = io.BytesIO(header)
    version = np.lib.format.read_magic(stream)
    read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    found: tuple[tuple[int, ...], bool, np.dtype[Any]] = read(stream)
    return found


def read_container(path: Path, names: Iterable[str] | None = None) -> dict[str, Any]:
    """Read all channels of a container, or just `names`.

    Raises:
        EvidenceError: the container is missing or damaged, or a channel is not in it.
    """
    try:
        with path.open("rb") as stream, zipfile.ZipFile(stream) as archive:
            wanted = [n.removesuffix(".npy") for n in archive.namelist()] if names is None else list(names)
            found = {n: _plain(archive, n + ".npy") for n in wanted}
            if sum(i.file_size for i in found.values()) > path.stat().st_size:
                raise ValueError("its members promise more than the file holds")
            return {n: array_of(_member(stream, i), n) for n, i in found.items()}
    except DAMAGE as error:
        raise EvidenceError(f"cache container {path.name!r} is missing, damaged or lacks a channel: {error}") from error


class Cache:
    """Reader of one instance's frames in `folder`; frame files are `frame_000000.npz`.

    With `limit` it is a view of the first so many frames, as if none had been written after them.
    """

    def __init__(self, folder: Path, *, limit: int | None = None) -> None:
        self.folder, self.limit = folder, limit

    def until(self, frame: int) -> Cache:
        """View of this cache that ends at a frame."""
        return Cache(self.folder, limit=frame + 1)

    @cached_property
    def index(self) -> CacheIndex:
        """The cache's index.

        Raises:
            EvidenceError: `index.json` is missing or damaged.
        """
        try:
            data = json.loads((self.folder / "index.json").read_text())
            for name in ("bodies", "colliders", "joints", "drivers", "deformables", "vertices", "breakables"):
                data[name] = tuple(data.get(name, ()))
            data["frames"] = data["frames"] if self.limit is None else min(data["frames"], self.limit)
            return CacheIndex(**data)
        except DAMAGE as error:
            raise EvidenceError(f"cache {self.folder.name!r} has no readable index.json ({error}); bake again") from error

    def write_index(self, index: CacheIndex) -> None:
        """Write `index.json`."""
        write_atomically(self.folder / "index.json", json.dumps(asdict(index), indent=1, sort_keys=True).encode())

    def digests(self) -> list[str]:
        """Digest of every frame written so far, in order, as recorded when it was written."""
        try:
            lines = (self.folder / "digests.txt").read_text().split()
        except (OSError, ValueError) as error:
            raise EvidenceError(f"cache {self.folder.name!r} has no readable digests.txt ({error}); bake again") from error
        return lines[: self.limit]

    def begin_digests(self, digests: Sequence[str]) -> None:
        """Keep these digests of the first frames, and no other."""
        write_atomically(self.folder / "digests.txt", "".join(f"{digest}\n" for digest in digests).encode())

    def add_digest(self, digest: str) -> None:
        """Record the digest of the next frame; a line that a kill or a full disk cut off is no digest of any frame."""
        with (self.folder / "digests.txt").open("a", encoding="ascii") as stream:
            stream.write(f"{digest}\n")

    def write(self, frame: int, data: Mapping[str, Any], writers: frozenset[str]) -> None:
        """Write the next frame and its digest.

        Args:
            frame: its number.
            data: arrays by channel.
            writers: what the instance is: it writes just the channels that are declared of these.

        Raises:
            EngineError: the arrays are not as declared; nothing is written.
        """
        promised = names_written(writers)
        wrong = mismatch(data, self._sizes)
        if not wrong and data.keys() != promised:
            more, less = sorted(data.keys() - promised), sorted(promised - data.keys())
            wrong = f"{more[:3]} is not declared of {sorted(writers)}" if more else f"{less[:3]} is missing"
        if not wrong and (bad := [n for n in promised if CHANNELS[n].finite and not np.isfinite(data[n]).all()]):
            wrong = f"{min(bad)!r} is not finite"
        if wrong:
            who = f"engine {self.index.engine!r} of instance {self.index.solver!r}"
            raise EngineError(f"{who}, frame {frame}: {wrong}; see worlds/channels.py")
        self.add_digest(write_container(self.path(frame), data))

    @cached_property
    def _sizes(self) -> dict[str, int]:
        """Sizes of the dimensions whose rows the index names."""
        index = self.index
        sizes = {n: len(getattr(index, n)) for n in ("bodies", "joints", "drivers", "deformables")}
        sizes |= {"boundaries": len(index.colliders), "vertices": sum(index.vertices)}
        return {**sizes, "pushed": sizes["bodies" if index.engine == "mujoco" else "boundaries"]}

    def path(self, frame: int) -> Path:
        """File of one frame."""
        return self.folder / f"frame_{frame:06d}.npz"

    def beyond(self) -> list[str]:
        """Names of the frame files after the last one of the index; of a view none, for it does not look there."""
        names = (p.name for p in self.folder.glob("frame_*.npz")) if self.limit is None else ()
        return sorted(n for n in names if n > self.path(self.index.frames - 1).name)

    def complete(self) -> bool:
        """True if every frame is there."""
        return all(self.path(k).exists() for k in range(self.index.frames))

    def read(self, frame: int, names: Iterable[str] | None = None) -> dict[str, Any]:
        """Channels of one frame, all or just `names`.

        Raises:
            EvidenceError: the frame is missing or damaged, a channel is not in it, or is not as declared in `channels.py`; how many
                rows there are is for checks to judge.
        """
        data = read_container(self.path(frame), names)
        if wrong := mismatch(data, None):
            raise EvidenceError(f"frame {frame} of cache {self.folder.name!r}: {wrong}; bake again")
        return data

    def seen(self, frame: int, names: Iterable[str]) -> dict[str, Any]:
        """Channels of one frame as `read` gives them, from memory where the cache is small enough to be kept there; nobody writes to them.

        Raises:
            EvidenceError: as `read`.
        """
        if self._small:
            try:
                whole = self._whole(frame)
                return {n: whole[n] for n in names}
            except (EvidenceError, KeyError):
                pass  # these channels may still be readable
        return self.read(frame, names)

    def series(self, name: str) -> Any:
        """One channel over all frames, stacked: shape (frames, ...). Only for channels of constant shape.

        Raises:
            EvidenceError: a frame is missing or damaged, or its channel has another shape.
        """
        return self._series(name)

    @kept(64)
    def _series(self, name: str) -> Any:
        frames = [self._channel(k, name) for k in range(self.index.frames)]
        shapes = {f.shape for f in frames}
        if len(shapes) != 1:
            raise EvidenceError(f"channel {name!r} has other shapes at other frames: {sorted(shapes)[:3]}; bake again")
        return np.stack(frames)

    def _channel(self, frame: int, name: str) -> Any:
        """One channel of one frame; small caches, and the records of large ones, are opened once and kept, for opening costs more than reading."""
        kept = self._whole if self._small else self._little if name in self._records else None
        if kept is not None:
            try:
                return kept(frame)[name]
            except (EvidenceError, KeyError):
                pass  # this channel may still be readable, and else says what is wrong with it
        return self.read(frame, (name,))[name]

    @cached_property
    def _small(self) -> bool:
        paths = (self.path(k) for k in range(self.index.frames))
        return sum(p.stat().st_size for p in paths if p.exists()) <= KEPT_BYTES

    @kept()
    def _whole(self, frame: int) -> dict[str, Any]:
        return self.read(frame)

    @kept()
    def _little(self, frame: int) -> dict[str, Any]:
        return self.read(frame, self._records)

    @cached_property
    def _records(self) -> tuple[str, ...]:
        """Names of the records that are little at the first frame."""
        try:
            with zipfile.ZipFile(self.path(0)) as archive:
                little = (i.filename.removesuffix(".npy") for i in archive.infolist() if i.file_size <= LITTLE_BYTES)
                return tuple(n for n in little if n.startswith("record/"))
        except DAMAGE:
            return ()

    @kept(8)
    def ragged(self, *names: str, raw: bool = False) -> list[dict[str, Any]]:
        """Channels of varying length, one dict per frame.

        Args:
            names: of the channels.
            raw: pairs may name colliders that the index does not have, for who looks for that.

        Raises:
            EvidenceError: a channel is missing or damaged, or a pair names a collider that the index does not have.
        """
        found = [{n: self._channel(k, n) for n in names} for k in range(self.index.frames)]
        for name in () if raw else (n for n in names if n in PAIRS):
            for k, frame in enumerate(found):
                pairs = np.asarray(frame[name])
                if pairs.size and (pairs.min() < 0 or pairs.max() >= len(self.index.colliders)):
                    raise EvidenceError(
                        f"{name} of frame {k} names a collider that the index does not have; see numerical:events"
                    )
        return found

    def body_row(self, entity: str, body: str = "body") -> int | None:
        """Row of a body in the pose channels; None when the instance does not move it."""
        try:
            return self.index.bodies.index(f"{entity}/{body}")
        except ValueError:
            return None

    def pose(self, row: int, frame: int) -> RigidPose:
        """Pose of one body at one frame."""
        position: F64 = self.series("position")[frame, row]
        quaternion: F64 = self.series("quaternion")[frame, row]
        return RigidPose(position, quaternion)

    def frame_digest(self, frame: int) -> str:
        """Digest of one frame's arrays, whatever they are."""
        return digest_arrays(read_container(self.path(frame)))

    def seen_digest(self, frame: int) -> str:
        """The same of a small cache by what `seen` gives of it: the arrays that are judged."""
        try:
            return digest_arrays(self._whole(frame)) if self._small else self.frame_digest(frame)
        except EvidenceError:
            return self.frame_digest(frame)
