"""Small pictures of the server and its tools, drawn here: SVG in data URIs, so that no client fetches anything."""

from __future__ import annotations

import base64

from mcp.types import Icon

__all__ = ["SERVER_ICON", "icon_of"]

_FRAME = (
    '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 24 24" fill="none" stroke="{colour}" stroke-width="1.8" '
    'stroke-linecap="round" stroke-linejoin="round"><path d="{path}"/></svg>'
)
_COLOUR = "#0f766e"
_CUBE = "M12 3l7 4v8l-7 4-7-4V7zM5 7l7 4 7-4M12 11v8M3 22h18"
_PATHS = {
    "edit_spec": "M6 3h9l4 4v14H6zM15 3v4h4M9 12h7M9 16h5",
    "build_interior": "M3 21V4h18v17zM3 12h8m4 0h6M11 4v5m0 6v6",
    "build_terrain": "M2 19h20M3 19l6-10 4 6 3-4 5 8",
    "place_object": "M12 2v8M9 7l3 3 3-3M6 13h12v7H6zM3 22h18",
    "probe_sim": "M4 20c4-14 6-14 8-6s5 6 8-8M4 22h16",
    "bake_sim": "M4 5h16v14H4zM8 5v14M16 5v14M4 10h4M4 15h4M16 10h4M16 15h4",
    "run_checks": "M4 6l2 2 3-4M4 13l2 2 3-4M4 20l2 2 3-4M13 6h7M13 13h7M13 20h7",
    "render_shot": "M3 8h4l2-3h6l2 3h4v11H3zM12 10a3.5 3.5 0 1 0 .01 0",
    "inspect_world": "M10 4a6 6 0 1 0 .01 0M15 15l6 6",
    "job": "M12 3a9 9 0 1 0 .01 0M12 7v5l4 2",
}
"""Outline of each tool's icon; a tool without one of its own shows the server's."""


def _icon(path: str) -> Icon:
    drawing = _FRAME.format(colour=_COLOUR, path=path).encode()
    return Icon(src=f"data:image/svg+xml;base64,{base64.b64encode(drawing).decode()}", mime_type="image/svg+xml", sizes=["any"])


SERVER_ICON = _icon(_CUBE)


def icon_of(tool: str) -> Icon:
    """The icon of a tool."""
    return _icon(_PATHS.get(tool, _CUBE))
