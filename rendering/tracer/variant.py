"""Which Mitsuba variant this machine can run, proven in a child process before it is trusted.

Dr.Jit loads any libLLVM it finds, and versions 14 and 15 abort the process; a CUDA driver may lack OptiX. So a
candidate renders a tiny scene in a child first. Proofs are kept per machine in the user's cache folder, keyed by
the library and the versions they hold for.
"""

from __future__ import annotations

import ctypes
import hashlib
import json
import os
import platform
import re
import subprocess
import sys
from dataclasses import dataclass
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from ...worlds.errors import EngineError

__all__ = ["ENV_VARIANT", "Variant", "choose_variant", "load_mitsuba"]

ENV_VARIANT = "WORLDAGENT_MITSUBA_VARIANT"
"""Environment variable that forces a variant, for tests and for machines where the proof misleads."""
OLDEST_LLVM = 16
PROOF_SECONDS = 180
_LIBRARY_FOLDERS = (
    "/usr/lib/x86_64-linux-gnu",
    "/usr/lib/aarch64-linux-gnu",
    "/usr/lib64",
    "/usr/lib",
    "/usr/local/lib",
    "/opt/homebrew/opt/llvm/lib",
)
_NAMES = ("libLLVM.so.*", "libLLVM-*.so", "libLLVM-*.so.*", "libLLVM.dylib")
_PROOF = """
import sys
import mitsuba as mi
mi.set_variant(sys.argv[1])
scene = mi.load_dict({
    "type": "scene", "integrator": {"type": "path"},
    "sensor": {"type": "perspective", "to_world": mi.ScalarTransform4f().look_at([0, -4, 0], [0, 0, 0], [0, 0, 1]),
               "film": {"type": "hdrfilm", "width": 8, "height": 8}},
    "light": {"type": "constant"}, "ball": {"type": "sphere"},
})
import numpy as np
image = np.array(mi.render(scene, spp=4))
assert np.isfinite(image).all() and 0.05 < image[4, 4, 0] < 1.0
print("proven")
"""


@dataclass(frozen=True)
class Variant:
    """A Mitsuba variant that works here."""

    name: str
    """`cuda_ad_rgb`, `llvm_ad_rgb` or `scalar_rgb`."""
    why: str
    """Why this one and not a faster one, in one sentence."""
    llvm_path: str | None
    """Shared library of LLVM, for `llvm_ad_rgb`."""


def _cache_file() -> Path:
    base = os.environ.get("XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache") / "worldagent" / "mitsuba_variants.json"


def _read_cache() -> dict[str, Any]:
    try:
        found = json.loads(_cache_file().read_text())
    except (OSError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}


def _key(name: str, library: Path | None) -> str:
    facts: list[Any] = [name, platform.node(), platform.machine(), version("mitsuba"), version("drjit"), _PROOF]
    if library is not None:
        stat = library.stat()
        facts += [str(library), stat.st_size, stat.st_mtime_ns]
    return hashlib.sha256(json.dumps(facts).encode()).hexdigest()[:24]


def _prove(name: str, library: Path | None) -> bool:
    """True if a child process renders with the variant; remembered per machine."""
    key, cache = _key(name, library), _read_cache()
    if key in cache:
        return bool(cache[key]["works"])
    environment = dict(os.environ)
    if library is not None:
        environment["DRJIT_LIBLLVM_PATH"] = str(library)
    try:
        child = subprocess.run(
            [sys.executable, "-c", _PROOF, name],
            env=environment,
            capture_output=True,
            timeout=PROOF_SECONDS,
            check=False,
            text=True,
        )
    except (OSError, subprocess.TimeoutExpired):
        return False
    works = child.returncode == 0 and "proven" in child.stdout
    cache = _read_cache() | {key: {"variant": name, "library": str(library or ""), "works": works, "exit": child.returncode}}
    file = _cache_file()
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        temporary = file.with_suffix(f".{os.getpid()}.tmp")
        temporary.write_text(json.dumps(cache, indent=1, sort_keys=True))
        temporary.replace(file)
    except OSError:
        pass
    return works


def _major(path: Path) -> int | None:
    """Major version that a library's file name tells."""
    for name in (path.name, path.resolve().name):
        found = re.search(r"libLLVM(?:\.so\.|-)(\d+)", name)
        if found:
            return int(found.group(1))
    return None


def _llvm_candidates() -> list[Path]:
    """Libraries of LLVM 16 or newer; the one named in DRJIT_LIBLLVM_PATH first, then newest first."""
    named = os.environ.get("DRJIT_LIBLLVM_PATH")
    first = [Path(named)] if named and Path(named).is_file() and (_major(Path(named)) or OLDEST_LLVM) >= OLDEST_LLVM else []
    found: dict[Path, int] = {}
    for folder in _LIBRARY_FOLDERS:
        for pattern in _NAMES:
            for path in Path(folder).glob(pattern) if Path(folder).is_dir() else ():
                major = _major(path)
                if major is not None and major >= OLDEST_LLVM:
                    found.setdefault(path.resolve(), major)
    return first + sorted(found, key=lambda p: -found[p])


def _has_cuda_driver() -> bool:
    try:
        ctypes.CDLL("nvcuda.dll" if sys.platform == "win32" else "libcuda.so.1")
    except OSError:
        return False
    return True


@lru_cache(maxsize=4)
def _choose(forced: str | None) -> Variant:
    libraries = _llvm_candidates() if forced in (None, "llvm_ad_rgb") else []
    if forced == "scalar_rgb":
        return Variant("scalar_rgb", f"{ENV_VARIANT} asks for it", None)
    if forced in (None, "cuda_ad_rgb") and _has_cuda_driver() and _prove("cuda_ad_rgb", None):
        return Variant("cuda_ad_rgb", "a child process rendered with CUDA and OptiX", None)
    for library in libraries:
        if _prove("llvm_ad_rgb", library):
            return Variant("llvm_ad_rgb", f"a child process rendered with {library.name}", str(library))
    if forced is not None:
        raise EngineError(
            f"{ENV_VARIANT}={forced!r} does not work here; allowed are cuda_ad_rgb, llvm_ad_rgb and scalar_rgb; "
            "unset it, or install libllvm19 (LLVM) or an OptiX-capable driver (CUDA)"
        )
    reason = (
        f"{len(libraries)} libLLVM found but none worked" if libraries else "no libLLVM of version 16 or newer (apt: libllvm19)"
    )
    return Variant("scalar_rgb", f"no working CUDA device, and {reason}", None)


def choose_variant() -> Variant:
    """The fastest variant that is proven to work on this machine.

    Raises:
        EngineError: the variant forced through the environment does not work.
    """
    return _choose(os.environ.get(ENV_VARIANT) or None)


def load_mitsuba(variant: Variant | None = None) -> Any:
    """Import Mitsuba and activate `variant` (default: the chosen one)."""
    chosen = variant or choose_variant()
    if chosen.llvm_path is not None:
        os.environ["DRJIT_LIBLLVM_PATH"] = chosen.llvm_path
    import mitsuba

    if mitsuba.variant() != chosen.name:
        mitsuba.set_variant(chosen.name)
    # Its warnings go to standard output, which commands keep for their answer.
    mitsuba.set_log_level(mitsuba.LogLevel.Error)
    return mitsuba
