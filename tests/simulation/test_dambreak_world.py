"""The dam break that the benchmark bakes and judges as a world, small."""

from worldagent.bench.liquid_dambreak_world import dambreak_figures, dambreak_spec


def test_the_dam_break_as_a_world_gives_its_drift_and_what_judging_costs() -> None:
    found = dambreak_figures(dambreak_spec((0.4, 0.8, 0.46), (1.6, 1.0, 0.5), 0.1, 0.17))
    assert 0.0 < found["volume_drift"] < 0.5
    assert abs(found["volume_drift_end"]) <= found["volume_drift"]
    assert found["verify_over_bake"] > 0.0
    assert found["world"]["frames"] == 5
    assert not [r for r in found["world"]["open_rows"] if r.startswith(("category:liquid:mass", "numerical:", "delivery:"))]
