"""Asking the client about a bake: its model by sampling where it offers that, else its user by a form; it counts as `client`.

Clients of 2026-07-28 get the questions in the answer of the call and make it again with theirs; earlier ones are sent requests.
"""

from __future__ import annotations

import base64
import json
import logging
from collections.abc import Awaitable, Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import anyio.to_thread
import pydantic
from mcp.server.mcpserver import Context
from mcp.shared.exceptions import MCPError
from mcp.shared.message import ServerMessageMetadata
from mcp.types import (
    CallToolResult,
    CreateMessageRequest,
    CreateMessageRequestParams,
    CreateMessageResult,
    ElicitRequest,
    ElicitRequestFormParams,
    ElicitResult,
    ImageContent,
    InputRequiredResult,
    SamplingMessage,
    TextContent,
)

from ..worlds.errors import InputError
from .extensions.tasks import HANDOVER

if TYPE_CHECKING:
    from ..workflow.review.client import ClientAsked

__all__ = ["with_client"]

INPUT_REQUIRED = "2026-07-28"
"""First version of the protocol in which questions come in the answer of a call."""
MOST_TOKENS = 4000
CHOICE, SPANS, FORM = "review_choice", "review_spans", "review_form"

logger = logging.getLogger(__name__)


async def with_client(
    context: Context[Any, Any], workspace: Path, world: str, run: Callable[[], Awaitable[CallToolResult]]
) -> CallToolResult | InputRequiredResult:
    """The result of a review, after the client was asked where nobody else reads and it can be asked.

    Args:
        context: of the call.
        workspace: root of all worlds.
        world: which is read.
        run: the call itself; made again after answers, since it writes their rows.
    """
    from ..workflow.review.client import asked_of_client

    answers: Mapping[str, Any] | None = context.input_responses
    result = None
    if not answers:
        result = await run()
        if result.is_error or HANDOVER.get() is not None or (result.structured_content or {}).get("read_by") != "nobody":
            return result
    asked = await anyio.to_thread.run_sync(asked_of_client, workspace, world)
    requests = {} if asked is None else _requests(context, asked)
    if asked is None or not requests:
        return result or await run()
    if not answers:
        if (context.protocol_version or "") >= INPUT_REQUIRED:
            return InputRequiredResult(input_requests=requests)
        answers = await _sent(context, requests)
    note = await anyio.to_thread.run_sync(_record, asked, answers)
    again = await run()
    if note:
        _warn(again, note)
    return again


def _requests(context: Context[Any, Any], asked: ClientAsked) -> dict[str, Any]:
    """Requests that this client can answer, by key; the parts would give the prompt away, so that they are another one than the choice."""
    from ..workflow.review.client import form_of

    able = context.client_capabilities
    if able is not None and able.sampling is not None:
        return {CHOICE: _question(asked, asked.questions.choice_text()), SPANS: _question(asked, asked.questions.spans_text())}
    form = able.elicitation if able is not None else None
    if form is not None and (form.form is not None or form.url is None):
        message, schema = form_of(asked)
        return {FORM: ElicitRequest(params=ElicitRequestFormParams(message=message, requested_schema=schema))}
    return {}


def _question(asked: ClientAsked, text: str) -> CreateMessageRequest:
    blocks: list[Any] = [
        ImageContent(type="image", data=base64.b64encode(p.data).decode(), mime_type=f"image/{p.format}") for p in asked.pictures
    ]
    message = SamplingMessage(role="user", content=[*blocks, TextContent(type="text", text=text)])
    return CreateMessageRequest(params=CreateMessageRequestParams(messages=[message], max_tokens=MOST_TOKENS))


async def _sent(context: Context[Any, Any], requests: Mapping[str, Any]) -> dict[str, Any]:
    """Answers of a client of an earlier version, to requests of the server; none where it refuses."""
    found: dict[str, Any] = {}
    for key, request in requests.items():
        kind = ElicitResult if key == FORM else CreateMessageResult
        try:
            found[key] = await context.session.send_request(
                request, kind, metadata=ServerMessageMetadata(related_request_id=context.request_id)
            )
        except (MCPError, pydantic.ValidationError):
            logger.debug("the client did not answer %s", key)
    return found


def _record(asked: ClientAsked, answers: Mapping[str, Any]) -> str:
    """Keep the answers; why not, where they are none."""
    from ..workflow.review.client import recorded

    form = answers.get(FORM)
    try:
        if isinstance(form, ElicitResult):
            if form.action != "accept":
                return f"the client's user chose to {form.action}: nobody has read the world"
            recorded(asked, "user of the client", None, dict(form.content or {}))
            return ""
        choice, spans = answers.get(CHOICE), answers.get(SPANS)
        if not isinstance(choice, CreateMessageResult) or not isinstance(spans, CreateMessageResult):
            return "the client's model did not answer: nobody has read the world"
        recorded(asked, spans.model, _text(choice), _text(spans))
    except InputError as error:
        return f"the client's answer could not be read: {error}"
    return ""


def _text(result: CreateMessageResult) -> str:
    blocks = result.content if isinstance(result.content, list) else [result.content]
    return "".join(b.text for b in blocks if isinstance(b, TextContent))


def _warn(result: CallToolResult, note: str) -> None:
    """Put a warning into a reply, both forms of it."""
    if result.structured_content is None:
        return
    result.structured_content["warnings"] = [*result.structured_content.get("warnings", ()), note]
    for k, block in enumerate(result.content):
        if isinstance(block, TextContent):
            result.content[k] = TextContent(
                type="text", text=json.dumps(result.structured_content, ensure_ascii=False, separators=(",", ":"))
            )
            return
