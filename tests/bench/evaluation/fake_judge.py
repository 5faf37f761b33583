"""A judge for tests behind Inspect's own model layer: it counts, answers as told, fails, hangs, or talks nonsense."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Any

import anyio
from inspect_ai.model import (
    ChatMessage,
    ContentImage,
    ContentText,
    GenerateConfig,
    ModelAPI,
    ModelOutput,
    ModelUsage,
    get_model,
    modelapi,
)

__all__ = ["FakeJudge", "answering", "perfect"]

SCORES = {
    '"completion"': '{"completion": 1}',
    '"link"': '{"link": 0.5}',
    '"viewpoints"': '{"viewpoints": 4, "transitions": 5, "motion": 3}',
    '"fidelity"': '{"fidelity": 5, "composition": 4, "consistency": 3, "overall": 4}',
    "yes or no": "Yes.",
}


def perfect(text: str) -> str:
    """The answer of a judge that knows what it is asked for."""
    return next(answer for word, answer in SCORES.items() if word in text)


class FakeJudge(ModelAPI):
    """A provider that keeps in `asked` what it was asked: texts and pictures."""

    def __init__(
        self,
        model_name: str,
        base_url: str | None = None,
        api_key: str | None = None,
        config: GenerateConfig | None = None,
        **arguments: Any,
    ) -> None:
        super().__init__(model_name, base_url, api_key, [], config or GenerateConfig())
        self.reply: Callable[[str, int], Any] = arguments.get("reply") or (lambda text, _: perfect(text))
        self.asked: list[tuple[str, list[str]]] = []
        self.times: Counter[str] = Counter()

    async def generate(self, input: list[ChatMessage], tools: Any, tool_choice: Any, config: GenerateConfig) -> ModelOutput:  # noqa: A002
        (message,) = input
        text = next(c.text for c in message.content if isinstance(c, ContentText))
        self.asked.append((text, [c.image for c in message.content if isinstance(c, ContentImage)]))
        self.times[text] += 1
        answer = self.reply(text, self.times[text])
        if answer == "hang":
            await anyio.sleep(60)
        if isinstance(answer, Exception):
            raise answer
        output = ModelOutput.from_content(self.model_name, str(answer))
        output.usage = ModelUsage(input_tokens=100, output_tokens=7, total_tokens=107)
        return output


@modelapi(name="fakejudge")
def fakejudge() -> type[ModelAPI]:
    """Registers it with Inspect."""
    return FakeJudge


def answering(reply: Callable[[str, int], Any] = lambda text, _: perfect(text), **arguments: Any) -> tuple[Any, FakeJudge]:
    """A judge model that answers a text at its n-th asking, and its provider with the counts."""
    model = get_model("fakejudge/x", memoize=False, reply=reply, **arguments)
    assert isinstance(model.api, FakeJudge)
    return model, model.api
