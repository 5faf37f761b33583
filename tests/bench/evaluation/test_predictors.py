"""Align and Imag: refusals where packages or weights are missing, and the real loading code on small models made here (R148, R149)."""

from __future__ import annotations

import importlib.util
import json
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from worldagent.bench.evaluation.metrics import align as module
from worldagent.bench.evaluation.metrics.align import align, load_encoder
from worldagent.bench.evaluation.metrics.film import Film
from worldagent.bench.evaluation.metrics.imaging import QualityModel, imaging_quality, imaging_size, load_quality_model
from worldagent.tests.bench.evaluation.films import film_file
from worldagent.worlds.errors import RefusedError

TORCH = pytest.mark.skipif(importlib.util.find_spec("torch") is None, reason="torch comes with the extra [metrics]")
CLIP = pytest.mark.skipif(importlib.util.find_spec("open_clip") is None, reason="open_clip comes with the extra [metrics]")
SMALL = {
    "embed_dim": 8,
    "vision_cfg": {"image_size": 336, "layers": 1, "width": 16, "head_width": 8, "patch_size": 112},
    "text_cfg": {"context_length": 32, "vocab_size": 49408, "width": 16, "heads": 2, "layers": 1},
}
"""A model with the frame size and the text context of the paper's checkpoint, and little else."""
TEXT = "A red ball falls. " * 20


def without(monkeypatch: pytest.MonkeyPatch, *names: str) -> None:
    find = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util,
        "find_spec",
        lambda name, *a: None if name in names else ModuleType(name) if name in ("torch", "open_clip") else find(name, *a),
    )


@pytest.mark.parametrize(("missing", "said"), [(("torch", "open_clip"), "torch and open_clip"), (("open_clip",), "open_clip")])
def test_align_without_its_packages_is_refused_with_the_command(
    monkeypatch: pytest.MonkeyPatch, missing: tuple[str, ...], said: str
) -> None:
    without(monkeypatch, *missing)
    with pytest.raises(RefusedError, match=rf"needs {said}, not installed here; pip install 'worldagent\[metrics\]'"):
        load_encoder()


def test_imag_without_its_predictor_names_package_weights_and_licence(monkeypatch: pytest.MonkeyPatch) -> None:
    without(monkeypatch, "torch")
    with pytest.raises(RefusedError, match="Imag needs torch"):
        load_quality_model()
    without(monkeypatch, "pyiqa")
    with pytest.raises(RefusedError, match=r"musiq_spaq_ckpt-358bb6af\.pth.*PolyForm Noncommercial.*pip install pyiqa"):
        load_quality_model()


def test_no_extra_brings_the_non_commercial_package() -> None:
    text = (Path(__file__).parents[3] / "pyproject.toml").read_text()
    assert "pyiqa" not in text.partition("[project.scripts]")[0]


@pytest.mark.parametrize(
    ("size", "wanted"),
    [
        ((1080, 1920), (288, 512)),
        ((512, 512), (512, 512)),
        ((300, 500), (300, 500)),
        ((1000, 513), (512, 262)),
        ((720, 1280), (288, 512)),
    ],
)
def test_frames_above_512_are_shrunk_and_smaller_ones_kept(size: tuple[int, int], wanted: tuple[int, int]) -> None:
    """VBench's rule `longer`."""
    assert imaging_size(*size) == wanted


