"""The `worldagent` command."""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from .. import __version__
from ..worlds.errors import EngineError, InputError, WorldAgentError
from ..worlds.quoting import visible
from .bench_commands import add_bench_commands
from .default_workspace import ENV_WORKSPACE, default_workspace
from .token_commands import add_token_commands

__all__ = ["leave", "main"]

ENV_TOKEN = "WORLDAGENT_TOKEN"  # noqa: S105 - name of a variable
OK, FAILED, MISUSED = 0, 1, 2
_Command = Callable[[argparse.Namespace], int]
_Add = Callable[[str, _Command, str], argparse.ArgumentParser]
"""Adds a command by name, function and description."""
ON_WINDOWS = ("_setup", "_add", "_list", "_revoke")
"""Commands that work without the processes, locks and limits of POSIX: lists of clients and of tokens."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit code."""
    arguments = _parser().parse_args(argv)
    command: _Command = arguments.command
    try:
        if sys.platform == "win32" and command.__name__ not in ON_WINDOWS:
            raise EngineError(
                "jobs need the process groups of Linux and macOS, which Windows does not have. Run worldagent inside WSL2 "
                "(wsl --install, then there: uv tool install worldagent) or in its container; `worldagent setup CLIENT "
                "--through wsl` (in WSL) or `--through docker` gives the entry for a client on Windows"
            )
        return command(arguments)
    except WorldAgentError as error:
        print(f"worldagent: {visible(str(error))}", file=sys.stderr)
        return MISUSED
    except KeyboardInterrupt:
        return 130


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="worldagent", description="MCP server that turns a prompt into a verified physical world.", allow_abbrev=False
    )
    parser.add_argument("--version", action="version", version=f"worldagent {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    def add(name: str, function: _Command, text: str) -> argparse.ArgumentParser:
        made = commands.add_parser(name, help=text, description=text, allow_abbrev=False)
        made.set_defaults(command=function)
        return made

    _add_serve(add)
    add_token_commands(commands.add_parser("token", help="Issue, list and revoke bearer tokens."))
    _add_demo_and_doctor(add)
    _add_setup(add)
    _add_proofs(add)
    add("warm", _warm, "Compile kernels and prove the renderer's variant now rather than at first use.")
    add_bench_commands(add)
    return parser


def _add_serve(add: _Add) -> None:
    serve = add("serve", _serve, "Serve MCP over stdio (default) or HTTP.")
    serve.add_argument(
        "--workspace", type=Path, metavar="DIR", help=f"root of all worlds (default: ${ENV_WORKSPACE} or ~/worldagent)"
    )
    serve.add_argument("--transport", choices=("stdio", "http"), default="stdio")
    serve.add_argument("--host", default="127.0.0.1", help="HTTP: address to bind (default: %(default)s; others need a token)")
    serve.add_argument("--port", type=_port, default=8931, help="HTTP: port, 0 takes a free one (default: %(default)s)")
    serve.add_argument("--token", help=f"HTTP: bearer token (default: ${ENV_TOKEN}, which other users' ps does not show)")
    serve.add_argument(
        "--allow-host", action="append", default=[], metavar="NAME", help="HTTP: further name in Host and Origin headers"
    )
    serve.add_argument(
        "--allow-origin",
        action="append",
        default=[],
        metavar="ORIGIN",
        help="HTTP: origin besides the server's own whose pages may call it, e.g. https://tools.example",
    )
    serve.add_argument(
        "--conformance", action="store_true", help="serve the fixtures of the official MCP conformance suite too, for tests"
    )


def _add_demo_and_doctor(add: _Add) -> None:
    demo = add("demo", _demo, "A scripted MCP client takes a flawed specification to an accepted world and its film.")
    demo.add_argument("--seed", type=int, default=1, help="which flaws the first specification carries")
    demo.add_argument("--flaws", type=int, default=3, help="how many flaws")
    demo.add_argument("--out", default="demo-out", help="workspace folder")
    demo.add_argument("--final", action="store_true", help="film of 1920 x 1080 at 64 samples per pixel")
    demo.add_argument("--no-render", action="store_true", help="stop after acceptance")
    doctor = add("doctor", _doctor, "Check this installation; exit code 0 when everything required works.")
    doctor.add_argument("--repair", action="store_true", help="mend what is safe to mend unasked, and say what was done")
    doctor.add_argument("--json", action="store_true", help="print JSON instead of a table")
    doctor.add_argument("--workspace", type=Path, metavar="DIR", help="workspace to check")


def _add_setup(add: _Add) -> None:
    setup = add("setup", _setup, "Put this server into a client's list of servers; shows the entry unless told to write it.")
    setup.add_argument(
        "clients", nargs="*", metavar="CLIENT", help="claude-desktop, claude-code, codex, ...; none lists them all"
    )
    setup.add_argument("--write", action="store_true", help="change the list; the old file is kept beside it")
    setup.add_argument("--dry-run", action="store_true", help="show the lines that would change")
    setup.add_argument("--workspace", type=Path, metavar="DIR", help="root of all worlds that the client gets")
    setup.add_argument("--project", type=Path, metavar="DIR", help="the list of this project instead of the user's")
    setup.add_argument("--file", type=Path, help="the list lies here")
    setup.add_argument("--through", choices=("wsl", "docker"), help="started by wsl.exe, or inside the container `worldagent`")


def _add_proofs(add: _Add) -> None:
    """Commands that judge a world folder or a bundle."""
    verify = add(
        "verify",
        _verify,
        "Judge a world folder or an acceptance bundle by this installation's own verifiers; 0 only when accepted.",
    )
    verify.add_argument(
        "folder", type=Path, metavar="FOLDER_OR_BUNDLE", help="world folder (holds world.json), or a bundle (zip)"
    )
    verify.add_argument(
        "--replay", action="store_true", help="also re-simulate intervals from checkpoints and compare (always, for a bundle)"
    )
    verify.add_argument(
        "--intervals", type=_intervals, metavar="N|all", help="how many intervals to replay (default: 3, at random)"
    )
    verify.add_argument("--seed", type=int, metavar="N", help="chooses the intervals; default a new one, printed")
    verify.add_argument("--report", type=Path, metavar="OUT.html", help="also write the matrix report of this judgement")
    report = add("report", _report, "Judge a world folder now and write its matrix report, one HTML page; 0 only when accepted.")
    report.add_argument("folder", type=Path, metavar="FOLDER", help="world folder (holds world.json)")
    report.add_argument("--out", type=Path, required=True, metavar="OUT.html", help="the page")
    bundle = add(
        "bundle", _bundle, "Judge a world folder now and write its acceptance bundle; incomplete ones are marked as such."
    )
    bundle.add_argument("folder", type=Path, metavar="FOLDER", help="world folder (holds world.json)")
    bundle.add_argument("--out", type=Path, metavar="OUT.zip", help="the file (default: acceptance/<freeze>.zip in the world)")
    bundle.add_argument(
        "--caches",
        action=argparse.BooleanOptionalAction,
        help="take the frames along, or their digests only (default: unless they are large)",
    )
    recompute = add("recompute", _recompute, "Build and bake a world folder anew, then judge it; exit code 0 only when accepted.")
    recompute.add_argument("folder", type=Path, metavar="FOLDER", help="world folder (holds world.json)")
    volumes = add("volumes", _volumes, "Write the gas of a baked world as volumes (NanoVDB) for other renderers.")
    volumes.add_argument("folder", type=Path, metavar="FOLDER", help="world folder (holds world.json)")
    volumes.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder of the files")
    volumes.add_argument("--frames", type=int, nargs=2, metavar=("FIRST", "LAST"), help="default: all")
    volumes.add_argument("--suffix", choices=("nvdb", "vdb"), default="nvdb", help="vdb needs a Python with the module openvdb")


def _port(text: str) -> int:
    if not text.isdigit() or not 0 <= int(text) <= 65535:
        raise argparse.ArgumentTypeError(f"{text!r} must be an integer from 0 to 65535")
    return int(text)


def _serve(arguments: argparse.Namespace) -> int:
    import logging

    logging.basicConfig(level=logging.WARNING, stream=sys.stderr, format="%(asctime)s %(levelname)s %(name)s: %(message)s")
    from .quiet import silence_telemetry

    silence_telemetry()
    # Workers inherit the environment; the token is none of their business.
    token = os.environ.pop(ENV_TOKEN, None) or None
    workspace: Path = (arguments.workspace or default_workspace()).expanduser().absolute()
    if workspace.exists() and not workspace.is_dir():
        raise InputError(f"workspace {str(workspace)!r} is a file; give a folder")
    if arguments.transport == "http":
        from .http import serve_http

        serve_http(
            workspace,
            host=arguments.host,
            port=arguments.port,
            token=arguments.token or token,
            allowed_hosts=arguments.allow_host,
            allowed_origins=arguments.allow_origin,
            conformance=arguments.conformance,
            announce=lambda url: print(f"worldagent: listening on {url}", file=sys.stderr, flush=True),
        )
    else:
        import signal

        from .app import create_server

        # Ctrl-C ends the process as SIGTERM does: the SDK's read of stdin cannot be interrupted.
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        create_server(workspace, conformance=arguments.conformance).run("stdio")
    leave()
    return OK


def leave(*, patience_s: float = 1.5) -> None:
    """End the process even if a thread does not: the client is gone, and jobs live in processes of their own.

    Args:
        patience_s: How long tools may take to notice that their call was given up [s].
    """
    import logging
    import threading
    import time

    deadline = time.monotonic() + patience_s
    others = [thread for thread in threading.enumerate() if thread is not threading.current_thread() and not thread.daemon]
    for thread in others:
        thread.join(max(0.0, deadline - time.monotonic()))
    if any(thread.is_alive() for thread in others):
        logging.shutdown()
        sys.stderr.flush()
        os._exit(OK)


def _demo(arguments: argparse.Namespace) -> int:
    from ..examples.domino_run import show

    return show(arguments)


def _doctor(arguments: argparse.Namespace) -> int:
    from .doctor import examine, repair, table

    workspace = (arguments.workspace or default_workspace()).expanduser().absolute()
    report = repair(workspace, lambda text: print(text, file=sys.stderr)) if arguments.repair else examine(workspace)
    print(json.dumps(report) if arguments.json else table(report))
    return OK if report["ok"] else FAILED


def _setup(arguments: argparse.Namespace) -> int:
    from .setup import setup

    workspace = (arguments.workspace or default_workspace()).expanduser().absolute()
    options = {k: getattr(arguments, k) for k in ("write", "dry_run", "project", "file", "through")}
    print(setup(arguments.clients, workspace, **options))
    return OK


def _intervals(text: str) -> int:
    if text == "all":
        return sys.maxsize
    if not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} must be a number from 1, or 'all'")
    return int(text)


