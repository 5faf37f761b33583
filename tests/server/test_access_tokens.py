"""Tokens of a workspace: issued once, kept as hashes, refused when they should be."""

from __future__ import annotations

import json
import os
import stat
import subprocess
import sys
import threading
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from worldagent.server.cli import main
from worldagent.server.tokens import TokenBook, token_table
from worldagent.worlds.errors import EngineError, EvidenceError, InputError

GIVEN = "a-token-of-32-characters-or-more"

QUIET = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
"""A busy machine is no finding."""


def test_a_token_is_shown_once_and_kept_only_as_a_salted_hash(tmp_path: Path) -> None:
    book = TokenBook(tmp_path)
    first, second = book.add("laptop", "write"), book.add("page", "read")
    kept = book.path.read_text()
    for token in (first, second):
        assert token not in kept
        assert token.rpartition("_")[2] not in kept
        assert len(token) >= 50
    salts = {t.salt for t in book.tokens()}
    assert len(salts) == 2
    assert [(t.name, t.scope) for t in book.tokens()] == [("laptop", "write"), ("page", "read")]


@pytest.mark.skipif(os.name != "posix", reason="modes are POSIX")
def test_only_the_owner_can_read_the_file(tmp_path: Path) -> None:
    book = TokenBook(tmp_path)
    token = book.add("laptop", "write")
    assert book.check(token) is not None
    for path in (book.path, book.uses_path):
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert stat.S_IMODE(book.path.parent.stat().st_mode) == 0o700
    book.path.chmod(0o644)
    with pytest.raises(EvidenceError, match="chmod 600"):
        TokenBook(tmp_path).check(token)


def test_scope_and_identity_come_back(tmp_path: Path) -> None:
    book = TokenBook(tmp_path, given=GIVEN)
    read = book.check(book.add("page", "read"))
    write = book.check(book.add("agent", "write"))
    given = book.check(GIVEN)
    assert read is not None
    assert write is not None
    assert given is not None
    assert (read.name, read.scopes) == ("page", ("read",))
    assert write.scopes == given.scopes == ("read", "write")
    assert len({read.id, write.id, given.id}) == 3, "a session of one token cannot be taken over with another"


def test_a_revoked_token_is_refused_by_a_server_that_runs(tmp_path: Path) -> None:
    serving, command = TokenBook(tmp_path), TokenBook(tmp_path)
    token = command.add("laptop", "write")
    assert serving.check(token) is not None
    assert command.revoke("laptop").scope == "write"
    assert serving.check(token) is None
    assert serving.required(), "a workspace whose last token is revoked does not open"
    with pytest.raises(InputError, match="known"):
        command.revoke("laptop")


def test_using_a_token_never_brings_back_a_revoked_one(tmp_path: Path) -> None:
    serving, command = TokenBook(tmp_path), TokenBook(tmp_path)
    kept, gone = command.add("a", "read"), command.add("b", "write")
    assert serving.check(gone) is not None
    command.revoke("b")
    assert serving.check(kept) is not None
    assert [t.name for t in command.tokens()] == ["a"]


def test_an_expired_token_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    book = TokenBook(tmp_path)
    token = book.add("guest", "write", days=1)
    assert book.check(token) is not None
    import time

    later = time.time() + 86_401
    monkeypatch.setattr("worldagent.server.tokens.time.time", lambda: later)
    assert book.check(token) is None


def test_last_use_is_kept_apart_and_shown(tmp_path: Path) -> None:
    book = TokenBook(tmp_path)
    token = book.add("laptop", "write")
    assert "never" in token_table(book).splitlines()[1]
    before = book.path.read_bytes()
    book.check(token)
    assert book.path.read_bytes() == before
    assert len(book.last_uses()) == 1
    assert token_table(book).splitlines()[1].endswith("Z")
    assert token not in token_table(book)


@QUIET
@given(st.text(max_size=80) | st.from_regex(r"wa_[0-9a-f]{8}_[A-Za-z0-9_-]{43}", fullmatch=True))
def test_nothing_else_is_a_token(token: str) -> None:
    assert TokenBook(Path("/nonexistent"), given=GIVEN).check(token) is None


