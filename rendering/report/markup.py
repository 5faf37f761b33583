"""Pieces of HTML for the report: every text of a stranger is escaped here."""

from __future__ import annotations

import base64
import html
from collections.abc import Iterable, Sequence
from typing import Any

from ...worlds.quoting import visible

__all__ = ["cell", "escaped", "figure", "table", "tag"]


def escaped(value: Any) -> str:
    """Text as HTML, with nothing in it that acts or hides."""
    return html.escape(visible(str(value)), quote=True)


def tag(name: str, inner: str, **attributes: str) -> str:
    """An element around HTML that is escaped already."""
    given = "".join(f' {k.rstrip("_").replace("_", "-")}="{escaped(v)}"' for k, v in attributes.items())
    return f"<{name}{given}>{inner}</{name}>"


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table of escaped cells; the head is plain text."""
    body = "".join(tag("tr", "".join(cells)) for cells in rows)
    titles = "".join(tag("th", escaped(h), scope="col") for h in head)
    return tag("div", tag("table", tag("thead", tag("tr", titles)) + tag("tbody", body)), class_="scroll")


def cell(inner: str, kind: str = "") -> str:
    """A cell of a table around HTML that is escaped already."""
    return tag("td", inner, class_=kind) if kind else tag("td", inner)


def figure(data: bytes | None, caption: str, alternative: str) -> str:
    """A picture within the page, PNG or JPEG; nothing where there is none."""
    if data is None:
        return ""
    kind = "png" if data.startswith(b"\x89PNG") else "jpeg"
    source = f"data:image/{kind};base64,{base64.b64encode(data).decode()}"
    return tag("figure", f'<img alt="{escaped(alternative)}" src="{source}">' + tag("figcaption", escaped(caption)))
