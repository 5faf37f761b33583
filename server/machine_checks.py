"""Requirements on the machine: Python, packages, memory, room for temporary files and caches, limits of a process, a clock."""

from __future__ import annotations

import ctypes
import os
import platform
import re
import shutil
import sys
import tempfile
import time
from importlib.metadata import PackageNotFoundError, metadata, requires
from pathlib import Path

from .capabilities import PACKAGES, package_version
from .check import Check, reinstall

__all__ = [
    "MACHINE_CHECKS",
    "caches",
    "clock",
    "ffmpeg",
    "libraries",
    "limits",
    "memory",
    "packages",
    "python",
    "temporary_files",
]

OLDEST_PYTHON = (3, 11)
LEAST_MEMORY_BYTES = 2_000_000_000
"""Own choice: the demo's processes peak below 1 GB together; a scene with textures or many triangles needs more."""
LEAST_TEMPORARY_BYTES = 500_000_000
LEAST_FILES = 256
"""Open files of one process; macOS starts programs with a window with 256."""
LEAST_ADDRESS_BYTES = 16_000_000_000
"""LLVM and CUDA reserve address space that they never touch."""
LEAST_FILE_BYTES = 1_000_000_000
SYSTEM_LIBRARIES = {"libatomic.so.1": "libatomic1"}
"""Libraries that wheels load from the system, and the Debian packages they are in."""
CLOCK_SLACK_S = 86_400.0
_CGROUP_LIMITS = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")
_PIN = re.compile(r"^([A-Za-z0-9._-]+)\s*==\s*([^\s;,]+)\s*$")


def python() -> list[Check]:
    """The interpreter's version."""
    wanted = ".".join(map(str, OLDEST_PYTHON))
    return [
        Check(
            "python",
            sys.version_info >= OLDEST_PYTHON,
            f"{platform.python_version()} at {sys.executable} ({wanted} or newer)",
            cost="the package does not start",
            remedy=f"uv tool install --python {wanted} worldagent",
        )
    ]


def packages() -> list[Check]:
    """Each library: there, and of the version that this package names where it names exactly one."""
    pins = _pins()
    found = []
    for name in PACKAGES:
        version = package_version(name)
        pinned = pins.get(name, version)
        text = f"{version}, {_licence(name)}" if version else "not installed"
        found.append(
            Check(
                name,
                version is not None and version == pinned,
                text if version == pinned else f"{text}; this version of worldagent needs {pinned}",
                cost="the server or one of its engines does not start, or gives results that were never checked",
                remedy=reinstall(),
            )
        )
    return found


def _pins() -> dict[str, str]:
    try:
        lines = requires("worldagent") or []
    except PackageNotFoundError:
        return {}
    return {found.group(1): found.group(2) for line in lines if (found := _PIN.match(line))}


def _licence(name: str) -> str:
    """Licence as the distribution's metadata state it, in a few words."""
    try:
        facts = metadata(name)
    except PackageNotFoundError:
        return "unknown licence"
    classifiers = [line for line in facts.get_all("Classifier") or [] if line.startswith("License :: ")]
    stated = [*(facts.get_all("License-Expression") or []), *(line.rsplit(" :: ", 1)[-1] for line in classifiers)]
    first = next(iter([*stated, *(facts.get_all("License") or []), "unknown licence"])).strip().splitlines()[0]
    return re.sub(r"\s+", " ", first)[:60]


def libraries() -> list[Check]:
    """Libraries of the system that wheels expect; small images of containers leave them out."""
    if sys.platform != "linux":
        return []
    missing = [name for name in SYSTEM_LIBRARIES if not _loads(name)]
    return [
        Check(
            "system libraries",
            not missing,
            f"{', '.join(missing)} not found" if missing else ", ".join(SYSTEM_LIBRARIES),
            cost="Mitsuba does not load: no pictures and no film",
            remedy=f"sudo apt-get install {' '.join(SYSTEM_LIBRARIES[name] for name in missing)} (Fedora: dnf install libatomic)",
        )
    ]


def _loads(name: str) -> bool:
    try:
        ctypes.CDLL(name)
    except OSError:
        return False
    return True


