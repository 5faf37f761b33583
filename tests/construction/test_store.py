"""Built entities of a world: one recipe is built once, whoever has it."""

from __future__ import annotations

from worldagent.construction import build_world, store
from worldagent.construction.build import build_entity
from worldagent.testing.worlds.small_worlds import box, world
from worldagent.worlds.folder import WorldFolder


def test_entities_of_one_recipe_are_built_once_and_equal_what_each_would_be(tmp_path, monkeypatch):
    """Own choice: they differ in their name alone, on disk too."""
    spec = world({"left": box(1, 1, 1), "right": box(1, 1, 1, at=(3.0, 0.0, 0.0)), "other": box(1, 1, 2)})
    folder, asked = WorldFolder(tmp_path / "w"), []

    def counted(*arguments):
        asked.append(arguments[1])
        return build_entity(*arguments)

    monkeypatch.setattr(store, "build_entity", counted)
    built, fresh = build_world(folder, spec)
    assert fresh == ["left", "right", "other"]
    assert asked == ["left", "other"]
    for name in spec.entities:
        alone = build_entity(spec, name, folder.assets)
        assert built[name].entity == name
        assert built[name].digest() == alone.digest()
    again, fresh = build_world(folder, spec)
    assert fresh == []
    assert {n: b.digest() for n, b in again.items()} == {n: b.digest() for n, b in built.items()}
    one, two = (again[n].parts[0] for n in ("left", "right"))
    assert one.render.vertices is two.render.vertices  # read once, so that whoever looks at one knows the other
