"""A real browser on a real server: Debian's chromium through playwright, the server in a thread of this process."""

from __future__ import annotations

import shutil
import socket
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from worldagent.server.connections import uvicorn_server
from worldagent.server.http import http_app
from worldagent.server.tokens import TokenBook

CHROMIUM = next((found for name in ("chromium", "chromium-browser", "google-chrome") if (found := shutil.which(name))), None)
AXE = Path(sys.prefix) / "axe" / "node_modules" / "axe-core" / "axe.min.js"
PATIENCE_MS = 30_000
RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]


class Served:
    """The HTTP server of a workspace; it can be stopped and started again on the same port."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.port = 0

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    def start(self) -> None:
        listener = socket.socket()
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(("127.0.0.1", self.port))
        listener.listen(64)
        self.port = listener.getsockname()[1]
        ready = threading.Event()
        app = http_app(self.root, tokens=TokenBook(self.root))
        self._server = uvicorn_server(app, ready.set)
        self._listener = listener
        self._thread = threading.Thread(target=self._server.run, kwargs={"sockets": [listener]}, daemon=True)
        self._thread.start()
        assert ready.wait(30)

    def stop(self) -> None:
        self._server.should_exit = True
        self._thread.join(20)
        assert not self._thread.is_alive()
        self._listener.close()


@contextmanager
def chromium() -> Iterator[Any]:
    """A browser; the test is skipped where there is none."""
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed: pip install '.[dev]'")
    if CHROMIUM is None:
        pytest.skip("no chromium on the path: make setup installs it as root")
    # Its loop must end with the module: other tests need one of their own.
    with playwright.sync_playwright() as running:
        browser = running.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--disable-dev-shm-usage"])
        try:
            yield browser
        finally:
            browser.close()


class Tab:
    """A page of its own context that remembers what went wrong in it."""

    def __init__(self, browser: Any, url: str, *, scheme: str = "light", size: tuple[int, int] = (1280, 800)) -> None:
        self.url = url
        self.context = browser.new_context(
            color_scheme=scheme, viewport={"width": size[0], "height": size[1]}, reduced_motion="reduce"
        )
        self.context.set_default_timeout(PATIENCE_MS)
        self.page = self.context.new_page()
        self.troubles: list[str] = []
        self.page.on("console", lambda m: self.troubles.append(m.text) if m.type in ("error", "warning") else None)
        self.page.on("pageerror", lambda error: self.troubles.append(str(error)))
        self.page.on("dialog", lambda dialog: self.troubles.append(f"dialog {dialog.message}"))

    def go(self, view: str = "", heading: str | None = None) -> Any:
        """Open a view and wait until it is there and live."""
        self.page.goto(f"{self.url}/{view}")
        if heading is not None:
            self.page.get_by_role("heading", level=1, name=heading).wait_for()
        self.page.locator(".connection.is-live").wait_for()
        return self.page

    def wait(self, condition: str) -> None:
        """Until an expression of the page is true; the page's policy forbids playwright's own way, which is `eval`."""
        deadline = time.monotonic() + PATIENCE_MS / 1000
        while not self.page.evaluate(condition):
            assert time.monotonic() < deadline, f"never true: {condition}"
            self.page.wait_for_timeout(30)

    def audit(self) -> list[str]:
        """Violations that axe-core finds on the page."""
        self.page.evaluate(AXE.read_text())
        found = self.page.evaluate("rules => axe.run(document, {runOnly: rules}).then(r => r.violations)", RULES)
        return [f"{v['id']}: {n['html'][:160]} {n['failureSummary']}" for v in found for n in v["nodes"]]

    def close(self) -> None:
        self.context.close()


needs_axe = pytest.mark.skipif(not AXE.is_file(), reason="axe-core is not installed: make setup fetches it with npm")
