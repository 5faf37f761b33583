"""Resource links to what acceptance wrote, and to the view of a world."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

__all__ = ["WORLD_VIEW", "proof_links"]

WORLD_VIEW = "ui://worldagent/world"
"""Resource that hosts of MCP Apps show beside a tool that names it."""

_KINDS = {"report": "text/html", "bundle": "application/zip"}


def proof_links(world: str, data: Mapping[str, Any]) -> tuple[tuple[str, str, str], ...]:
    """Links (name, URI, MIME type) to the report and the bundle that a result names by their paths in the world folder."""
    found = [(kind, str(data[kind])) for kind in _KINDS if data.get(kind)]
    return tuple((path.rpartition("/")[2], f"worldagent://worlds/{world}/{path}", _KINDS[kind]) for kind, path in found)
