"""Bearer tokens of one workspace: named, scoped, expiring, kept as salted hashes.

`<workspace>/.worldagent/tokens.json`       who may come in; no token can be computed from it
`<workspace>/.worldagent/token_uses.json`   when each token was last used, to the minute
"""

from __future__ import annotations

import contextlib
import hashlib
import hmac
import json
import os
import re
import secrets
import stat
import threading
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal, get_args

from ..worlds.errors import EvidenceError, InputError
from ..worlds.storage import exclusively

__all__ = ["SCOPES", "Grant", "IssuedToken", "Scope", "TokenBook", "check_token_strength", "token_table"]

Scope = Literal["read", "write"]
SCOPES: tuple[Scope, ...] = get_args(Scope)
"""Scopes that a token allows; write includes read."""
SHORTEST_TOKEN = 16
PREFIX = "wa"
MOST_TOKENS = 256
USE_RESOLUTION_S = 60.0
"""Last uses are written at most this often per token [s]."""
LOCK_PATIENCE_S = 5.0
"""Longest wait for another process that changes the tokens [s]."""
_NAME = re.compile(r"^[A-Za-z0-9][A-Za-z0-9 ._-]{0,63}$")
_TOKEN = re.compile(rf"^{PREFIX}_([0-9a-f]{{8}})_([A-Za-z0-9_-]{{43}})$")


@dataclass(frozen=True)
class Grant:
    """Who a request comes from and what it may do."""

    id: str
    name: str
    scope: Scope

    @property
    def scopes(self) -> tuple[Scope, ...]:
        """All scopes that the grant includes."""
        return ("read", "write") if self.scope == "write" else ("read",)


@dataclass(frozen=True)
class IssuedToken:
    """One line of the file: a token without its secret."""

    id: str
    name: str
    scope: Scope
    salt: str
    digest: str
    """SHA-256 of salt and token, in hex. The secret has 256 random bits, so a slow hash would protect nothing."""
    created: float
    expires: float | None
    """Unix time [s], or None: until revoked."""


class TokenBook:
    """Tokens of a workspace, and the one given at the start of the server."""

    def __init__(self, workspace: Path, *, given: str | None = None) -> None:
        """
        Args:
            workspace: Root of all worlds.
            given: A write token from the command line or the environment.

        Raises:
            InputError: The given token is too short.
        """
        if given is not None:
            check_token_strength(given)
        self._folder = workspace / ".worldagent"
        self._given = None if given is None else hashlib.sha256(given.encode()).digest()
        self._lock = threading.Lock()
        self._read: tuple[tuple[int, int, int] | None, dict[str, IssuedToken]] = (None, {})
        self._noted: dict[str, float] = {}

    @property
    def path(self) -> Path:
        """The file of the tokens."""
        return self._folder / "tokens.json"

    @property
    def uses_path(self) -> Path:
        """The file of the last uses."""
        return self._folder / "token_uses.json"

    def required(self) -> bool:
        """True if requests need a token: one was given, or the workspace ever issued one, even if all are revoked."""
        return self._given is not None or os.path.lexists(self.path)

    def check(self, token: str) -> Grant | None:
        """The grant of a token; None for an unknown, revoked or expired one. Takes as long for any.

        Raises:
            EvidenceError: The file of the tokens is damaged or open to others.
        """
        encoded = token.encode("utf-8", "replace")
        given = hmac.compare_digest(hashlib.sha256(encoded).digest(), self._given or bytes(32))
        found = _TOKEN.fullmatch(token)
        issued = self._issued().get(found.group(1)) if found else None
        digest = _digest(issued.salt if issued else "0" * 32, encoded)
        right = hmac.compare_digest(digest.encode(), (issued.digest if issued else "").encode())
        if given and self._given is not None:
            return Grant("given", "given at start", "write")
        if issued is None or not right or (issued.expires is not None and issued.expires <= time.time()):
            return None
        self._note_use(issued.id)
        return Grant(issued.id, issued.name, issued.scope)

    def add(self, name: str, scope: Scope, *, days: float | None = None) -> str:
        """Issue a token; the only time it is seen in clear.

        Args:
            name: Whom it is for.
            scope: What it allows.
            days: Life time [days]; None: until revoked.

        Raises:
            InputError: A bad or taken name, an unknown scope, a life time that is not positive, or too many tokens.
        """
        if not _NAME.fullmatch(name):
            raise InputError(f"token name {name!r} must match {_NAME.pattern}, e.g. 'laptop'")
        if scope not in SCOPES:
            raise InputError(f"scope {scope!r} must be one of {', '.join(SCOPES)}")
        if days is not None and not 0 < days <= 36_500:
            raise InputError(f"life time {days!r} days must be above 0 and at most 36500")
        now = time.time()
        with self._changing() as tokens:
            if any(t.name == name for t in tokens.values()):
                raise InputError(f"there is a token {name!r} already; revoke it first or choose another name")
            if len(tokens) >= MOST_TOKENS:
                raise InputError(f"there are {len(tokens)} tokens, at most {MOST_TOKENS}; revoke some")
            identity = secrets.token_hex(4)
            while identity in tokens:
                identity = secrets.token_hex(4)
            token = f"{PREFIX}_{identity}_{secrets.token_urlsafe(32)}"
            salt = secrets.token_hex(16)
            expires = None if days is None else now + days * 86_400
            tokens[identity] = IssuedToken(identity, name, scope, salt, _digest(salt, token.encode()), now, expires)
        return token

    def revoke(self, name: str) -> IssuedToken:
        """Take a token back, by name or id; a running server refuses it from its next request on.

        Raises:
            InputError: There is no such token.
        """
        with self._changing() as tokens:
            for identity, token in tokens.items():
                if name in (token.name, identity):
                    return tokens.pop(identity)
            raise InputError(f"there is no token {name!r}; known: {[t.name for t in tokens.values()]}")

    def tokens(self) -> list[IssuedToken]:
        """All tokens, oldest first."""
        return sorted(self._issued().values(), key=lambda t: (t.created, t.id))

    def last_uses(self) -> dict[str, float]:
        """Unix time of the last use by token id [s]; a damaged file counts as none."""
        try:
            uses = json.loads(self.uses_path.read_text())
            return {str(k): float(v) for k, v in uses.items()}
        except (OSError, ValueError, AttributeError, TypeError):
            return {}

    def _issued(self) -> dict[str, IssuedToken]:
        with self._lock:
            try:
                descriptor = os.open(self.path, os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0))
            except FileNotFoundError:
                return {}
            except OSError as error:
                raise EvidenceError(f"{self.path} cannot be read: {error.strerror}; it must be a plain file") from error
            with os.fdopen(descriptor, "rb") as file:
                status = os.fstat(file.fileno())
                seen = (status.st_mtime_ns, status.st_size, status.st_ino)
                if self._read[0] != seen:
                    self._read = (seen, _parse(self.path, status, file))
            return self._read[1]

    @contextlib.contextmanager
    def _changing(self) -> Iterator[dict[str, IssuedToken]]:
        """All tokens, written back at the end; one process at a time."""
        self._folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        with exclusively(self._folder / "tokens.lock", LOCK_PATIENCE_S):
            tokens = dict(self._issued())
            yield tokens
            document = {"version": 1, "tokens": [asdict(t) for t in tokens.values()]}
            _write_private(self.path, json.dumps(document, indent=1).encode())

    def _note_use(self, identity: str) -> None:
        now = time.time()
        with self._lock:
            if now - self._noted.get(identity, 0.0) < USE_RESOLUTION_S:
                return
            self._noted[identity] = now
            with contextlib.suppress(OSError):  # a read-only workspace still serves
                _write_private(self.uses_path, json.dumps({**self.last_uses(), identity: now}).encode())


