"""Scopes of tokens, checked for every MCP message.

A missing scope is told as an error result of the tool, not as HTTP 403: clients answer 403 by looking for an OAuth server
and drop the whole connection, while the model that made the call can read the result and go on with what it may do.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

from mcp.server.auth.middleware.bearer_auth import AuthenticatedUser
from mcp.server.context import CallNext, HandlerResult, ServerRequestContext
from mcp.shared.exceptions import MCPError

from ..workflow.context import ToolBinding
from .calls import error_result

__all__ = ["INSUFFICIENT_SCOPE", "ScopeCheck", "reads_only"]

INSUFFICIENT_SCOPE = -32003
"""JSON-RPC error of a method other than tools/call that the token's scope does not cover."""
READING_ACTIONS: Final[Mapping[str, frozenset[str]]] = {"job": frozenset({"status", "wait", "list"})}
"""Tools that change something by some of their actions only: the actions that do not."""
WRITING_METHODS: Final = frozenset({"tasks/cancel", "tasks/update"})


def reads_only(binding: ToolBinding, arguments: Mapping[str, Any]) -> bool:
    """True if a call changes nothing, so that a read token may make it."""
    return binding.read_only or arguments.get("action") in READING_ACTIONS.get(binding.name, ())


class ScopeCheck:
    """Server middleware: refuses what the token of the HTTP request does not allow. On stdio there is no token."""

    def __init__(self, tools: Sequence[ToolBinding]) -> None:
        self._tools = {binding.name: binding for binding in tools}

    async def __call__(self, ctx: ServerRequestContext[Any, Any], call_next: CallNext) -> HandlerResult:
        """Pass a message on, or refuse it."""
        user = getattr(ctx.request, "scope", {}).get("user")
        if not isinstance(user, AuthenticatedUser) or "write" in user.scopes:
            return await call_next(ctx)
        params = ctx.params or {}
        if ctx.method in WRITING_METHODS:
            raise MCPError(INSUFFICIENT_SCOPE, f"insufficient_scope: {ctx.method} needs a token of scope 'write'")
        if ctx.method == "tools/call":
            binding = self._tools.get(str(params.get("name")))
            arguments = params.get("arguments")
            if binding is not None and not reads_only(binding, arguments if isinstance(arguments, Mapping) else {}):
                return error_result(
                    f"insufficient_scope: {binding.name} changes the world and needs a token of scope 'write'; this one has "
                    "scope 'read'. Read with inspect_world, job(action='status') and resources, or ask the user for a token "
                    "made by: worldagent token add NAME --scope write"
                )
        return await call_next(ctx)
