"""Floor 5: pictures of a candidate. Importing this loads no renderer, no OpenCV and no engine."""

from .frames import FrameRenderer, frame_path, frame_recipe, render_frame, render_sequence, renderer_versions
from .highlight import highlight
from .land.field_map import field_map, hillshade
from .plan import plan_view, section_view
from .plots.account import plot_account
from .plots.ledger import ledger_series, plot_ledger
from .preview import PreviewRenderer, id_view, preview
from .report.encoded import ReportPictures
from .report.page import matrix_page
from .report.pictures import report_pictures, report_sheet
from .sheet import Encoded, contact_sheet, encode
from .tracer.denoise import denoise, meter, tonemap
from .tracer.variant import Variant, choose_variant
from .video import VideoFile, write_video
from .views import automatic_camera, camera_for, focus_bounds, shot_of

__all__ = [
    "Encoded",
    "FrameRenderer",
    "PreviewRenderer",
    "ReportPictures",
    "Variant",
    "VideoFile",
    "automatic_camera",
    "camera_for",
    "choose_variant",
    "contact_sheet",
    "denoise",
    "encode",
    "field_map",
    "focus_bounds",
    "frame_path",
    "frame_recipe",
    "highlight",
    "hillshade",
    "id_view",
    "ledger_series",
    "matrix_page",
    "meter",
    "plan_view",
    "plot_account",
    "plot_ledger",
    "preview",
    "render_frame",
    "render_sequence",
    "renderer_versions",
    "report_pictures",
    "report_sheet",
    "section_view",
    "shot_of",
    "tonemap",
    "write_video",
]
