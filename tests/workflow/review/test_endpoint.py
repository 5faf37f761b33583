"""The model that the owner names: settings, and one request to a fake of it on this machine."""

from __future__ import annotations

import logging
import threading
from pathlib import Path

import pytest
from worldagent.tests.workflow.review.fake_reader import Answer, anthropic, openai, serving
from worldagent.workflow.review import endpoint as module
from worldagent.workflow.review.endpoint import ENV_API, ENV_KEY_FILE, ENV_MODEL, ENV_URL, Endpoint, ReaderError, configured, say
from worldagent.workflow.review.pictures import ReviewPicture
from worldagent.worlds.errors import InputError

PICTURE = ReviewPicture(3, b"\x89PNG bytes", "png")
SECRET = "sk-test-0123456789abcdef"


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "PAUSES_S", (0.0, 0.0))


def named(url: str, *, api: str = "openai", key_file: Path | None = None) -> Endpoint:
    return Endpoint(url, "tiny", api, key_file)


def always(reply: tuple[int, dict[str, str], bytes]) -> Answer:
    return lambda call, n: reply


def key_file(folder: Path, mode: int = 0o600) -> Path:
    path = folder / "key"
    path.write_text(SECRET + "\n")
    path.chmod(mode)
    return path


# ---------------------------------------------------------------- settings


def test_no_reader_is_named_unless_the_environment_names_one() -> None:
    assert configured({}) is None
    assert configured({ENV_API: "anthropic", ENV_KEY_FILE: "/key"}) is None


def test_a_named_reader_has_address_model_form_and_file_of_its_key() -> None:
    found = configured({ENV_URL: "https://api.example/v1/", ENV_MODEL: "m", ENV_API: "anthropic", ENV_KEY_FILE: "/run/key"})
    assert found == Endpoint("https://api.example/v1", "m", "anthropic", Path("/run/key"))
    assert found.name == "m at api.example"


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({ENV_URL: "https://api.example/v1"}, "needs both"),
        ({ENV_MODEL: "m"}, "needs both"),
        ({ENV_URL: "http://api.example/v1", ENV_MODEL: "m"}, "without TLS"),
        ({ENV_URL: "file:///etc/passwd", ENV_MODEL: "m"}, "must be http"),
        ({ENV_URL: "https://me:word@api.example/v1", ENV_MODEL: "m"}, "without user"),
        ({ENV_URL: "https://api.example/v1", ENV_MODEL: "m", ENV_API: "other"}, "one of openai, anthropic"),
    ],
)
def test_settings_that_are_incomplete_or_unsafe_are_refused(settings: dict[str, str], words: str) -> None:
    with pytest.raises(InputError, match=words):
        configured(settings)


def test_a_key_that_others_can_read_or_that_is_none_is_refused_without_being_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="chmod 600") as told:
        say(named("http://127.0.0.1:9/v1", key_file=key_file(tmp_path, 0o644)), "x", [])
    assert SECRET not in str(told.value)
    with pytest.raises(InputError, match="cannot be read"):
        say(named("http://127.0.0.1:9/v1", key_file=tmp_path / "absent"), "x", [])
    (tmp_path / "key").chmod(0o600)
    (tmp_path / "key").write_text("two words")
    with pytest.raises(InputError, match="holds no key"):
        say(named("http://127.0.0.1:9/v1", key_file=tmp_path / "key"), "x", [])


# ---------------------------------------------------------------- requests


def test_an_openai_request_carries_text_pictures_and_the_bearer_key(tmp_path: Path) -> None:
    with serving(lambda call, n: openai("hello")) as fake:
        assert say(named(fake.url, key_file=key_file(tmp_path)), "what is it?", [PICTURE]) == "hello"
    (call,) = fake.calls
    assert call.path == "/v1/chat/completions"
    assert call.headers["authorization"] == f"Bearer {SECRET}"
    assert call.body["model"] == "tiny"
    shown, text = call.body["messages"][0]["content"]
    assert shown["image_url"]["url"].startswith("data:image/png;base64,")
    assert text == {"type": "text", "text": "what is it?"}


def test_an_anthropic_request_carries_them_in_its_own_form(tmp_path: Path) -> None:
    with serving(lambda call, n: anthropic({"prompt": 1})) as fake:
        told = say(named(fake.url, api="anthropic", key_file=key_file(tmp_path)), "what is it?", [PICTURE])
    assert told == '{"prompt": 1}'
    (call,) = fake.calls
    assert call.path == "/v1/messages"
    assert call.headers["x-api-key"] == SECRET
    assert call.headers["anthropic-version"] == module.VERSION
    assert call.body["messages"][0]["content"][0]["source"]["media_type"] == "image/png"


