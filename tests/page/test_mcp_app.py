"""The view as an MCP App: shown by a small host that follows the ext-apps specification, on a real server."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any

import pytest
from anyio.from_thread import BlockingPortal, start_blocking_portal
from mcp import Client
from mcp.server.apps import APP_MIME_TYPE, EXTENSION_ID
from mcp.types import TextResourceContents
from worldagent.server.app import create_server
from worldagent.server.page.mcp_app import STATIC, app_document
from worldagent.tests.page.browser import AXE, RULES, Tab, needs_axe
from worldagent.tests.page.conftest import Made
from worldagent.tests.page.rich import rich_world
from worldagent.workflow.links import WORLD_VIEW

POLICY = (
    "default-src 'none'; script-src 'self' 'unsafe-inline'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; "
    "media-src 'self' data:; connect-src 'none'"
)
"""Policy that a host applies to a view that declares no domains (ext-apps, 2026-01-26)."""
HOST = """
async ({html, capabilities, theme, input}) => {
  const frame = document.createElement("iframe");
  frame.title = "view";
  frame.setAttribute("sandbox", "allow-scripts");
  frame.style.cssText = "width:100%;border:0;height:900px";
  window.log = [];
  window.addEventListener("message", async (event) => {
    if (event.source !== frame.contentWindow) return;
    const message = event.data;
    window.log.push(message);
    const answer = (more) => event.source.postMessage({jsonrpc: "2.0", id: message.id, ...more}, "*");
    const tell = (method, params) => event.source.postMessage({jsonrpc: "2.0", method, params}, "*");
    window.tell = tell;
    if (message.method === "ui/initialize") {
      answer({result: {protocolVersion: "2026-01-26", hostInfo: {name: "host", version: "1"},
                       hostCapabilities: capabilities, hostContext: {theme}}});
    } else if (message.method === "ui/notifications/initialized") {
      tell("ui/notifications/tool-input", {arguments: input});
    } else if (message.method === "ui/download-file") {
      answer({result: {}});
    } else if (message.id !== undefined) {
      answer(JSON.parse(await window.forward(JSON.stringify(message))));
    }
  });
  document.body.append(frame);
  frame.srcdoc = html;
}
"""
ALL = {"serverTools": {}, "serverResources": {}, "downloadFile": {}}


class Host:
    """A tab that shows the view and passes its requests on to an MCP client."""

    def __init__(self, browser: Any, made: Made, portal: BlockingPortal, client: Client) -> None:
        self.tab = Tab(browser, "about:blank")
        self.page = self.tab.page
        self._portal, self._client = portal, client
        self.page.expose_function("forward", self._forward)

    def _forward(self, text: str) -> str:
        message = json.loads(text)
        try:
            if message["method"] == "resources/read":
                found: Any = self._portal.call(self._client.read_resource, message["params"]["uri"])
            else:
                found = self._portal.call(self._client.call_tool, message["params"]["name"], message["params"]["arguments"])
        except Exception as error:
            return json.dumps({"error": {"code": -32000, "message": str(error)}})
        return json.dumps({"result": json.loads(found.model_dump_json(by_alias=True, exclude_none=True))})

    def show(self, capabilities: dict[str, Any] | None = None, *, world: str = "w", theme: str = "light") -> Any:
        """The frame with the view."""
        html = app_document().replace("<head>", f'<head><meta http-equiv="Content-Security-Policy" content="{POLICY}">')
        given = {"html": html, "capabilities": ALL if capabilities is None else capabilities, "theme": theme}
        self.page.evaluate(HOST, given | {"input": {"world": world}})
        return self.page.frame_locator("iframe")

    def messages(self) -> list[dict[str, Any]]:
        """All that the view has sent."""
        return list(self.page.evaluate("window.log"))


@pytest.fixture
def host(browser: Any, made: Made) -> Iterator[Host]:
    with ExitStack() as stack:
        portal = stack.enter_context(start_blocking_portal("asyncio"))
        client = stack.enter_context(portal.wrap_async_context_manager(Client(create_server(made.root))))
        found = Host(browser, made, portal, client)
        yield found
        found.tab.close()
        assert found.tab.troubles == []


def test_the_document_stands_alone_and_its_modules_share_no_name() -> None:
    text = app_document()
    assert not re.search(r"^(import|export) ", text, re.MULTILINE)
    assert text.count("</script") == text.count("<script") == 1
    assert not re.search(r"(src|href)=\"(?!#)", text)
    script = text[text.index("<script") : text.index("</script")]
    names = re.findall(r"^(?:async )?(?:function\*?|const|let|class) ([A-Za-z_]\w*)", script, re.MULTILINE)
    assert len(names) == len(set(names)) > 50
    assert "class HttpSource" not in script
    assert len(text) < 120_000
    assert {p.name for p in STATIC.glob("*.js")} >= {"app.js", "bridge.js", "embedded.js", "http.js", "page.js"}


@pytest.mark.anyio
@pytest.mark.parametrize("era", ["auto", "legacy"])
@pytest.mark.parametrize("anyio_backend", ["asyncio"])
async def test_hosts_find_the_view_at_the_tools_it_helps(made: Made, era: str, anyio_backend: str) -> None:
    async with Client(create_server(made.root), mode=era) as client:
        tools = (await client.list_tools()).tools
        seen = {t.name for t in tools if ((t.meta or {}).get("ui") or {}).get("resourceUri") == WORLD_VIEW}
        assert seen == {"bake_sim", "run_checks"}
        (found,) = (await client.read_resource(WORLD_VIEW)).contents
        assert isinstance(found, TextResourceContents)
        assert found.mime_type == APP_MIME_TYPE
        assert found.text == app_document()
        # Only the newer era has a place for the extensions of a server; hosts of the older one go by the tools' `_meta`.
        assert (EXTENSION_ID in (client.server_capabilities.extensions or {})) == (era == "auto")


@pytest.mark.anyio
@pytest.mark.parametrize("anyio_backend", ["asyncio"])
async def test_data_of_the_view_is_what_the_page_shows(made: Made, anyio_backend: str) -> None:
    rich_world(made)
    async with Client(create_server(made.root)) as client:

        async def page(query: str) -> Any:
            (content,) = (await client.read_resource(f"worldagent://worlds/w/page{query}")).contents
            assert isinstance(content, TextResourceContents)
            return json.loads(content.text)

        assert (await page(""))["verdict"]["stale"] is True
        found = await page("?view=matrix&status=fail&q=gap%3A&limit=1")
        assert ([r["id"] for r in found["rows"]], found["total"]) == (["gap:ball:shelf"], 1)
        assert (await page("?view=row&row=gap%3Ab1%3Ab2"))["row"]["shown"] == "stale"
        assert (await page("?view=charts"))["frame_count"] == 12
        assert (await page("?view=jobs"))["jobs"] == []
        for bad in ("?view=secrets", "?view=matrix&status=good", "?offset=-1"):
            with pytest.raises(Exception, match=r"must be one of|whole numbers"):
                await page(bad)


@pytest.mark.parametrize("theme", ["light", "dark"])
@needs_axe
def test_the_view_speaks_to_its_host_and_shows_the_world(made: Made, host: Host, theme: str) -> None:
    rich_world(made)
    frame = host.show(theme=theme)
    frame.get_by_role("heading", level=1, name="Three blocks").wait_for()
    frame.get_by_role("region", name="Acceptance").get_by_text("stale – accepted, prompt read by nobody at revision 1").wait_for()
    inner = host.page.frames[1]
    assert inner.evaluate("document.documentElement.dataset.theme") == theme
    for view, heading in (("Requirements", "Requirements"), ("Pictures", "3 pictures"), ("Ledger", "Ledger")):
        frame.get_by_role("link", name=view).first.click()
        frame.get_by_role("heading", name=heading, exact=True).wait_for()
    frame.get_by_role("link", name="Pictures").first.click()
    frame.locator("img[src^='data:image/jpeg;base64,']").first.wait_for()
    sent = host.messages()
    first = sent[0]
    assert (first["method"], first["params"]["protocolVersion"]) == ("ui/initialize", "2026-01-26")
    assert set(first["params"]) == {"appInfo", "appCapabilities", "protocolVersion"}
    initialized = next(k for k, m in enumerate(sent) if m["method"] == "ui/notifications/initialized")
    assert all(m["method"] in ("ui/initialize", "ui/notifications/size-changed") for m in sent[:initialized])
    sizes = [m["params"]["height"] for m in sent if m["method"] == "ui/notifications/size-changed"]
    assert sizes[-1] > 300
    assert {m["method"] for m in sent} <= {
        "ui/initialize", "ui/notifications/initialized", "ui/notifications/size-changed", "resources/read",
    }  # fmt: skip
    inner.evaluate(AXE.read_text())
    violations = inner.evaluate("rules => axe.run(document, {runOnly: rules}).then(r => r.violations.map(v => v.id))", RULES)
    assert violations == []


def test_a_job_is_followed_and_cancelled_through_the_host(made: Made, host: Host) -> None:
    made.world("w")
    made.advance(2)
    job = made.job("w")
    frame = host.show()
    frame.get_by_role("progressbar", name="bake of w").wait_for()
    made.advance(6)
    frame.get_by_text("60 %").wait_for()
    frame.get_by_role("button", name="Cancel bake of w").click()
    frame.get_by_role("button", name="Cancel it").click()
    frame.get_by_text("cancelled").first.wait_for()
    assert made.jobs.get(job).state == "cancelled"
    calls = [m["params"] for m in host.messages() if m["method"] == "tools/call"]
    assert calls == [{"name": "job", "arguments": {"action": "cancel", "job_id": job}}]


def test_the_report_is_handed_to_the_host(made: Made, host: Host) -> None:
    rich_world(made)
    frame = host.show()
    frame.get_by_role("link", name="Matrix report").click()
    host.tab.wait("window.log.some(m => m.method === 'ui/download-file')")
    (message,) = (m for m in host.messages() if m["method"] == "ui/download-file")
    (link,) = message["params"]["contents"]
    assert (link["type"], link["uri"]) == ("resource_link", "worldagent://worlds/w/acceptance/abababababababab.html")


def test_a_host_that_lets_nothing_be_read_is_told_so(made: Made, host: Host) -> None:
    made.world("w")
    frame = host.show({})
    frame.get_by_text("This host lets its views read no resources").wait_for()


def test_a_tool_result_names_the_world_and_brings_news(made: Made, host: Host) -> None:
    made.world("w")
    rich_world(made, "x", title="Another")
    frame = host.show()
    frame.get_by_role("heading", level=1, name="Three blocks").wait_for()
    host.page.evaluate("tell('ui/notifications/tool-result', {content: [{type: 'text', text: '{\"world\": \"x\"}'}]})")
    frame.get_by_role("heading", level=1, name="Another").wait_for()
    host.page.evaluate("tell('ui/notifications/host-context-changed', {theme: 'dark'})")
    host.tab.wait("true")
    while host.page.frames[1].evaluate("document.documentElement.dataset.theme") != "dark":
        host.page.wait_for_timeout(20)
