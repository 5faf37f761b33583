"""Skills (extension `io.modelcontextprotocol/skills`, SEP-2640): which skills there are, and the digests of their files.

The files themselves are resources, `skill://<name>/<path>`.

References:
    https://github.com/modelcontextprotocol/modelcontextprotocol/pull/2640
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from typing import Any, Final

from mcp.server.context import HandlerResult, ServerRequestContext
from mcp.server.extension import Extension, MethodBinding
from mcp.shared.exceptions import MCPError
from mcp.types import PaginatedRequestParams, RequestParams
from mcp_types import INVALID_PARAMS

from ..skill_files import SKILLS, skill_files, skill_frontmatter, skill_names

__all__ = ["Skills"]

SKILLS_ID: Final = "io.modelcontextprotocol/skills"
_CACHE: Final = {"ttlMs": 86_400_000, "cacheScope": "public"}
"""Skills change with the installed version only."""


class SkillParams(RequestParams):
    """Names a skill by the URI of its SKILL.md."""

    uri: str


class Skills(Extension):
    """Lists the skills of this installation."""

    identifier = SKILLS_ID

    def methods(self) -> Sequence[MethodBinding]:
        """The two methods of the extension."""
        return (
            MethodBinding("skills/list", PaginatedRequestParams, self._list),
            MethodBinding("skills/get", SkillParams, self._get),
        )

    async def _list(self, ctx: ServerRequestContext[Any, Any], params: PaginatedRequestParams) -> HandlerResult:
        return {"skills": [_entry(name) for name in skill_names()], **_CACHE}

    async def _get(self, ctx: ServerRequestContext[Any, Any], params: SkillParams) -> HandlerResult:
        known = {f"skill://{name}/SKILL.md": name for name in skill_names()}
        if params.uri not in known:
            raise MCPError(
                INVALID_PARAMS, f"there is no skill {params.uri!r}; known skills: {sorted(known)}", {"uri": params.uri}
            )
        return {"skill": _entry(known[params.uri]), **_CACHE}


def _entry(name: str) -> dict[str, Any]:
    resources = []
    for path in skill_files(name):
        data = (SKILLS / name / path).read_bytes()
        digest = f"sha256:{hashlib.sha256(data).hexdigest()}"
        resources.append({"uri": f"skill://{name}/{path}", "digest": digest, "size": len(data)})
    return {"uri": f"skill://{name}/SKILL.md", "frontmatter": skill_frontmatter(name), "resources": resources}
