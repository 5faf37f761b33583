"""The model that the server's owner names: settings from the environment, and one request to it. Off unless it is named.

No call of a client sets any of this, and nothing here is logged. The key is in a file, so that it is not in the environment that all
worker processes inherit; it is read at each request and kept nowhere.
"""

from __future__ import annotations

import base64
import json
import os
import stat
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from http.client import HTTPException
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from ...worlds.errors import EngineError, InputError
from .pictures import ReviewPicture

__all__ = ["ENV_API", "ENV_KEY_FILE", "ENV_MODEL", "ENV_URL", "Endpoint", "ReaderError", "configured", "say"]

ENV_URL, ENV_MODEL = "WORLDAGENT_REVIEW_URL", "WORLDAGENT_REVIEW_MODEL"
ENV_API, ENV_KEY_FILE = "WORLDAGENT_REVIEW_API", "WORLDAGENT_REVIEW_KEY_FILE"
PATHS = {"openai": "/chat/completions", "anthropic": "/messages"}
"""By form of the API: what follows the base address, which ends in a version, as in https://api.example/v1."""
VERSION = "2023-06-01"
"""Version of the Messages API (header `anthropic-version`)."""
TIMEOUT_S = 180.0
"""Own choice: longest that one request takes altogether [s]; local models on a CPU read six pictures in a minute or two."""
PAUSES_S = (1.0, 4.0)
"""Own choice: pauses before a request is made again [s]; there are no more attempts than these and the first."""
MOST_BYTES = 400_000
"""Largest reply [bytes]: an answer about 60 spans with reasons has some 20 kB."""
MOST_TOKENS = 6000
MOST_KEY = 4096
LOOPBACK = ("127.0.0.1", "::1", "localhost")
AGAIN = (408, 425, 429, 500, 502, 503, 504, 529)
"""States of HTTP after which the same request may succeed."""


class ReaderError(EngineError):
    """The model gave no answer that counts."""


@dataclass(frozen=True)
class Endpoint:
    """A model at an address."""

    url: str
    """Base address."""
    model: str
    api: str
    """`openai` or `anthropic`."""
    key_file: Path | None

    @property
    def name(self) -> str:
        """Model and host, as the ledger and verdicts tell it."""
        return f"{self.model} at {urlsplit(self.url).hostname}"


def configured(environment: Mapping[str, str] | None = None) -> Endpoint | None:
    """The model that the environment names; None where it names none.

    Raises:
        InputError: the settings are incomplete, or would send pictures and a key in clear over a network.
    """
    values = os.environ if environment is None else environment
    url, model = values.get(ENV_URL, "").rstrip("/"), values.get(ENV_MODEL, "")
    if not url and not model:
        return None
    if not url or not model:
        raise InputError(f"a reader needs both {ENV_URL} and {ENV_MODEL} in the server's environment; set both or neither")
    api = values.get(ENV_API, "openai")
    if api not in PATHS:
        raise InputError(f"{ENV_API}={api[:40]!r} must be one of {', '.join(PATHS)}")
    parts = urlsplit(url)
    if parts.scheme not in ("http", "https") or not parts.hostname or parts.username or parts.password or parts.query:
        raise InputError(
            f"{ENV_URL} must be http(s)://host[:port]/path without user, password and query, e.g. http://127.0.0.1:11434/v1"
        )
    if parts.scheme == "http" and parts.hostname not in LOOPBACK:
        raise InputError(f"{ENV_URL} names {parts.hostname!r} without TLS; use https, or a model on this machine (127.0.0.1)")
    key = values.get(ENV_KEY_FILE, "")
    return Endpoint(url, model[:200], api, Path(key) if key else None)


def _key(endpoint: Endpoint) -> str:
    """The key; empty where none is named.

    Raises:
        InputError: its file is missing, open to others, or holds no key.
    """
    if endpoint.key_file is None:
        return ""
    try:
        with endpoint.key_file.open("rb") as stream:
            mode = os.fstat(stream.fileno()).st_mode
            if os.name == "posix" and mode & (stat.S_IRWXG | stat.S_IRWXO):
                raise InputError(f"the file of {ENV_KEY_FILE} can be read by others; chmod 600 it")
            raw = stream.read(MOST_KEY + 1)
    except OSError as error:
        raise InputError(f"the file of {ENV_KEY_FILE} cannot be read: {error.strerror}") from None
    key = raw.decode("ascii", "replace").strip()
    if not key or len(raw) > MOST_KEY or not key.isprintable() or " " in key:
        raise InputError(f"the file of {ENV_KEY_FILE} holds no key: one line of at most {MOST_KEY} ASCII characters")
    return key


