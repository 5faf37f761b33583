"""Floor 5: pictures of a candidate. Importing this loads no renderer, no OpenCV and no engine."""

from .denoise import denoise, meter, tonemap
from .frames import FrameRenderer, frame_path, frame_recipe, render_frame, render_sequence
from .plan import plan_view, section_view
from .plots import ledger_series, plot_ledger
from .preview import PreviewRenderer, id_view, preview
from .sheet import Encoded, contact_sheet, encode
from .variant import Variant, choose_variant
from .video import VideoFile, write_video
from .views import automatic_camera, camera_for, focus_bounds, shot_of

__all__ = [
    "Encoded",
    "FrameRenderer",
    "PreviewRenderer",
    "Variant",
    "VideoFile",
    "automatic_camera",
    "camera_for",
    "choose_variant",
    "contact_sheet",
    "denoise",
    "encode",
    "focus_bounds",
    "frame_path",
    "frame_recipe",
    "id_view",
    "ledger_series",
    "meter",
    "plan_view",
    "plot_ledger",
    "preview",
    "render_frame",
    "render_sequence",
    "section_view",
    "shot_of",
    "tonemap",
    "write_video",
]
