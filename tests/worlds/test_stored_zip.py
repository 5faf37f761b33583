"""Archives without compression, written by hand."""

import io
import zipfile

import numpy as np
import pytest
from worldagent.worlds import stored_zip as module
from worldagent.worlds.stored_zip import stored_members, stored_zip


def _files(count: int) -> dict[str, bytes]:
    random = np.random.default_rng(count)
    return {f"p{k}/v": random.bytes(int(random.integers(0, 300))) for k in range(count)} | {"meta.json": b"{}"}


@pytest.mark.parametrize("count", [0, 1, 7, 400])
def test_the_bytes_are_those_of_the_library(count: int) -> None:
    files, buffer = _files(count), io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for name, raw in files.items():
            archive.writestr(zipfile.ZipInfo(name), raw)
    assert stored_zip(files) == buffer.getvalue()


def test_an_archive_is_read_back_whole() -> None:
    files = _files(30)
    with zipfile.ZipFile(io.BytesIO(stored_zip(files))) as archive:
        assert archive.testzip() is None
        assert {n: archive.read(n) for n in archive.namelist()} == files


def test_what_needs_wider_fields_is_left_to_the_library(monkeypatch: pytest.MonkeyPatch) -> None:
    files = _files(20)
    short = stored_zip(files)
    monkeypatch.setattr(module, "MOST_FILES", 5)
    assert stored_zip(files) == short


def test_a_name_that_is_not_ascii_is_refused() -> None:
    with pytest.raises(UnicodeEncodeError):
        stored_zip({"ü": b""})


def test_what_was_stored_is_read_at_once_and_anything_else_is_left_to_the_library() -> None:
    """Own choice: only an archive that `stored_zip` would write again, byte for byte, is read without `zipfile`."""
    files = {"meta.json": b"{}", "p0/v": bytes(range(256)), "p0/f": b""}
    raw = stored_zip(files)
    assert stored_members(raw) == files
    assert stored_members(raw[:-1]) is None
    assert stored_members(b"") is None
    assert stored_members(raw + b"x") is None
    spoiled = bytearray(raw)
    spoiled[raw.index(bytes(range(256))) + 7] ^= 1  # the checksum tells
    assert stored_members(bytes(spoiled)) is None
    longer = io.BytesIO()
    with zipfile.ZipFile(longer, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("meta.json", b"{}" * 100)
    assert stored_members(longer.getvalue()) is None