def test_a_local_model_needs_no_key() -> None:
    with serving(lambda call, n: openai("hello")) as fake:
        say(named(fake.url), "x", [])
    assert "authorization" not in fake.calls[0].headers


def test_a_busy_reader_is_asked_three_times_and_no_more() -> None:
    with serving(lambda call, n: (503, {}, b"busy")) as fake, pytest.raises(ReaderError, match="HTTP 503; try again later"):
        say(named(fake.url), "x", [])
    assert len(fake.calls) == 3
    with serving(lambda call, n: openai("at last") if n == 3 else (429, {}, b"")) as fake:
        assert say(named(fake.url), "x", []) == "at last"


def test_a_reader_that_says_nothing_in_time_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "TIMEOUT_S", 0.2)
    gone = threading.Event()

    def silent(call: object, n: int) -> tuple[int, dict[str, str], bytes]:
        gone.wait(2.0)
        return openai("late")

    with serving(silent) as fake:
        with pytest.raises(ReaderError, match=r"did not answer: TimeoutError"):
            say(named(fake.url), "x", [])
        gone.set()


def test_nobody_at_the_address_is_told_as_no_answer() -> None:
    with pytest.raises(ReaderError, match="did not answer: ConnectionRefusedError"):
        say(named("http://127.0.0.1:9/v1"), "x", [])


def test_a_redirect_is_not_followed_and_the_key_goes_nowhere_else(tmp_path: Path) -> None:
    with serving(lambda call, n: openai("stolen")) as elsewhere:
        moved = {"Location": elsewhere.url + "/chat/completions"}
        with (
            serving(lambda call, n: (307, moved, b"")) as fake,
            pytest.raises(ReaderError, match="HTTP 307: it points elsewhere"),
        ):
            say(named(fake.url, key_file=key_file(tmp_path)), "x", [PICTURE])
    assert elsewhere.calls == []


def test_a_model_on_this_machine_is_reached_without_the_proxy_of_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    with serving(always(openai("proxied"))) as proxy, serving(always(openai("direct"))) as fake:
        for name in ("http_proxy", "HTTP_PROXY", "all_proxy"):
            monkeypatch.setenv(name, proxy.url)
        for name in ("no_proxy", "NO_PROXY"):
            monkeypatch.delenv(name, raising=False)
        assert say(named(fake.url), "x", [PICTURE]) == "direct"
    assert proxy.calls == []


@pytest.mark.parametrize(
    ("reply", "api", "words"),
    [
        ((200, {}, b"<html>"), "openai", "no JSON"),
        ((200, {}, b"[]"), "openai", "no text in the form of the openai API"),
        ((200, {}, b'{"choices": []}'), "openai", "no text in the form"),
        (openai(None), "openai", "no text in the form"),
        (openai(None, refusal="I will not"), "openai", "refused to answer"),
        (anthropic("", stop="refusal"), "anthropic", "refused to answer"),
        (openai("hello"), "anthropic", "no text in the form of the anthropic API"),
        ((401, {}, SECRET.encode()), "openai", "HTTP 401"),
    ],
)
def test_what_is_no_answer_is_told_as_such(reply: tuple[int, dict[str, str], bytes], api: str, words: str) -> None:
    with serving(lambda call, n: reply) as fake, pytest.raises(ReaderError, match=words):
        say(named(fake.url, api=api), "x", [])
    assert len(fake.calls) == 1


def test_a_huge_answer_is_cut_off(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_BYTES", 1000)
    with serving(lambda call, n: openai("x" * 5_000_000)) as fake, pytest.raises(ReaderError, match="more than 1000 bytes"):
        say(named(fake.url), "x", [])


def test_the_key_is_in_no_error_and_no_log(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, capfd: pytest.CaptureFixture[str]
) -> None:
    caplog.set_level(logging.DEBUG)
    told = []
    for reply in ((401, {}, f"wrong key {SECRET}".encode()), (200, {}, SECRET.encode()), openai(None, refusal=SECRET)):
        with serving(always(reply)) as fake, pytest.raises(ReaderError) as error:
            say(named(fake.url, key_file=key_file(tmp_path)), "x", [PICTURE])
        told.append(f"{error.value} {error.value.__cause__} {vars(error.value)}")
    out, err = capfd.readouterr()
    assert len(told) == 3
    assert SECRET not in " ".join([*told, caplog.text, out, err])