def check_token_strength(token: str) -> None:
    """Refuse a token that could be guessed.

    Raises:
        InputError: It is too short; the text never shows it.
    """
    if len(token) < SHORTEST_TOKEN:
        raise InputError(f"the token has {len(token)} characters, it needs at least {SHORTEST_TOKEN}")


def token_table(book: TokenBook) -> str:
    """Tokens as lines of text, without their secrets."""
    uses = book.last_uses()

    def day(at: float | None, otherwise: str) -> str:
        return otherwise if at is None else time.strftime("%Y-%m-%d %H:%MZ", time.gmtime(at))

    rows = [("id", "name", "scope", "created", "expires", "last used")]
    rows += [
        (t.id, t.name, t.scope, day(t.created, "-"), day(t.expires, "never"), day(uses.get(t.id), "never")) for t in book.tokens()
    ]
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    lines = ["  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True)).rstrip() for row in rows]
    return "\n".join(lines)


def _digest(salt: str, token: bytes) -> str:
    return hashlib.sha256(salt.encode() + token).hexdigest()


def _parse(path: Path, status: os.stat_result, file: Any) -> dict[str, IssuedToken]:
    if not stat.S_ISREG(status.st_mode):
        raise EvidenceError(f"{path} is no plain file; move it away")
    if os.name == "posix" and status.st_mode & 0o077:
        raise EvidenceError(f"{path} can be read or changed by other users; run: chmod 600 {path}")
    try:
        tokens = [IssuedToken(**entry) for entry in json.loads(file.read())["tokens"]]
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise EvidenceError(f"{path} is damaged: no token is accepted; delete it and issue new tokens") from error
    if not all(_sound(token) for token in tokens):
        raise EvidenceError(f"{path} holds a line that is no token: none is accepted; delete it and issue new tokens")
    return {token.id: token for token in tokens}


def _sound(token: IssuedToken) -> bool:
    texts = (token.id, token.name, token.salt, token.digest)
    times = (token.created, 0.0 if token.expires is None else token.expires)
    return (
        all(isinstance(text, str) for text in texts)
        and all(isinstance(at, int | float) and not isinstance(at, bool) for at in times)
        and token.scope in SCOPES
    )


def _write_private(path: Path, data: bytes) -> None:
    """Write a file that only its owner can read, whole or not at all."""
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(8)}.tmp")
    descriptor = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_NOFOLLOW", 0), 0o600)
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(path)
    except OSError:
        temporary.unlink(missing_ok=True)
        raise
