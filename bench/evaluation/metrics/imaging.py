"""Imag: VBench's imaging quality, MUSIQ with the SPAQ checkpoint over all frames (R149).

The one open implementation that VBench itself uses is `pyiqa`, whose licence is non-commercial (PolyForm Noncommercial); so it is in no extra of
this package. Who may use it installs it, and it is taken where it is importable; its weights are fetched at the first use. Without
it there is a refusal and no number.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from ....worlds.errors import RefusedError
from .align import need_packages
from .film import Film

__all__ = ["METRIC", "Imaging", "QualityModel", "imaging_quality", "imaging_size", "load_quality_model"]

METRIC = "musiq-spaq"
"""Name of the predictor in pyiqa; its scores go from 0 to 100."""
LONGEST = 512
"""Longest side of a frame; larger ones are shrunk, smaller ones kept [pixels]."""


@dataclass(frozen=True)
class QualityModel:
    """A predictor of the quality of one picture."""

    predict: Callable[[Any], float]
    """Score of an RGB tensor of values 0 to 1, shape (1, 3, height, width)."""
    name: str
    device: str
    versions: dict[str, str]


@dataclass(frozen=True)
class Imaging:
    """The score of one film with all that it rests on."""

    value: float
    frames: int
    size: tuple[int, int]
    """Height and width that the predictor saw [pixels]."""
    model: str
    device: str
    versions: dict[str, str]

    def as_json(self) -> dict[str, Any]:
        """Plain data for logs and reports."""
        return asdict(self)


def imaging_size(height: int, width: int) -> tuple[int, int]:
    """Height and width after VBench's rule `longer`: at most 512 on the longer side, cut down to whole pixels."""
    longer = max(height, width)
    if longer <= LONGEST:
        return height, width
    scale = LONGEST / longer
    return int(scale * height), int(scale * width)


def load_quality_model(*, device: str | None = None) -> QualityModel:
    """MUSIQ with the SPAQ checkpoint by pyiqa's own loading code.

    Raises:
        RefusedError: torch, pyiqa or the weights are missing.
    """
    need_packages("Imag", "torch")
    if importlib.util.find_spec("pyiqa") is None:
        raise RefusedError(
            "Imag needs MUSIQ with the weights musiq_spaq_ckpt-358bb6af.pth; the package pyiqa has both, under a non-commercial licence "
            "(PolyForm Noncommercial 1.0.0), so it comes with no extra: where you may use it, pip install pyiqa"
        )
    import pyiqa
    import torch

    chosen = device or ("cuda" if torch.cuda.is_available() else "cpu")
    try:
        made = pyiqa.create_metric(METRIC, device=torch.device(chosen))
    except (OSError, RuntimeError, ValueError) as error:
        said = str(error).strip().splitlines() or [type(error).__name__]
        raise RefusedError(
            f"Imag: pyiqa cannot load the weights of {METRIC} ({said[0][:300]}); create_metric({METRIC!r}) once where the hub is reached"
        ) from error
    return QualityModel(
        lambda picture: float(made(picture.to(chosen))), METRIC, chosen, {"torch": torch.__version__, "pyiqa": pyiqa.__version__}
    )


def imaging_quality(film: Film, model: QualityModel) -> Imaging:
    """Mean of the predicted quality of every decoded frame, over 100."""
    import torch
    from torch.nn.functional import interpolate

    total, count, size = 0.0, 0, (0, 0)
    with torch.inference_mode():
        for frame in film.frames():
            picture = torch.from_numpy(np.ascontiguousarray(frame)).permute(2, 0, 1)[None].float()
            size = imaging_size(frame.shape[0], frame.shape[1])
            if size != frame.shape[:2]:
                # VBench resizes before it divides by 255, bilinearly and without antialiasing.
                picture = interpolate(picture, size=size, mode="bilinear", align_corners=False, antialias=False).round()
            total += model.predict(picture / 255.0)
            count += 1
    return Imaging(total / (100.0 * count), count, size, model.name, model.device, model.versions)
