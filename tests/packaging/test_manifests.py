"""Manifests for registries, hosts and plugin catalogs agree with the package."""

from __future__ import annotations

import importlib.util
import json
import re
import shlex
import sys
import tomllib
import zipfile
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
import worldagent
from worldagent.server.cli import _parser
from worldagent.server.default_workspace import ENV_WORKSPACE
from worldagent.tools import TOOLS

ROOT = Path(__file__).resolve().parents[2]
BUNDLES = ("packaging/mcpb", "packaging/mcpb-installed")
MANIFESTS = (
    "server.json",
    ".claude-plugin/plugin.json",
    *(f"{bundle}/manifest.json" for bundle in BUNDLES),
)


def read(path: str) -> dict[str, Any]:
    return json.loads((ROOT / path).read_text())


def project() -> dict[str, Any]:
    return tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


@pytest.fixture(scope="module")
def packer() -> ModuleType:
    found = importlib.util.spec_from_file_location("worldagent_build_mcpb", ROOT / "packaging" / "build_mcpb.py")
    assert found is not None
    assert found.loader is not None
    module = importlib.util.module_from_spec(found)
    sys.modules[found.name] = module
    found.loader.exec_module(module)
    return module


@pytest.mark.parametrize("path", MANIFESTS)
def test_every_manifest_names_the_package_and_its_version(path: str) -> None:
    manifest = read(path)
    assert manifest["version"] == worldagent.__version__
    assert manifest["name"].rpartition("/")[2].startswith("worldagent")
    assert manifest.get("license", project()["license"]) == project()["license"]


@pytest.mark.parametrize("path", [p for p in MANIFESTS if "mcpb" in p])
def test_bundles_name_the_tools_of_the_server(path: str) -> None:
    assert read(path)["tools"] == [{"name": tool.name, "description": tool.title} for tool in TOOLS]


@pytest.mark.parametrize("path", [p for p in MANIFESTS if "mcpb" in p])
def test_bundles_ask_for_what_their_command_uses_and_need_the_python_of_the_package(path: str) -> None:
    manifest = read(path)
    used = set(re.findall(r"\$\{user_config\.(\w+)\}", json.dumps(manifest["server"])))
    assert used == set(manifest["user_config"])
    assert manifest["compatibility"]["platforms"] == ["darwin", "linux"]
    python = manifest["compatibility"].get("runtimes", {}).get("python", project()["requires-python"])
    assert python == project()["requires-python"]
    assert (ROOT / path).with_name(manifest["server"]["entry_point"]).is_file()


@pytest.mark.parametrize(
    "arguments",
    [
        read("packaging/mcpb-installed/manifest.json")["server"]["mcp_config"]["args"],
        read(".claude-plugin/plugin.json")["mcpServers"]["worldagent"]["args"],
        ["serve"],
    ],
)
def test_the_command_understands_what_manifests_start(arguments: list[str]) -> None:
    assert _parser().parse_args(arguments).command.__name__ == "_serve"


def test_the_bundle_of_a_wheel_pins_that_wheel_and_every_library(packer: ModuleType, tmp_path: Path) -> None:
    wheel = tmp_path / f"worldagent-{worldagent.__version__}-py3-none-any.whl"
    with zipfile.ZipFile(wheel, "w") as archive:
        archive.writestr("x", "")
    staged = packer.stage(wheel, tmp_path / "out")
    assert set(staged) == {"worldagent", "worldagent-installed"}
    environment = tomllib.loads((staged["worldagent"] / "pyproject.toml").read_text())
    assert environment["project"]["dependencies"] == [f"worldagent=={worldagent.__version__}"]
    assert environment["project"]["requires-python"] == project()["requires-python"]
    assert (staged["worldagent"] / environment["tool"]["uv"]["sources"]["worldagent"]["path"]).is_file()
    pinned = {line.partition("==")[0].lower().replace("_", "-") for line in environment["tool"]["uv"]["constraint-dependencies"]}
    needed = {re.split(r"[<>=!~\[ ]", line)[0].lower() for line in project()["dependencies"]}
    assert needed <= pinned
    compile((staged["worldagent"] / "server.py").read_text(), "server.py", "exec")


def test_the_registry_entry_keeps_the_limits_of_its_schema() -> None:
    entry = read("server.json")
    assert re.fullmatch(r"[a-zA-Z0-9.-]+/[a-zA-Z0-9._-]+", entry["name"])
    assert 1 <= len(entry["description"]) <= 100
    assert set(entry) <= {
        "$schema",
        "name",
        "title",
        "description",
        "version",
        "repository",
        "websiteUrl",
        "icons",
        "packages",
        "remotes",
    }
    (package,) = entry["packages"]
    assert package["identifier"] == project()["name"]
    assert package["version"] == worldagent.__version__
    assert package["transport"] == {"type": "stdio"}
    assert package["registryType"] == "pypi"
    (variable,) = package["environmentVariables"]
    assert variable["name"] == ENV_WORKSPACE
    words = [w for a in package["packageArguments"] for w in ([a["name"], "DIR"] if a["type"] == "named" else [a["value"]])]
    assert _parser().parse_args(words).workspace == Path("DIR")


def test_the_plugin_holds_the_skills_and_the_marketplace_lists_the_plugin() -> None:
    plugin, market = read(".claude-plugin/plugin.json"), read(".claude-plugin/marketplace.json")
    skills = {path.parent.name for path in (ROOT / plugin["skills"]).glob("*/SKILL.md")}
    assert skills >= {"repair", "rigid-bodies", "world-building"}
    assert plugin["mcpServers"]["worldagent"]["command"] in project()["scripts"]
    (listed,) = market["plugins"]
    assert {k: listed[k] for k in ("name", "version", "description", "license")} == {
        k: plugin[k] for k in ("name", "version", "description", "license")
    }
    assert (ROOT / listed["source"]).resolve() == ROOT


def test_the_container_runs_as_nobody_special_asks_its_own_health_and_starts_a_command_that_exists() -> None:
    lines = (ROOT / "Dockerfile").read_text().splitlines()
    (command,) = [json.loads(line[4:]) for line in lines if line.startswith("CMD ")]
    arguments = _parser().parse_args(command[1:])
    assert (command[0], arguments.host, arguments.transport) == ("worldagent", "0.0.0.0", "http")
    assert {"localhost", "127.0.0.1"} <= set(arguments.allow_host)
    users = [shlex.split(line)[1] for line in lines if line.startswith("USER ")]
    assert users
    assert "root" not in users
    assert any("/healthz" in line for line in lines)
    assert f"EXPOSE {arguments.port}" in lines