def memory() -> list[Check]:
    """Memory that processes here may use: the machine's, or less in a container."""
    total = _physical_bytes()
    limit = _container_bytes()
    if total is None:
        return []
    usable = min(total, limit) if limit is not None else total
    inside = f", of which this container may use {usable / 1e9:.1f} GB" if usable < total else ""
    return [
        Check(
            "memory",
            usable >= LEAST_MEMORY_BYTES,
            f"{total / 1e9:.1f} GB{inside} ({LEAST_MEMORY_BYTES / 1e9:.0f} GB or more)",
            required=False,
            cost="the system ends workers that grow; their jobs fail and have to be resumed",
            remedy="close other programs, or give the container more: docker run --memory 4g ...",
        )
    ]


def _physical_bytes() -> int | None:
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return None


def _container_bytes() -> int | None:
    for name in _CGROUP_LIMITS:
        try:
            text = Path(name).read_text(encoding="ascii").strip()
        except OSError:
            continue
        if text.isdigit() and int(text) < 2**60:
            return int(text)
    return None


def limits() -> list[Check]:
    """Limits of a process that the shell or the service manager set."""
    if sys.platform == "win32":
        return []
    import resource

    low = []
    for kind, least, option, unit in (
        (resource.RLIMIT_NOFILE, LEAST_FILES, "-n", 1),
        (resource.RLIMIT_AS, LEAST_ADDRESS_BYTES, "-v", 1024),
        (resource.RLIMIT_FSIZE, LEAST_FILE_BYTES, "-f", 1024),
    ):
        soft, _ = resource.getrlimit(kind)
        if soft != resource.RLIM_INFINITY and soft < least:
            low.append((option, soft // unit, "unlimited" if unit > 1 else str(4 * least)))
    return [
        Check(
            "limits of a process",
            not low,
            ", ".join(f"ulimit {option} is {value}" for option, value, _ in low) or "files, address space and file size suffice",
            required=False,
            cost="engines fail to start, or files of caches and videos end early",
            remedy="; ".join(f"ulimit {option} {value}" for option, _, value in low) + " in the shell that starts the client",
        )
    ]


def clock() -> list[Check]:
    """Check whether the clock lies before the installation of this very package."""
    installed = Path(__file__).stat().st_mtime
    now = time.time()
    return [
        Check(
            "clock",
            now > installed - CLOCK_SLACK_S,
            f"{time.strftime('%Y-%m-%d %H:%M UTC', time.gmtime(now))}",
            required=False,
            cost="ages of jobs and expiry of tokens are wrong, downloads over TLS are refused",
            remedy="sudo timedatectl set-ntp true; inside WSL: sudo hwclock --hctosys",
        )
    ]


def temporary_files() -> list[Check]:
    """Room in the folder for temporary files."""
    try:
        folder = tempfile.gettempdir()
        with tempfile.TemporaryFile():
            free = shutil.disk_usage(folder).free
    except OSError as error:
        return [
            Check(
                "temporary files",
                False,
                str(error.strerror or error),
                cost="videos, bundles and meshes can't be written",
                remedy="export TMPDIR=$HOME/tmp with a folder that can be written",
            )
        ]
    return [
        Check(
            "temporary files",
            free >= LEAST_TEMPORARY_BYTES,
            f"{folder}, {free / 1e9:.1f} GB free ({LEAST_TEMPORARY_BYTES / 1e9:.1f} GB or more)",
            required=False,
            cost="long videos and large meshes can't be written",
            remedy="free some space there, or export TMPDIR=FOLDER",
        )
    ]


def caches() -> list[Check]:
    """Check whether compiled kernels and proofs can be kept; otherwise every process compiles them again."""
    base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    folder = base / "worldagent"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
        with tempfile.TemporaryFile(dir=base):
            pass
    except OSError as error:
        return [
            Check(
                "cache of kernels",
                False,
                f"{base}: {error.strerror}",
                required=False,
                cost="kernels are compiled anew by every worker, half a minute each time",
                remedy=f"sudo chown -R $(id -un) {base}, or export XDG_CACHE_HOME and WARP_CACHE_PATH to folders that can be written",
            )
        ]
    return [Check("cache of kernels", True, f"{base} can be written", required=False)]


def ffmpeg() -> list[Check]:
    """H.264 needs a program of its own."""
    path = shutil.which("ffmpeg")
    return [
        Check(
            "ffmpeg",
            path is not None,
            path or "not found",
            required=False,
            cost="video is VP9 (.webm) only, no H.264",
            remedy={"darwin": "brew install ffmpeg", "linux": "sudo apt-get install ffmpeg"}.get(
                sys.platform, "install ffmpeg and put it on the PATH"
            ),
        )
    ]


MACHINE_CHECKS = (python, packages, libraries, memory, limits, clock, temporary_files, caches, ffmpeg)
"""In the order of the report."""
