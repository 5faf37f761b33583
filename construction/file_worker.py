"""Reads one file from outside, or decomposes one mesh, alone in a process of bounded memory and time.

Anyone may have written what it reads. The command is `mesh`, `dem` or `decompose` and the extension of the file, which is on
stdin; arrays come back on stdout (`.npz`). Nothing else is opened: what a file names (materials, textures, buffers in other
files or at addresses) is not followed. Exit code 3 with one line on stderr means that the file is at fault.
"""

from __future__ import annotations

import io
import os
import sys
from typing import Any

__all__ = ["CPU_SECONDS", "MEMORY_BYTES", "REFUSED", "main"]

MEMORY_BYTES = 4 * 1024**3
"""Address space of the process [bytes]; libraries map about 1 GB of it."""
CPU_SECONDS = {"mesh": 20, "dem": 60, "decompose": 120}
"""Processor time by command [s]."""
REFUSED = 3
COACD_THRESHOLD = 0.05
"""Concavity at which CoACD stops [fraction of size]: its documented default."""
TAG_PIXEL_SCALE, TAG_NO_DATA = 33550, 42113
"""GeoTIFF ModelPixelScale and GDAL_NODATA."""
LARGEST = 1e9
"""Largest coordinate [m], as everywhere in a specification."""


def main(command: str, extension: str) -> int:
    """Work on stdin; returns the exit code."""
    _limit(CPU_SECONDS[command])
    wire = os.dup(1)
    os.dup2(2, 1)  # what libraries print is no answer
    try:
        arrays = {"mesh": _mesh, "dem": _dem, "decompose": _decompose}[command](sys.stdin.buffer.read(), extension)
    except Exception as error:
        print(f"{type(error).__name__}: {str(error)[:300]}", file=sys.stderr)  # noqa: T201
        return REFUSED
    import numpy as np

    with os.fdopen(wire, "wb") as stream:
        np.savez(stream, **arrays)
    return 0


def _limit(seconds: int) -> None:
    try:
        import resource
    except ImportError:  # Windows: the parent's time limit remains
        return
    for kind, amount in (
        (resource.RLIMIT_AS, MEMORY_BYTES),
        (resource.RLIMIT_CPU, seconds),
        (resource.RLIMIT_FSIZE, 0),
        (resource.RLIMIT_CORE, 0),
    ):
        hard = resource.getrlimit(kind)[1]
        resource.setrlimit(kind, (amount if hard == resource.RLIM_INFINITY else min(amount, hard), hard))


def _mesh(data: bytes, extension: str) -> dict[str, Any]:
    import numpy as np
    import trimesh

    loaded = trimesh.load_mesh(io.BytesIO(data), file_type=extension, process=True)
    vertices, faces = np.asarray(loaded.vertices, dtype=np.float64), np.asarray(loaded.faces, dtype=np.int64)
    if vertices.ndim != 2 or vertices.shape[1:] != (3,) or faces.ndim != 2 or faces.shape[1:] != (3,) or not len(faces):
        raise ValueError("it holds no triangles")
    if not np.isfinite(vertices).all() or np.abs(vertices).max() > LARGEST:
        raise ValueError("it has coordinates that are not finite or beyond 1e9")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise ValueError("a face names a vertex that it does not have")
    return {"vertices": vertices, "faces": faces}


def _dem(data: bytes, extension: str) -> dict[str, Any]:
    """`values`, NaN where the file says no data, and `cell`, the side of a cell [m] where it says so."""
    import numpy as np

    cell: float | None = None
    if extension == "npy":
        values = np.load(io.BytesIO(data), allow_pickle=False)
    elif extension == "npz":
        with np.load(io.BytesIO(data), allow_pickle=False) as found:
            values = found["elevation" if "elevation" in found else found.files[0]]
    else:
        os.environ["OPENCV_IO_MAX_IMAGE_PIXELS"] = str(1 << 28)
        import cv2

        values = cv2.imdecode(np.frombuffer(data, dtype=np.uint8), cv2.IMREAD_UNCHANGED)
        if values is None:
            raise ValueError("no picture in it")
        if extension in ("tif", "tiff"):
            values, cell = _geotiff(data, values)
    return {"values": np.asarray(values), **({} if cell is None else {"cell": np.array(cell)})}


def _geotiff(data: bytes, image: Any) -> tuple[Any, float | None]:
    import numpy as np
    import tifffile

    with tifffile.TiffFile(io.BytesIO(data)) as file:
        tags = file.pages.first.tags
        scale, empty = tags.get(TAG_PIXEL_SCALE), tags.get(TAG_NO_DATA)
        values = image.astype(np.float64)
        if empty is not None:
            values[values == float(str(empty.value).strip("\x00 "))] = np.nan
        size = None if scale is None else float(scale.value[0])
    # Degrees, not metres: a geographic file says nothing usable about cell size.
    return values, size if size is not None and size > 0.05 else None


def _decompose(data: bytes, extension: str) -> dict[str, Any]:
    import coacd
    import numpy as np

    with np.load(io.BytesIO(data), allow_pickle=False) as given:
        vertices, faces = given["vertices"], given["faces"]
    coacd.set_log_level("error")
    parts = coacd.run_coacd(
        coacd.Mesh(vertices, faces),
        threshold=COACD_THRESHOLD,
        # Thinned hulls leave the visible surface outside of them: 8 mm on a torus of 0.4 m, against 0.04 mm.
        decimate=False,
        seed=0,
    )
    return {f"piece{k:06d}": np.asarray(points, dtype=np.float64) for k, (points, _) in enumerate(parts)}


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
