"""The judge behind one interface: a model that sees pictures and answers a text, asked with time-outs and retries.

`InspectJudge` reaches any provider of Inspect's model layer (OpenAI, Anthropic, Google, a local server). What no try answers stays
without a score, with the reason of each try.
"""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import anyio

from .questions import Question
from .rubrics import read_scores

if TYPE_CHECKING:
    from inspect_ai.model import Model

__all__ = ["Answered", "InspectJudge", "Judge", "JudgeIdentity", "Reply", "put"]

TRIES = 3
"""Times that a question is put before it stays without a score."""
SECONDS = 180.0
"""Longest wait for one answer [s]."""
MOST_TOKENS = 2048
"""Tokens of an answer with what a model thinks before it."""
SHOWN = 200
"""Letters of an answer that a reason quotes."""


class Reply(NamedTuple):
    """A judge's words, and the tokens that they took; None where it does not tell."""

    text: str
    input_tokens: int | None
    output_tokens: int | None


@dataclass(frozen=True)
class JudgeIdentity:
    """Who judged, as far as is known; it travels with every result (numbers of different judges do not compare)."""

    backend: str
    """Layer and its version: `inspect_ai 0.3.285`."""
    model: str
    dtype: str | None = None
    """Type of the weights; None where a provider does not tell."""
    arguments: dict[str, str] = field(default_factory=dict)
    """Model arguments that were given, but keys and addresses."""


class Judge(Protocol):
    """Whoever answers a text about pictures."""

    @property
    def identity(self) -> JudgeIdentity:
        """Who it is."""

    async def answer(self, text: str, pictures: Sequence[bytes]) -> Reply:
        """Its words about JPEG pictures in temporal order; any exception is a failed try."""


class InspectJudge:
    """A model of Inspect's layer, at temperature 0.

    Args:
        model: default the one of the role `grader` (`--model-role grader=openai/...`), which must be given.
    """

    def __init__(self, model: Model | None = None) -> None:
        from inspect_ai.model import get_model

        self._model = model or get_model(role="grader", required=True)

    @property
    def identity(self) -> JudgeIdentity:
        """Provider and name of the model, and its arguments without secrets."""
        from importlib.metadata import version

        known = {str(k): str(v) for k, v in self._model.model_args.items() if isinstance(v, str | int | float | bool)}
        told = {
            k: v for k, v in known.items() if not any(word in k.lower() for word in ("key", "token", "url", "path", "secret"))
        }
        return JudgeIdentity(
            f"inspect_ai {version('inspect_ai')}", str(self._model), told.get("torch_dtype") or told.get("dtype"), told
        )

    async def answer(self, text: str, pictures: Sequence[bytes]) -> Reply:
        """The model's completion for the pictures, then the text."""
        from inspect_ai.model import ChatMessageUser, ContentImage, ContentText, GenerateConfig

        images = [ContentImage(image=f"data:image/jpeg;base64,{base64.b64encode(p).decode()}") for p in pictures]
        message = ChatMessageUser(content=[*images, ContentText(text=text)])
        config = GenerateConfig(temperature=0.0, max_tokens=MOST_TOKENS, max_retries=1)
        output = await self._model.generate([message], config=config)
        usage = output.usage
        return Reply(output.completion, usage.input_tokens if usage else None, usage.output_tokens if usage else None)


@dataclass(frozen=True)
class Answered:
    """The outcome of one question."""

    key: str
    scores: dict[str, float] | None
    """None where no try gave any."""
    tries: int
    pictures: int
    """Sent, over all tries."""
    input_tokens: int
    output_tokens: int
    told: bool
    """True where the judge told its tokens at every try that it answered."""
    reasons: tuple[str, ...]
    """Why tries failed."""

    def as_json(self) -> dict[str, Any]:
        """Plain data."""
        return asdict(self)


async def put(
    judge: Judge, question: Question, pictures: Sequence[bytes], *, tries: int = TRIES, seconds: float = SECONDS
) -> Answered:
    """Put a question until it is answered with scores, at most `tries` times, each for at most `seconds`."""
    reasons: list[str] = []
    spent, told, scores = [0, 0], True, None
    for _ in range(tries):
        try:
            with anyio.fail_after(seconds):
                reply = await judge.answer(question.text, pictures)
        except TimeoutError:
            reasons.append(f"no answer in {seconds:g} s")
            continue
        except Exception as error:  # providers raise what they like, and a judgement that fails is no score
            reasons.append(f"{type(error).__name__}: {error}"[:SHOWN])
            continue
        spent = [spent[0] + (reply.input_tokens or 0), spent[1] + (reply.output_tokens or 0)]
        told = told and reply.input_tokens is not None
        scores = read_scores(question.rubric, reply.text)
        if scores is not None:
            break
        reasons.append(f"no scores: {reply.text.strip()[:SHOWN]!r}")
    made = len(reasons) + (scores is not None)
    return Answered(question.key, scores, made, made * len(pictures), spent[0], spent[1], told, tuple(reasons))