@pytest.mark.parametrize(
    "text",
    ["", "[]", "{}", '{"tokens": [{}]}', '{"tokens": 3}', "[" * 100_000, '{"tokens": [{"id": 1, "name": 2}]}'],
)
def test_a_damaged_file_accepts_nothing_and_says_so(tmp_path: Path, text: str) -> None:
    book = TokenBook(tmp_path)
    token = book.add("laptop", "write")
    book.path.write_text(text)
    with pytest.raises(EvidenceError, match="token"):
        book.check(token)


@pytest.mark.parametrize("field", ["scope", "digest", "salt", "expires", "created"])
def test_a_line_with_a_bad_field_accepts_nothing(tmp_path: Path, field: str) -> None:
    book = TokenBook(tmp_path)
    token = book.add("laptop", "write")
    document = json.loads(book.path.read_text())
    document["tokens"][0][field] = ["admin"]
    book.path.write_text(json.dumps(document))
    with pytest.raises(EvidenceError, match="token"):
        book.check(token)


@pytest.mark.skipif(os.name != "posix", reason="links need rights on Windows")
def test_a_link_is_no_token_file(tmp_path: Path) -> None:
    elsewhere = tmp_path / "other"
    book, other = TokenBook(tmp_path / "ws"), TokenBook(elsewhere)
    token = other.add("laptop", "write")
    book.path.parent.mkdir(parents=True)
    book.path.symlink_to(other.path)
    assert book.required()
    with pytest.raises(EvidenceError, match="plain file"):
        book.check(token)


@pytest.mark.parametrize("name", ["", "a" * 65, "a\nb", "a\n", "../x", "-x", "é", "\x1b[31m"])
def test_names_are_plain(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match="token name"):
        TokenBook(tmp_path).add(name, "read")


def test_bad_issues_are_told(tmp_path: Path) -> None:
    book = TokenBook(tmp_path)
    book.add("laptop", "read")
    with pytest.raises(InputError, match="already"):
        book.add("laptop", "write")
    with pytest.raises(InputError, match="days"):
        book.add("other", "read", days=-1)
    with pytest.raises(InputError, match="scope"):
        book.add("other", "admin")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="at least 16"):
        TokenBook(tmp_path, given="short")


def test_tokens_are_counted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("worldagent.server.tokens.MOST_TOKENS", 2)
    book = TokenBook(tmp_path)
    for name in ("a", "b"):
        book.add(name, "read")
    with pytest.raises(InputError, match="at most 2"):
        book.add("c", "read")


def test_tokens_issued_at_once_are_all_kept(tmp_path: Path) -> None:
    issued: list[str] = []
    threads = [threading.Thread(target=lambda k=k: issued.append(TokenBook(tmp_path).add(f"t{k}", "read"))) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    book = TokenBook(tmp_path)
    assert len(issued) == 8
    assert all(book.check(token) for token in issued)


def test_a_lock_is_free_when_its_holder_is_killed_and_held_however_long_it_works(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A lock that is broken by its age lets in two at once: of two changes one, perhaps a revocation, was lost."""
    book = TokenBook(tmp_path)
    book.add("first", "read")
    lock = book.path.with_name("tokens.lock")
    code = f"from worldagent.worlds.storage import exclusively\nfrom pathlib import Path\nimport time\nwith exclusively(Path({str(lock)!r}), 5): print('held', flush=True); time.sleep(60)"
    holder = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE)
    assert holder.stdout is not None
    with holder, holder.stdout:
        assert holder.stdout.readline() == b"held\n"
        os.utime(lock, (0, 0))
        monkeypatch.setattr("worldagent.server.tokens.LOCK_PATIENCE_S", 0.2)
        with pytest.raises(EngineError, match="in use by another process"):
            book.revoke("first")
        holder.kill()
    book.revoke("first")
    assert book.tokens() == []


def test_the_command_issues_lists_and_revokes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    where = ["--workspace", str(tmp_path)]
    assert main(["token", "add", "laptop", "--scope", "read", "--days", "30", *where]) == 0
    token = capsys.readouterr().out.strip()
    grant = TokenBook(tmp_path).check(token)
    assert grant is not None
    assert grant.scope == "read"
    assert main(["token", "list", *where]) == 0
    listed = capsys.readouterr().out
    assert "laptop" in listed
    assert token not in listed
    assert main(["token", "revoke", "laptop", *where]) == 0
    assert TokenBook(tmp_path).check(token) is None
    assert main(["token", "revoke", "laptop", *where]) == 2
    assert "there is no token" in capsys.readouterr().err