def _verify(arguments: argparse.Namespace) -> int:
    from ..workflow.verify_folder import verify_folder

    options = {k: getattr(arguments, k) for k in ("replay", "seed", "intervals", "report")}
    return _judged(verify_folder(arguments.folder.expanduser().absolute(), **options))


def _report(arguments: argparse.Namespace) -> int:
    from ..workflow.matrix_report import report_world

    return _judged(report_world(arguments.folder.expanduser().absolute(), arguments.out))


def _bundle(arguments: argparse.Namespace) -> int:
    from ..workflow.bundles import bundle_world

    print(
        json.dumps(
            bundle_world(arguments.folder.expanduser().absolute(), out=arguments.out, with_caches=arguments.caches), indent=1
        )
    )
    return OK


def _volumes(arguments: argparse.Namespace) -> int:
    from ..workflow.volumes import export_volumes

    frames = None if arguments.frames is None else (arguments.frames[0], arguments.frames[1])
    print(
        json.dumps(
            export_volumes(arguments.folder.expanduser().absolute(), arguments.out, frames=frames, suffix=arguments.suffix),
            indent=1,
        )
    )
    return OK


def _recompute(arguments: argparse.Namespace) -> int:
    from ..workflow.verify_folder import recompute_folder

    return _judged(recompute_folder(arguments.folder.expanduser().absolute()))


def _judged(verdict: dict[str, Any]) -> int:
    print(json.dumps(verdict, indent=1))
    return OK if verdict["verdict"] == "accepted" else FAILED


def _warm(arguments: argparse.Namespace) -> int:
    from .doctor import warm

    steps = warm(lambda text: print(text, file=sys.stderr, flush=True))
    return OK if all(step["ok"] for step in steps) else FAILED
