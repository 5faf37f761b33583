"""Video files from rendered frames, verified by reading them again."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from ..worlds.errors import EngineError, InputError

__all__ = ["VideoFile", "write_video"]

_CODECS = (("VP9", "VP90", ".webm"), ("VP8", "VP80", ".webm"), ("MPEG-4 part 2", "mp4v", ".mp4"), ("Motion JPEG", "MJPG", ".avi"))
"""Name, four-character code, container: what OpenCV is asked for, best first."""
ENCODE_SECONDS = 1800


class VideoFile(NamedTuple):
    """A video as it was written."""

    path: Path
    """The container's suffix may differ from what was asked for when the codec could not be had."""
    codec: str
    frames: int
    width: int
    height: int
    note: str
    """Why this codec, where it is not the one that the suffix asks for; else empty."""


def _read(path: Path) -> Any:
    import cv2

    image = cv2.imread(str(path), cv2.IMREAD_COLOR)
    if image is None:
        raise InputError(f"frame {path.name!r} is missing or no picture; render the sequence again")
    return image


def _verify(path: Path, count: int, width: int, height: int) -> None:
    """Decode all frames of `path`.

    Raises:
        EngineError: it cannot be read, or count or size differ.
    """
    import cv2

    video = cv2.VideoCapture(str(path))
    found = 0
    shapes = set()
    while True:
        good, image = video.read()
        if not good:
            break
        found += 1
        shapes.add(image.shape[:2])
    video.release()
    if found != count or shapes != {(height, width)}:
        raise EngineError(
            f"video {path.name!r} reads back as {found} frames of {sorted(shapes)}; "
            f"expected {count} of {(height, width)}; try another suffix"
        )


def _even(image: Any) -> Any:
    """Crop to even width and height, which every codec here needs."""
    return image[: image.shape[0] // 2 * 2, : image.shape[1] // 2 * 2]


def _with_opencv(frames: Sequence[Path], path: Path, fps: float, code: str) -> bool:
    import cv2

    first = _even(_read(frames[0]))
    height, width = first.shape[:2]
    level = cv2.utils.logging.getLogLevel()
    cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    try:
        writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*code), fps, (width, height))
        if not writer.isOpened():
            return False
        for frame in frames:
            image = _even(_read(frame))
            if image.shape != first.shape:
                raise InputError(
                    f"frame {frame.name!r} has shape {image.shape}, the first has {first.shape}; render all at one size"
                )
            writer.write(image)
        writer.release()
    finally:
        cv2.utils.logging.setLogLevel(level)
    return True


def _with_ffmpeg(program: str, frames: Sequence[Path], path: Path, fps: float) -> bool:
    height, width = _even(_read(frames[0])).shape[:2]
    command = [program, "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "bgr24", "-s", f"{width}x{height}"]
    command += [
        "-r",
        str(fps),
        "-i",
        "-",
        "-c:v",
        "libx264",
        "-crf",
        "18",
        "-pix_fmt",
        "yuv420p",
        "-movflags",
        "+faststart",
        str(path),
    ]
    child = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    assert child.stdin is not None
    try:
        for frame in frames:
            child.stdin.write(_even(_read(frame)).tobytes())
        child.stdin.close()
    except BrokenPipeError:
        pass
    return child.wait(timeout=ENCODE_SECONDS) == 0


def write_video(frames: Sequence[Path], path: Path, fps: float) -> VideoFile:
    """Write pictures as a video and check that it reads back with the same count and size.

    `.webm` asks for VP9, `.mp4` for H.264 through an `ffmpeg` process (MPEG-4 part 2 where there is none), `.avi`
    for Motion JPEG. Where this OpenCV lacks a codec the next best is taken, in its own container, and `note` says so.
    An odd row or column at the border is cropped.

    Raises:
        InputError: no frames, a frame is unreadable or of another size, or the suffix is not one of the three.
        EngineError: no codec worked, or the file does not read back as written.
    """
    if not frames:
        raise InputError("a video needs at least one frame; render a sequence first")
    if path.suffix not in (".webm", ".mp4", ".avi"):
        raise InputError(f"video suffix is {path.suffix!r}; allowed are .webm, .mp4 and .avi")
    path.parent.mkdir(parents=True, exist_ok=True)
    height, width = _even(_read(frames[0])).shape[:2]
    program = shutil.which("ffmpeg")
    temporary = path.with_name(f"{path.stem}.part.mp4")
    if path.suffix == ".mp4" and program is not None and _with_ffmpeg(program, frames, temporary, fps):
        _verify(temporary, len(frames), width, height)
        temporary.replace(path)
        return VideoFile(path, "H.264", len(frames), width, height, "")
    preferred = [c for c in _CODECS if c[2] == path.suffix]
    for name, code, suffix in preferred + [c for c in _CODECS if c not in preferred]:
        target = path.with_suffix(suffix)
        temporary = path.with_name(f"{path.stem}.part{suffix}")
        if _with_opencv(frames, temporary, fps, code):
            _verify(temporary, len(frames), width, height)
            temporary.replace(target)
            wanted = {".webm": "VP9", ".mp4": "H.264", ".avi": "Motion JPEG"}[path.suffix]
            reason = "no ffmpeg with libx264" if path.suffix == ".mp4" else "this OpenCV cannot write it"
            note = "" if name == wanted else f"{wanted} was asked for, but {reason}: {name} in {target.name}"
            return VideoFile(target, name, len(frames), width, height, note)
        temporary.unlink(missing_ok=True)
    raise EngineError("this OpenCV can write none of VP9, VP8, MPEG-4 and Motion JPEG; install ffmpeg and ask for .mp4")