def say(endpoint: Endpoint, text: str, pictures: Sequence[ReviewPicture], check: Callable[[], None] = lambda: None) -> str:
    """The model's reply to a text with pictures.

    Args:
        endpoint: whom to ask.
        text: the request.
        pictures: in order of time.
        check: raises where the caller gave up; asked between attempts.

    Raises:
        InputError: the key cannot be read.
        ReaderError: no reply, a refusal, or one that is no reply of this API.
    """
    key = _key(endpoint)
    body = json.dumps(_openai(endpoint, text, pictures) if endpoint.api == "openai" else _anthropic(endpoint, text, pictures))
    headers = {"Content-Type": "application/json", "Accept": "application/json", "User-Agent": "worldagent"}
    if endpoint.api == "anthropic":
        headers |= {"anthropic-version": VERSION, **({"x-api-key": key} if key else {})}
    elif key:
        headers["Authorization"] = f"Bearer {key}"
    for pause in (*PAUSES_S, None):
        check()
        try:
            return _reply(endpoint, json.loads(_sent(endpoint, body.encode(), headers)))
        except _BusyError as error:
            if pause is None:
                raise ReaderError(f"{endpoint.name} did not answer: {error}; try again later") from None
            time.sleep(pause)
        except ValueError:
            raise ReaderError(f"{endpoint.name} answered with what is no JSON; is {ENV_API} right?") from None
    raise AssertionError("the last attempt returns or raises")


class _BusyError(Exception):
    """An attempt that may be made again."""


class _NoRedirect(urllib.request.HTTPRedirectHandler):
    def redirect_request(self, *_: Any, **__: Any) -> None:
        """Follow none: what was sent to one host goes to no other."""


def _sent(endpoint: Endpoint, body: bytes, headers: Mapping[str, str]) -> bytes:
    """Body of the reply to one request."""
    # The address was checked where it was read: http or https, given by the owner.
    request = urllib.request.Request(endpoint.url + PATHS[endpoint.api], body, dict(headers), method="POST")  # noqa: S310
    # A proxy of the environment would carry what is meant for this machine out of it.
    here = [urllib.request.ProxyHandler({})] if urlsplit(endpoint.url).hostname in LOOPBACK else []
    opener = urllib.request.build_opener(_NoRedirect, *here)
    deadline = time.monotonic() + TIMEOUT_S
    try:
        with opener.open(request, timeout=TIMEOUT_S) as response:
            found = bytearray()
            while part := response.read1(65536):
                found += part
                if len(found) > MOST_BYTES:
                    raise ReaderError(
                        f"{endpoint.name} answered with more than {MOST_BYTES} bytes, which is no answer to what was asked"
                    )
                if time.monotonic() > deadline:
                    raise _BusyError(f"no whole answer within {TIMEOUT_S:g} s")
            return bytes(found)
    except urllib.error.HTTPError as error:
        # Its text may repeat what was sent, the key among it: the state is told alone.
        error.close()
        if error.code in AGAIN:
            raise _BusyError(f"HTTP {error.code}") from None
        what = "it points elsewhere, which is not followed" if 300 <= error.code < 400 else "see its own log"
        raise ReaderError(
            f"{endpoint.name} answered with HTTP {error.code}: {what}; check {ENV_URL}, {ENV_MODEL} and {ENV_KEY_FILE}"
        ) from None
    except (OSError, HTTPException) as error:
        reason = getattr(error, "reason", error)
        raise _BusyError(f"{type(reason).__name__}") from None


def _openai(endpoint: Endpoint, text: str, pictures: Sequence[ReviewPicture]) -> dict[str, Any]:
    shown = [{"type": "image_url", "image_url": {"url": f"data:image/{p.format};base64,{_coded(p)}"}} for p in pictures]
    message = {"role": "user", "content": [*shown, {"type": "text", "text": text}]}
    return {"model": endpoint.model, "messages": [message], "max_tokens": MOST_TOKENS, "temperature": 0}


def _anthropic(endpoint: Endpoint, text: str, pictures: Sequence[ReviewPicture]) -> dict[str, Any]:
    shown = [
        {"type": "image", "source": {"type": "base64", "media_type": f"image/{p.format}", "data": _coded(p)}} for p in pictures
    ]
    message = {"role": "user", "content": [*shown, {"type": "text", "text": text}]}
    return {"model": endpoint.model, "messages": [message], "max_tokens": MOST_TOKENS}


def _coded(picture: ReviewPicture) -> str:
    return base64.b64encode(picture.data).decode()


def _reply(endpoint: Endpoint, found: Any) -> str:
    """Text of a reply of either API."""
    try:
        if endpoint.api == "anthropic":
            if found.get("stop_reason") == "refusal":
                raise ReaderError(f"{endpoint.name} refused to answer; ask another model, or a person")
            text = "".join(block["text"] for block in found["content"] if block["type"] == "text")
        else:
            message = found["choices"][0]["message"]
            if message.get("refusal"):
                raise ReaderError(f"{endpoint.name} refused to answer; ask another model, or a person")
            text = message["content"]
        if isinstance(text, str) and text.strip():
            return text
    except (KeyError, IndexError, TypeError, AttributeError):
        pass
    raise ReaderError(f"{endpoint.name} answered with no text in the form of the {endpoint.api} API; is {ENV_API} right?")