@pytest.fixture
def weights(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    import open_clip
    import torch

    (tmp_path / "small-pe.json").write_text(json.dumps(SMALL))
    open_clip.add_model_config(tmp_path / "small-pe.json")
    torch.manual_seed(5)
    torch.save(open_clip.create_model("small-pe").state_dict(), tmp_path / "small.pt")
    return tmp_path / "small.pt"


@CLIP
def test_a_film_is_aligned_by_the_mean_cosine_of_every_frame(weights: Path, tmp_path: Path) -> None:
    import open_clip
    import torch

    film = Film(film_file(tmp_path / "film.avi", 37, size=(90, 160)))
    found = align(film, TEXT, load_encoder(model="small-pe", weights=str(weights), device="cpu"))
    model = open_clip.create_model("small-pe", pretrained=str(weights)).eval()
    cosines = []
    with torch.no_grad():
        goal = model.encode_text(open_clip.get_tokenizer("small-pe")([TEXT]))[0].numpy()
        for frame in film.frames():
            picture = torch.from_numpy(np.ascontiguousarray(frame)).permute(2, 0, 1)[None].float() / 255.0
            squashed = torch.nn.functional.interpolate(picture, size=(336, 336), mode="bilinear", antialias=True)
            one = model.encode_image((squashed - 0.5) / 0.5)[0].numpy()
            cosines.append(float(one @ goal / np.linalg.norm(one) / np.linalg.norm(goal)))
    assert found.value == pytest.approx(100.0 * np.mean(cosines), abs=0.05)
    assert found.frames == 37
    assert (found.text_tokens_used, found.text_tokens) == (30, 100)
    assert "336" in found.preprocess
    assert found.dtype == "float32"
    json.dumps(found.as_json())


@CLIP
def test_other_weights_give_another_score(weights: Path, tmp_path: Path) -> None:
    import open_clip
    import torch

    film = Film(film_file(tmp_path / "film.avi", 4))
    torch.manual_seed(6)
    torch.save(open_clip.create_model("small-pe").state_dict(), tmp_path / "other.pt")
    one, two = (
        align(film, TEXT, load_encoder(model="small-pe", weights=str(w), device="cpu")).value
        for w in (weights, tmp_path / "other.pt")
    )
    assert one != pytest.approx(two, abs=1e-3)


@CLIP
@pytest.mark.parametrize("content", [None, b"no weights at all"])
def test_align_without_weights_is_refused_and_gives_no_number(weights: Path, tmp_path: Path, content: bytes | None) -> None:
    path = tmp_path / "absent.pt"
    if content is not None:
        path.write_bytes(content)
    for told in (str(path), "", "no_such_tag"):
        with pytest.raises(RefusedError, match="hf download timm/PE-Core-L-14-336"):
            load_encoder(model="small-pe", weights=told, device="cpu")


@CLIP
def test_the_papers_checkpoint_is_refused_where_the_hub_is_out_of_reach(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """The real loading code of the default model, offline."""
    constants = pytest.importorskip("huggingface_hub.constants")
    monkeypatch.setattr(constants, "HF_HUB_OFFLINE", True)
    monkeypatch.setattr(constants, "HF_HUB_CACHE", str(tmp_path))
    with pytest.raises(RefusedError, match=f"weights 'meta' of {module.MODEL} cannot be loaded"):
        load_encoder(device="cpu")


@TORCH
def test_imaging_quality_is_the_mean_over_every_frame_over_a_hundred(tmp_path: Path) -> None:
    """The predictor here is the mean grey, so that the rest of the protocol is known."""
    seen: list[tuple[int, ...]] = []

    def predict(picture: Any) -> float:
        seen.append(tuple(picture.shape))
        return float(100.0 * picture.mean())

    film = Film(film_file(tmp_path / "film.avi", 9, size=(360, 640)))
    found = imaging_quality(film, QualityModel(predict, "mean grey", "cpu", {}))
    assert set(seen) == {(1, 3, 288, 512)}
    assert found.frames == 9
    assert found.value == pytest.approx(np.mean([frame.mean() / 255.0 for frame in film.frames()]), abs=0.01)


@TORCH
def test_the_predictor_is_made_by_the_packages_own_loading_code(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where pyiqa is importable, it gets the metric's name and the device, and its failure is a refusal."""
    import torch

    fake = ModuleType("pyiqa")
    fake.__spec__ = importlib.util.spec_from_loader("pyiqa", loader=None)
    fake.__version__ = "0"  # type: ignore[attr-defined]
    asked: list[Any] = []

    def create_metric(name: str, *, device: Any) -> Any:
        asked.append((name, device))
        if len(asked) > 1:
            raise OSError("cannot reach the hub")
        return lambda picture: torch.tensor([[50.0 * float(picture.max())]])

    fake.create_metric = create_metric  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "pyiqa", fake)
    made = load_quality_model(device="cpu")
    assert asked == [("musiq-spaq", torch.device("cpu"))]
    assert made.predict(torch.ones(1, 3, 4, 4)) == 50.0
    with pytest.raises(RefusedError, match="cannot reach the hub"):
        load_quality_model(device="cpu")
