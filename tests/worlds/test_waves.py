"""Declared seas: spectra, equal seeds, what the audit asks of waves (R57, R58)."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from worldagent.physics.waves import wavelength
from worldagent.testing.worlds.small_liquids import sea_spec
from worldagent.worlds.audits.audit import audit
from worldagent.worlds.errors import SpecError
from worldagent.worlds.limits import estimate_counts
from worldagent.worlds.patch import apply_patch, parse_spec
from worldagent.worlds.provenance import recipes
from worldagent.worlds.spec import WavesDriver, WorldSpec
from worldagent.worlds.waves import developed, sea_of

G = 9.81
SEA = "/simulation/drivers/sea"


def driver(**changes: Any) -> WavesDriver:
    return WavesDriver(**{"entity": "water", "height": 2.0, "period": 8.0, "level": 0.0, "depth": 30.0, "zone": 200.0, **changes})


def world() -> WorldSpec:
    return parse_spec({**sea_spec(), "prompt": "A crate bobs in the waves of the sea."})


def problems(spec: WorldSpec, row: str = "liquids") -> str:
    found = next(r for r in audit(spec).rows if r.id == f"audit:{row}")
    return " ".join(found.evidence.get("problems", []))


@pytest.mark.parametrize("spectrum", ["jonswap", "pierson_moskowitz"])
@pytest.mark.parametrize("spreading", [0.0, 25.0])
def test_components_of_a_spectrum_hold_its_variance(spectrum: str, spreading: float) -> None:
    sea = sea_of(driver(spectrum=spectrum, spreading=spreading, components=64), G)
    assert float((0.5 * sea.amplitude**2).sum()) == pytest.approx(2.0**2 / 16, rel=1e-12)
    np.testing.assert_allclose(np.linalg.norm(sea.direction, axis=1), 1.0, rtol=1e-12)


def test_a_long_series_of_elevations_has_the_declared_significant_height_and_peak() -> None:
    sea = sea_of(driver(spectrum="jonswap", components=128, start=-60.0, rise=10.0), G)
    time = np.arange(0.0, 3600.0, 0.5)
    series = sea.elevation(np.zeros((len(time), 2)), time)
    assert 4.0 * float(series.std()) == pytest.approx(2.0, rel=0.03)
    power = np.abs(np.fft.rfft(series)) ** 2
    smooth = np.convolve(power, np.ones(41) / 41, "same")
    frequency = np.fft.rfftfreq(len(series), 0.5)
    assert 1.0 / frequency[int(np.argmax(smooth))] == pytest.approx(8.0, rel=0.05)


def test_regular_waves_are_as_high_as_declared_after_their_rise() -> None:
    sea = sea_of(driver(rise=10.0), G)
    time = np.linspace(20.0, 28.0, 400)
    series = sea.elevation(np.zeros((400, 2)), time)
    assert float(np.ptp(series)) == pytest.approx(2.0, rel=1e-3)
    assert float(np.abs(sea.elevation(np.zeros((1, 2)), 0.0))[0]) == 0.0
    later = sea.elevation(np.zeros((400, 2)), time, quadrature=True)
    np.testing.assert_allclose(series**2 + later**2, 1.0, rtol=1e-9)


def test_a_wave_travels_where_it_is_declared_to() -> None:
    sea = sea_of(driver(direction=90.0, start=-50.0), G)
    length = wavelength(8.0, 30.0, G)
    ahead = np.array([[0.0, 0.25 * length]])
    assert sea.elevation(ahead, 2.0)[0] == pytest.approx(sea.elevation(np.zeros((1, 2)), 0.0)[0], abs=1e-9)


def test_equal_seeds_give_equal_seas_and_others_do_not() -> None:
    one, same, other = (sea_of(driver(spectrum="jonswap", seed=s, spreading=20.0), G) for s in (4, 4, 5))
    for name in ("amplitude", "omega", "phase", "direction"):
        assert getattr(one, name).tobytes() == getattr(same, name).tobytes()
    assert one.phase.tobytes() != other.phase.tobytes()


def test_waves_that_an_engine_cannot_resolve_are_left_out_and_their_energy_kept() -> None:
    sea = sea_of(driver(spectrum="jonswap"), G, spacing=5.0)
    assert 2 * math.pi / float(sea.number.max()) >= 6.0 * 5.0 - 1e-9
    assert sea.variance == pytest.approx(0.25, rel=1e-12)


def test_a_sea_passes_the_audit() -> None:
    spec = world()
    assert problems(spec) == ""
    assert [r.id for r in audit(spec).rows if r.status != "pass"] == []
    assert estimate_counts(spec)["particle_steps"] > 0


LENGTH = wavelength(0.8, 0.3, 9.81)
BROKEN: dict[str, tuple[list[tuple[str, Any]], str]] = {
    "too steep": ([(f"{SEA}/height", 0.14)], r"steeper \(0\.1\d+\) than 0\.1\d+, at which they break; use a height of at most 0\.1\d+ m"),
    "too short": ([(f"{SEA}/period", 0.4)], "less than 10 spacings of 0.05 m; use a longer period or a resolution of at most"),
    "too low": ([(f"{SEA}/height", 0.02)], "0.02 m high, less than a spacing of 0.05 m"),
    "a short zone": ([(f"{SEA}/zone", 0.6)], "0.6 m wide, less than one wavelength of 0.9\\d+ m"),
    "no room": ([(f"{SEA}/zone", 1.6)], "2 zones of 1.6 m and half a wavelength between them need"),
    "an open side": (
        [("/simulation/solvers/water/settings/domain/sides", ["closed", "open", "closed", "closed", "closed", "open"])],
        r"side \+x of the domain is open"),
    "waves that go away": ([(f"{SEA}/direction", 180)], "into the domain from none of -x"),
    "waves along the side": ([(f"{SEA}/direction", 88)], "into the domain from none of -x"),
    "another level": ([(f"{SEA}/level", 0.5)], "declared at 0.5 m, the liquid's top at frame 0 is 0.3 m"),
    "a low ceiling": (
        [("/simulation/solvers/water/settings/domain/size/2", 0.42), ("/simulation/solvers/water/settings/domain/center/2", 0.11)],
        "the domain ends at 0.32 m"),
    "a bed below": ([(f"{SEA}/depth", 2)], "the bed of waves 'sea' is at -1.7 m"),
    "a start before all": ([(f"{SEA}/start", -9)], "before the preroll"),
    "no time": ([("/simulation/frames", 30), ("/story/beats/bob/frames", [0, 20]), ("/shots/wide/frames", [0, 29])],
                "the last frame is at 1.21 s; use more frames"),
    "a second sea": ([("/simulation/drivers/other", {**sea_spec()["simulation"]["drivers"]["sea"]})], "has waves 'sea' already"),
    "sideways gravity": ([("/simulation/gravity", [1, 0, -9])], "need gravity along -z"),
    "waves of wood": ([(f"{SEA}/entity", "crate")], "'sea' acts on 'crate', which is no liquid"),
}  # fmt: skip


@pytest.mark.parametrize("name", BROKEN)
def test_the_audit_names_what_is_wrong_with_waves(name: str) -> None:
    import re

    operations, wanted = BROKEN[name]
    spec = apply_patch(
        world(), [{"op": "add" if p.endswith("other") else "replace", "path": p, "value": v} for p, v in operations]
    )
    assert re.search(wanted, problems(spec)), problems(spec)


def test_a_side_makes_waves_or_takes_them_in() -> None:
    with pytest.raises(SpecError, match="a side stands once"):
        apply_patch(world(), [{"op": "replace", "path": f"{SEA}/absorb", "value": ["-x"]}])


def test_waves_belong_to_what_decides_the_motion() -> None:
    spec = world()
    higher = apply_patch(spec, [{"op": "replace", "path": f"{SEA}/height", "value": 0.05}])
    before, after = recipes(spec), recipes(higher)
    assert before != after
    assert {k for k in before if before[k] != after.get(k)} >= {k for k in before if k.startswith("cache")}


def test_full_waves_come_out_of_their_zone_with_the_speed_of_groups() -> None:
    deep = driver(depth=400.0, period=8.0, zone=100.0, start=3.0, rise=5.0)
    assert developed(deep, G) == pytest.approx(3.0 + 5.0 + 100.0 / (0.5 * G * 8.0 / (2 * math.pi)), rel=1e-6)
