"""Align: agreement of every frame with the prompt by the Perception Encoder (R148), through `open_clip`.

    s = 100 / T * sum over all decoded frames of f_t . g ,

with L2-normalised embeddings of frame and text. Torch and open_clip come with the extra `[metrics]`; weights are fetched by open_clip from
their publisher at the first use (about 2.7 GB) and belong to its own licence. Without them there is a refusal and no number.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from itertools import islice
from pathlib import Path
from typing import Any

from ....worlds.arrays import U8
from ....worlds.errors import RefusedError
from .film import Film

__all__ = ["CHECKPOINT", "MODEL", "Alignment", "Encoder", "align", "load_encoder", "need_packages"]

MODEL, CHECKPOINT = "PE-Core-L-14-336", "meta"
"""Names by which open_clip knows the paper's checkpoint; its weights are `timm/PE-Core-L-14-336` on the Hugging Face hub."""
CONVENTION = {"image_mean": (0.5,) * 3, "image_std": (0.5,) * 3, "image_interpolation": "bilinear", "image_resize_mode": "squash"}
"""Preprocessing of the checkpoint itself: the whole frame squashed to 336 x 336, nothing cropped."""
INSTALL = "pip install 'worldagent[metrics]'"
FETCH = f"hf download timm/{MODEL}"
BATCH = 16
"""Frames per pass."""


@dataclass(frozen=True)
class Encoder:
    """A loaded model with its own preprocessing and tokenizer."""

    model: Any
    preprocess: Any
    tokenizer: Any
    device: str
    name: str
    weights: str


@dataclass(frozen=True)
class Alignment:
    """The score of one film with all that it rests on."""

    value: float
    frames: int
    text_tokens_used: int
    """Tokens of the text that count; the encoder has room for 32 with their two ends, and cuts longer texts."""
    text_tokens: int
    """That the whole text has."""
    model: str
    weights: str
    preprocess: str
    device: str
    dtype: str
    versions: dict[str, str]

    def as_json(self) -> dict[str, Any]:
        """Plain data for logs and reports."""
        return asdict(self)


def need_packages(metric: str, *names: str) -> None:
    """Refuse a metric whose packages are not installed.

    Raises:
        RefusedError: with the command that installs them.
    """
    missing = [name for name in names if importlib.util.find_spec(name) is None]
    if missing:
        raise RefusedError(f"{metric} needs {' and '.join(missing)}, not installed here; {INSTALL}")


def load_encoder(*, model: str = MODEL, weights: str = CHECKPOINT, device: str | None = None) -> Encoder:
    """The model by open_clip's own loading code.

    Args:
        model: name of a configuration of open_clip.
        weights: name of published weights, or the path of a file.
        device: default the first GPU, else the processor.

    Raises:
        RefusedError: packages or weights are missing.
    """
    need_packages("Align", "torch", "open_clip")
    from pickle import UnpicklingError

    import open_clip
    import torch

    if Path(weights).suffix and not Path(weights).is_file():
        raise RefusedError(f"Align: there is no file {weights!r} with weights of {model}; {FETCH}")
    chosen = device or ("cuda" if torch.cuda.is_available() else "cpu")
    try:
        made, preprocess = open_clip.create_model_from_pretrained(model, pretrained=weights, device=chosen, **CONVENTION)
        tokenizer = open_clip.get_tokenizer(model)
    except (OSError, RuntimeError, ValueError, UnpicklingError) as error:
        said = str(error).strip().splitlines() or [type(error).__name__]
        raise RefusedError(
            f"Align: weights {weights!r} of {model} cannot be loaded ({said[0][:300]}); fetch them where the hub is reached: {FETCH}"
        ) from error
    return Encoder(made.eval(), preprocess, tokenizer, chosen, model, weights)


def align(film: Film, text: str, encoder: Encoder) -> Alignment:
    """100 times the mean cosine of every decoded frame with a text."""
    import open_clip
    import torch
    from torch.nn.functional import normalize

    tokens = encoder.tokenizer([text])
    whole = len(encoder.tokenizer.encode(text))
    used = min(whole, int(tokens.shape[1]) - 2)
    total, count = 0.0, 0
    with torch.inference_mode():
        goal = normalize(encoder.model.encode_text(tokens.to(encoder.device)).double(), dim=-1)[0]
        for batch in _batches(film.frames()):
            images = torch.stack([encoder.preprocess(_picture(frame)) for frame in batch]).to(encoder.device)
            found = normalize(encoder.model.encode_image(images).double(), dim=-1)
            total += float((found @ goal).sum())
            count += len(batch)
    return Alignment(
        value=100.0 * total / count,
        frames=count,
        text_tokens_used=used,
        text_tokens=whole,
        model=encoder.name,
        weights=encoder.weights,
        preprocess=" ".join(str(encoder.preprocess).split()),
        device=encoder.device,
        dtype=str(next(encoder.model.parameters()).dtype).removeprefix("torch."),
        versions={"torch": torch.__version__, "open_clip": open_clip.__version__},
    )


def _batches(frames: Iterator[U8]) -> Iterator[list[U8]]:
    while batch := list(islice(frames, BATCH)):
        yield batch


def _picture(frame: U8) -> Any:
    """A frame as open_clip's preprocessing takes it."""
    import numpy as np
    from PIL import Image

    return Image.fromarray(np.ascontiguousarray(frame))
