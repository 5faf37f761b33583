"""A client's model, or its user, reads a world where nobody else does: in both eras of the protocol, and counted as `client`."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Awaitable, Callable
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any, Literal

import pytest
from mcp import Client
from mcp.types import CreateMessageResult, ElicitResult, TextContent
from pydantic import Field
from worldagent.server.app import create_server
from worldagent.tests.stories.small_run import PROMPT, small_spec
from worldagent.tests.tools.conftest import context, told
from worldagent.tools.edit_spec import edit_spec
from worldagent.workflow.answers import answer
from worldagent.workflow.context import ToolBinding, ToolContext, ToolReply
from worldagent.workflow.review.conduct import current, place_of, readers_of
from worldagent.workflow.review.endpoint import ENV_MODEL, ENV_URL
from worldagent.workflow.review.questions import Questions, asked_of, prompts_to_choose
from worldagent.workflow.session import Session
from worldagent.worlds.folder import WorldFolder, write_atomically
from worldagent.worlds.provenance import recipes

__all__ = ["context", "told"]
CLAIMS = {
    "c1": {"quote": "ball", "type": "thing", "by": ["/entities/ball"]},
    "c2": {"quote": "falls off", "type": "event", "by": ["/story/beats/fall"]},
}
SHOWN = '{"answers": {"1": "shown", "2": "not shown"}}'


def run_checks(
    context: ToolContext,
    world: Annotated[str, Field(description="World id")],
    scope: Annotated[Literal["review", "audit"], Field(description="What is judged")],
) -> ToolReply:
    """Stand-in for the tool, which renders nothing: it tells who has read the world."""
    session = Session.open(context.workspace, world)
    found = current(session.folder, session.spec)
    reader = "nobody" if found is None else readers_of(session, found)[1]
    return ToolReply(answer({"scope": scope, "read_by": reader}, f"read by {reader}", ""))


@pytest.fixture
def session(context: ToolContext) -> Session:
    """A world whose questions are written, as a review of a bake writes them."""
    edit_spec(context, world="w", prompt=PROMPT, spec=small_spec(claims=CLAIMS))
    session = Session.at(WorldFolder.of(context.workspace, "w"))
    spans, left_out = asked_of(session.spec)
    prompts, right = prompts_to_choose(PROMPT, "d")
    questions = Questions("5 things", (hashlib.sha256(b"picture").hexdigest(),), spans, left_out, prompts, right)
    root = session.folder.root / "reviews"
    write_atomically(root / place_of(questions.digest) / "picture_1.png", b"picture")
    write_atomically(root / place_of(questions.digest) / "questions.json", json.dumps(asdict(questions)).encode())
    about = {"digest": questions.digest, "recipe": recipes(session.spec)["final"], "cache_digest": "c"}
    write_atomically(root / "current.json", json.dumps(about).encode())
    return session


class Model:
    """A client's model with fixed replies."""

    def __init__(self, spans: str = SHOWN) -> None:
        self.spans, self.asked = spans, list[Any]()

    async def __call__(self, context: Any, params: Any) -> CreateMessageResult:
        blocks = params.messages[0].content
        self.asked.append(blocks)
        own = "Which of these prompts" in blocks[-1].text
        text = (
            next(json.dumps({"prompt": k}) for k in range(1, 7) if f'{k}. "{PROMPT}"' in blocks[-1].text) if own else self.spans
        )
        return CreateMessageResult(role="assistant", model="client-model", content=TextContent(type="text", text=text))


def user(action: str) -> Callable[..., Awaitable[ElicitResult]]:
    async def fill(context: Any, params: Any) -> ElicitResult:
        fields = params.requested_schema["properties"]
        return ElicitResult(action=action, content=dict.fromkeys(fields, "shown") if action == "accept" else None)

    return fill


async def asked(workspace: Path, era: str, **more: Any) -> Any:
    binding = ToolBinding(run_checks, "Check", read_only=False)
    async with Client(create_server(workspace, tools=[binding]), mode=era, **more) as client:
        result = await client.call_tool("run_checks", {"world": "w", "scope": "review"})
    assert not result.is_error, result.content
    return result.structured_content


@pytest.mark.anyio
async def test_a_client_without_a_model_or_a_form_is_not_asked(session: Session, era: str) -> None:
    assert (await asked(session.folder.root.parent, era))["read_by"] == "nobody"
    assert session.ledger.reviews() == []


@pytest.mark.anyio
async def test_the_clients_model_reads_pictures_and_account_and_counts_as_client(session: Session, era: str) -> None:
    model = Model()
    found = await asked(session.folder.root.parent, era, sampling_callback=model)
    assert found["read_by"] == "client"
    (review,) = session.ledger.reviews()
    assert (review.reader, review.name, review.choice) == ("client", "client-model", review.right)
    assert review.answers == {"c1": "shown", "c2": "not shown"}
    assert [blocks[0].mime_type for blocks in model.asked] == ["image/png", "image/png"]
    assert sum("(event)" in blocks[-1].text for blocks in model.asked) == 1, "the choice gives no part away"


@pytest.mark.anyio
async def test_an_answer_of_the_clients_model_that_cannot_be_read_is_told_and_not_kept(session: Session, era: str) -> None:
    found = await asked(session.folder.root.parent, era, sampling_callback=Model('{"answers": {"1": "shown"}}'))
    assert found["read_by"] == "nobody"
    assert "no answer about the parts 2" in found["warnings"][-1]
    assert session.ledger.reviews() == []


@pytest.mark.anyio
async def test_the_clients_user_answers_a_form_without_the_choice(session: Session, era: str) -> None:
    found = await asked(session.folder.root.parent, era, elicitation_callback=user("accept"))
    assert found["read_by"] == "client"
    (review,) = session.ledger.reviews()
    assert (review.choice, review.answers) == (None, {"c1": "shown", "c2": "shown"})


@pytest.mark.anyio
async def test_a_user_who_declines_has_not_read(session: Session, era: str) -> None:
    found = await asked(session.folder.root.parent, era, elicitation_callback=user("decline"))
    assert found["read_by"] == "nobody"
    assert "chose to decline" in found["warnings"][-1]


@pytest.mark.anyio
async def test_where_the_owner_names_a_model_the_client_is_not_asked(
    session: Session, era: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(ENV_URL, "http://127.0.0.1:9/v1")
    monkeypatch.setenv(ENV_MODEL, "m")
    model = Model()
    assert (await asked(session.folder.root.parent, era, sampling_callback=model))["read_by"] == "nobody"
    assert model.asked == []
