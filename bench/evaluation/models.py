"""A model that plays a list of tool calls, for tests of loops and programs that need a model: `--model scripted/NAME`.

Several samples share one model and speak to it in turns, so that it counts the answers of tools in what it is shown, and keeps
nothing itself. The list is JSON: `[{"tool": ..., "arguments": {...}}, ...]`; after its end the model says `done`. `$world` in an
argument stands for the name of the sample's world, and `$prompt` for its scene.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from inspect_ai.model import (
    ChatMessage,
    ChatMessageTool,
    GenerateConfig,
    ModelAPI,
    ModelOutput,
    ModelUsage,
    modelapi,
)
from inspect_ai.tool import ToolChoice, ToolInfo

from ...worlds.errors import InputError

__all__ = ["ScriptedModel"]

_SCENE = re.compile(r"Scene prompt \((\w+), \w+\)\..*?\n\n(.*?)\n\nFinally, save the scene", re.DOTALL)
TOKENS = 100
"""Told as used by one turn: nothing counts them here."""


@modelapi(name="scripted")
class ScriptedModel(ModelAPI):
    """Plays the calls of the file that the model argument `calls` names (`-M calls=FILE`)."""

    def __init__(
        self,
        model_name: str,
        base_url: str | None = None,
        api_key: str | None = None,
        config: GenerateConfig = GenerateConfig(),  # noqa: B008 - the signature of the interface
        calls: str = "",
        **_: Any,
    ) -> None:
        super().__init__(model_name, base_url, api_key, [], config)
        if not calls:
            raise InputError("the model scripted/NAME needs the file of its calls: -M calls=FILE")
        self.calls: list[dict[str, Any]] = json.loads(Path(calls).read_text(encoding="utf-8"))

    async def generate(
        self,
        input: list[ChatMessage],  # noqa: A002 - the signature of the interface
        tools: list[ToolInfo],
        tool_choice: ToolChoice,
        config: GenerateConfig,
    ) -> ModelOutput:
        """The next call of the list, or `done`."""
        played = sum(isinstance(message, ChatMessageTool) for message in input)
        usage = ModelUsage(input_tokens=TOKENS, output_tokens=TOKENS, total_tokens=2 * TOKENS)
        if played >= len(self.calls):
            return ModelOutput(
                model=self.model_name, choices=ModelOutput.from_content(self.model_name, "done").choices, usage=usage
            )
        call = self.calls[played]
        text = "\n".join(message.text for message in input if message.role == "user")
        arguments = _filled(call.get("arguments", {}), _SCENE.search(text))
        made = ModelOutput.for_tool_call(self.model_name, _named(call["tool"], tools), arguments)
        made.usage = usage
        return made


def _named(tool: str, tools: list[ToolInfo]) -> str:
    """The name under which an agent offers a tool: some put the server's before it."""
    return next((t.name for t in tools if t.name == tool or t.name.endswith(f"__{tool}")), tool)


def _filled(value: Any, scene: re.Match[str] | None) -> Any:
    if isinstance(value, dict):
        return {k: _filled(v, scene) for k, v in value.items()}
    if isinstance(value, list):
        return [_filled(v, scene) for v in value]
    if scene is not None and value in ("$world", "$prompt"):
        return scene.group(1) if value == "$world" else scene.group(2)
    return value
