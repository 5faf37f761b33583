"""Answers of the page's routes, without a browser."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest
from starlette.testclient import TestClient
from worldagent.server.guard import SECURITY_HEADERS
from worldagent.server.http import http_app
from worldagent.server.page.pictures import MAX_PIXELS, picture_list
from worldagent.server.tokens import TokenBook
from worldagent.tests.page.conftest import Made, row
from worldagent.tests.page.test_standing import FREEZE, accepted
from worldagent.worlds.ledger import Ledger


@pytest.fixture
def client(made: Made) -> Iterator[TestClient]:
    with TestClient(http_app(made.root, tokens=TokenBook(made.root)), base_url="http://127.0.0.1:8931") as found:
        yield found


def test_an_empty_workspace_has_no_worlds_and_stays_empty(tmp_path: Path) -> None:
    root = tmp_path / "not-there"
    with TestClient(http_app(root, tokens=TokenBook(root)), base_url="http://127.0.0.1:8931") as client:
        assert client.get("/api/worlds").json() == {"worlds": [], "total": 0, "offset": 0}
        assert client.get("/api/jobs").json()["jobs"] == []
        assert client.get("/api/jobs/active").json() == {"jobs": []}
        assert client.get("/").status_code == 200
    assert not root.exists()


def test_the_shell_is_static_and_is_not_sent_twice(client: TestClient) -> None:
    for path in ("/", "/static/style.css", "/static/app.js", "/static/icon.svg"):
        found = client.get(path)
        assert found.status_code == 200
        assert found.headers["content-security-policy"] == SECURITY_HEADERS["Content-Security-Policy"]
        assert client.get(path, headers={"If-None-Match": found.headers["etag"]}).status_code == 304
    assert client.get("/static/app.js").headers["content-type"].startswith("text/javascript")
    assert client.get("/static/..%2froutes.py").status_code == 404


def test_the_list_tells_stage_counts_and_verdict(made: Made, client: TestClient) -> None:
    accepted(made.world("w"))
    (found,) = client.get("/api/worlds").json()["worlds"]
    assert (found["id"], found["title"], found["revision"], found["reached"]) == ("w", "Three blocks", 1, "rendered")
    assert found["verdict"] == {
        "verdict": "accepted",
        "says": "accepted, prompt read by nobody",
        "revision": 1,
        "stale": False,
        "note": "",
    }
    made.edit("w", ("/simulation/solvers/rigid/settings/step", 0.00025))
    (found,) = client.get("/api/worlds").json()["worlds"]
    assert found["revision"] == 2
    assert found["verdict"]["stale"] is True
    assert found["reached"] == "audited"


def test_a_world_that_cannot_be_read_says_why_and_hides_no_other(made: Made, client: TestClient) -> None:
    _, torn, bare, odd = [made.world(name) for name in ("good", "torn", "bare", "odd")]
    torn.ledger_path.write_bytes(b"no database at all, but long enough to be looked at" * 9)
    bare.ledger_path.unlink()
    odd.spec_path.write_text("{")
    found = {w["id"]: w.get("problem", "") for w in client.get("/api/worlds").json()["worlds"]}
    assert found["good"] == ""
    assert "damaged" in found["torn"]
    assert "no ledger" in found["bare"]
    assert "damaged" in found["odd"]
    assert client.get("/api/worlds/torn").json()["problem"]
    assert not (made.root / "bare" / "ledger.sqlite").exists()


def test_stale_rows_are_told_apart_from_unverified_ones(made: Made, client: TestClient) -> None:
    folder = made.world("w")
    made.rows("w", row("a:pass"), row("b:fail", "fail"), row("c:open", "unverified"))
    Ledger(folder.ledger_path).mark_stale({"a:pass": "pose changed in revision 2"}, 2)
    found = client.get("/api/worlds/w/matrix", params={"q": ":"}).json()
    mine = {r["id"]: r for r in found["rows"] if r["check"] == "interpenetration"}
    assert {k: r["status"] for k, r in mine.items()} == {"a:pass": "stale", "b:fail": "fail", "c:open": "unverified"}
    assert (mine["a:pass"]["was"], mine["a:pass"]["why"]) == ("pass", "pose changed in revision 2")
    assert found["by_status"]["stale"] == 1
    assert client.get("/api/worlds/w").json()["matrix"]["stale"] == 1


def test_rows_that_change_within_one_tick_of_the_clock_are_read_anew(made: Made, client: TestClient) -> None:
    ledger = made.world("w").ledger_path
    made.rows("w", row("a:pass"))
    at = ledger.stat().st_mtime_ns
    assert client.get("/api/worlds/w/matrix", params={"q": "a:pass"}).json()["by_status"]["pass"] == 1
    made.rows("w", row("a:pass", "fail"))
    os.utime(ledger, ns=(at, at))
    assert client.get("/api/worlds/w/matrix", params={"q": "a:pass"}).json()["by_status"]["pass"] == 0


def test_rows_come_in_pages_filtered_and_the_failing_group_first(made: Made, client: TestClient) -> None:
    made.world("w")
    made.rows("w", *(row(f"s:{k:04d}") for k in range(250)), row("t:late", "fail", group="temporal", check="beat"))
    first = client.get("/api/worlds/w/matrix", params={"limit": 100}).json()
    assert first["rows"][0]["id"] == "t:late"
    assert len(first["rows"]) == 100
    assert first["total"] > 251
    spatial = client.get("/api/worlds/w/matrix", params={"group": "spatial", "q": "s:", "offset": 200}).json()
    assert [r["id"] for r in spatial["rows"]] == [f"s:{k:04d}" for k in range(200, 250)]
    assert (spatial["total"], spatial["by_status"]["pass"]) == (250, 250)
    assert client.get("/api/worlds/w/matrix", params={"q": "raise nothing"}).json()["total"] == 0


@pytest.mark.parametrize(
    ("path", "status"),
    [
        ("/api/worlds/none", 404),
        ("/api/worlds/..%2f..%2fetc", 404),
        ("/api/worlds/w/matrix?status=good", 400),
        ("/api/worlds/w/matrix?limit=0", 400),
        ("/api/worlds/w/matrix?limit=201", 400),
        ("/api/worlds/w/matrix?offset=-1", 400),
        ("/api/worlds/w/matrix?offset=%C2%B2", 400),
        (f"/api/worlds/w/matrix?q={'x' * 201}", 400),
        ("/api/worlds/w/row?id=none", 404),
        ("/api/worlds/w/pictures/none.png", 404),
        ("/api/worlds/w/pictures/..%2fworld.json", 404),
        ("/api/worlds/w/proof/..%2fworld.json", 404),
        ("/api/worlds/w/film", 404),
        ("/api/worlds/w/charts", 409),
        ("/api/nothing", 404),
    ],
)
def test_what_is_not_there_or_out_of_range_is_told(made: Made, client: TestClient, path: str, status: int) -> None:
    made.world("w")
    found = client.get(path)
    assert found.status_code == status
    assert "Traceback" not in found.text


def test_links_that_lead_out_of_the_workspace_are_not_followed(made: Made, client: TestClient, tmp_path_factory: object) -> None:
    folder = made.world("w")
    outside = made.root.parent / "outside"
    outside.mkdir()
    (outside / "secret.png").write_bytes(b"secret")
    (outside / "world.json").write_text("{}")
    folder.pictures.mkdir(exist_ok=True)
    (folder.pictures / "a.png").symlink_to(outside / "secret.png")
    final = folder.candidate(FREEZE) / "final"
    final.mkdir(parents=True)
    (final / "final.webm").symlink_to(outside / "secret.png")
    (made.root / "away").symlink_to(outside)
    for path in ("pictures/a.png", "pictures/a.png?thumbnail", "film"):
        found = client.get(f"/api/worlds/w/{path}")
        assert found.status_code in (404, 409)
        assert b"secret" not in found.content
    assert client.get("/api/worlds/away").status_code == 404
    assert [w["id"] for w in client.get("/api/worlds").json()["worlds"]] == ["w"]


def test_pictures_say_in_words_what_they_show(made: Made, client: TestClient) -> None:
    folder = made.world("w")
    Ledger(folder.ledger_path).put_freeze(FREEZE, 1, passed=True, detail={})
    made.edit("w", ("/look/samples", 4))
    folder.pictures.mkdir()
    names = ("preview_0002_00012_only.jpg", "ledger_0001_00000_auto.png", f"bake_{FREEZE[:8]}.jpg", "mine.png", "notes.txt")
    for name in names:
        (folder.pictures / name).write_bytes(b"x")
    found = {p["name"]: p for p in client.get("/api/worlds/w/pictures").json()["pictures"]}
    assert "notes.txt" not in found
    assert found["preview_0002_00012_only.jpg"]["alt"] == "Preview, frame 12, view only, revision 2"
    assert "older" not in found["preview_0002_00012_only.jpg"]
    assert found["ledger_0001_00000_auto.png"]["alt"] == "Plots of energy, momentum, gaps and contacts, revision 1"
    assert found["ledger_0001_00000_auto.png"]["older"] is True
    assert found[f"bake_{FREEZE[:8]}.jpg"]["alt"] == "Contact sheet of the bake abababab, revision 1"
    assert found["mine.png"]["alt"] == "Picture mine.png"


def test_thumbnails_are_small_and_bombs_stay_closed(made: Made, client: TestClient) -> None:
    folder = made.world("w")
    folder.pictures.mkdir()
    cv2.imwrite(str(folder.pictures / "large.png"), np.full((900, 1600, 3), 90, np.uint8))
    whole = (folder.pictures / "large.png").read_bytes()
    side = int(MAX_PIXELS**0.5) + 1
    (folder.pictures / "bomb.png").write_bytes(whole[:16] + side.to_bytes(4, "big") * 2 + whole[24:])
    (folder.pictures / "torn.jpg").write_bytes(b"\xff\xd8\xff\xe0")
    small = client.get("/api/worlds/w/pictures/large.png?thumbnail&v=1")
    decoded = cv2.imdecode(np.frombuffer(small.content, np.uint8), cv2.IMREAD_COLOR)
    assert small.headers["content-type"] == "image/jpeg"
    assert decoded.shape[:2] == (202, 360)
    assert client.get("/api/worlds/w/pictures/large.png").content == whole
    assert client.get("/api/worlds/w/pictures/bomb.png?thumbnail").status_code == 413
    assert client.get("/api/worlds/w/pictures/torn.jpg?thumbnail").status_code == 409


def test_the_film_comes_whole_or_by_ranges(made: Made, client: TestClient) -> None:
    accepted(made.world("w"))
    assert client.get("/api/worlds/w/film").content == b"film"
    part = client.get("/api/worlds/w/film", headers={"Range": "bytes=1-2"})
    assert (part.status_code, part.content, part.headers["content-range"]) == (206, b"il", "bytes 1-2/4")


def test_a_report_can_run_nothing(made: Made, client: TestClient) -> None:
    folder = made.world("w")
    folder.acceptance.mkdir()
    (folder.acceptance / "a.html").write_text("<script>alert(1)</script>")
    (folder.acceptance / "a.zip").write_bytes(b"zip")
    report = client.get("/api/worlds/w/proof/a.html")
    assert report.headers["content-security-policy"].startswith("sandbox; default-src 'none'")
    assert client.get("/api/worlds/w/proof/a.zip").headers["content-disposition"] == 'attachment; filename="w_a.zip"'


def test_cancel_needs_a_write_token_and_a_request_no_form_can_make(made: Made) -> None:
    tokens = TokenBook(made.root)
    reader, writer = tokens.add("watcher", "read"), tokens.add("owner", "write")
    job = made.job()
    with TestClient(http_app(made.root, tokens=tokens), base_url="http://127.0.0.1:8931") as client:
        path = f"/api/jobs/{job}/cancel"
        assert client.get("/").status_code == 200
        assert client.get("/api/worlds").status_code == 401
        read, write = ({"Authorization": f"Bearer {t}"} for t in (reader, writer))
        assert client.get("/api/session", headers=read).json()["scope"] == "read"
        assert client.get("/api/session", headers=write).json()["scope"] == "write"
        assert client.post(path, json={}, headers=read).status_code == 403
        assert client.post(path, data={"a": "b"}, headers=write).status_code == 415
        assert client.post("/api/jobs/job_000000000000/cancel", json={}, headers=write).status_code == 404
        assert made.jobs.get(job).ended is False
        assert client.post(path, json={}, headers=write).json()["state"] == "cancelled"


def test_large_worlds_stay_quick(made: Made, client: TestClient) -> None:
    folder = made.world("w")
    made.rows("w", *(row(f"s:{k:04d}") for k in range(2000)))
    folder.pictures.mkdir()
    for k in range(300):
        (folder.pictures / f"preview_0001_{k:05d}_only.jpg").write_bytes(b"x")
    client.get("/api/worlds/w/matrix")
    begun = time.process_time()
    for path in ("matrix?status=pass&offset=1900", "pictures?offset=288", "matrix?q=1234", ""):
        assert len(client.get(f"/api/worlds/w/{path}".rstrip("/")).content) < 200_000
    assert time.process_time() - begun < 2.0
    assert len(picture_list(folder)) == 300


def test_the_past_of_a_world_names_weakenings_and_patches(made: Made, client: TestClient) -> None:
    folder = made.world("w")
    ledger = Ledger(folder.ledger_path)
    spec, digest = ledger.revision_spec(1) or ("", "")
    ledger.add_revision(
        spec, digest, expected=1, patch=[{"op": "add", "path": "/title", "value": "x" * 9000}], weakenings=["wider"], reason="why"
    )
    found = client.get("/api/worlds/w/revisions").json()
    assert [r["n"] for r in found["revisions"]] == [2, 1]
    assert (found["revisions"][0]["weakenings"], found["revisions"][0]["reason"]) == (["wider"], "why")
    assert found["revisions"][0]["patch_left"] > 0
    assert client.get("/api/worlds/w").json()["weakenings"] == [{"revision": 2, "weakenings": ["wider"], "reason": "why"}]


def test_an_acceptance_tells_what_it_did_not_prove(made: Made, client: TestClient) -> None:
    folder = made.world("w")
    ledger = accepted(folder)
    record = {
        "verdict": "refused",
        "cache_digest": "cache-1",
        "spec_digest": (ledger.revision_spec(1) or ("", ""))[1],
        "rows": [r.model_dump(mode="json") for r in (row("a"), row("b", "unverified"), row("c", "not_applicable"))],
        "clauses": {"c1": {"text": "it falls", "unmet": "no beat maps it", "static_because": None}},
        "approximations": [{"what": "skin", "effect": "hovers"}],
    }
    ledger.add_acceptance(FREEZE, 1, "other", "refused", record)
    found = client.get("/api/worlds/w").json()["acceptance"]
    assert (found["verdict"], found["stale"]) == ("refused", False)
    assert [r["id"] for r in found["not_proven"]] == ["b"]
    assert found["clauses"][0]["unmet"] == "no beat maps it"
    assert found["approximations"] == record["approximations"]
    assert json.loads(json.dumps(found)) == found
