"""The public surface of the package."""

from __future__ import annotations

import subprocess
import sys


def test_importing_geometry_loads_no_heavy_library():
    """Choice: the server starts fast."""
    code = (
        "import sys, worldagent.geometry; print([m for m in ('fcl', 'warp', 'scipy', 'trimesh', 'mujoco') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_every_public_name_exists():
    import worldagent.geometry as geometry

    assert sorted(geometry.__all__) == geometry.__all__
    assert all(hasattr(geometry, name) for name in geometry.__all__)
