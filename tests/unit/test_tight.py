"""The tightly coupled filter on short simulated voyages."""

from dataclasses import replace

import numpy as np
import pytest
from pydantic import ValidationError
from tight_voyage import CONFIG, distance, made, measured, start

from sdr_spoof.aiding.simulated import clock_drag, range_pull, velocity_drag
from sdr_spoof.aiding.tight import STATES, TESTS, TightConfig, as_published, run, run_many
from sdr_spoof.aiding.tight.solution import FLOOR
from sdr_spoof.errors import AidingError


@pytest.fixture(scope="module")
def voyage():
    return made()


def test_clean_run_is_trusted_and_accurate(voyage):
    found = run(voyage[0], measured(voyage), start(voyage), CONFIG)
    assert found.valid.all()
    assert STATES[found.state[-1]] == "trusted"
    assert not found.events
    assert np.isnan(found.first_alarm_s)
    assert distance(found, voyage).max() < 5.0
    sigma = found.horizontal_sigma_m[60:]
    assert np.all(distance(found, voyage)[60:] < 4 * sigma)
    assert found.deviates.shape == (200, len(TESTS))
    assert set(np.unique(found.usage)) <= {1, 2}
    assert found.words() == [FLOOR]


def test_drag_of_all_is_seen_and_told(voyage):
    attack = velocity_drag((0.6, 0.8, 0.0), 100.0, 160.0)
    data = measured(voyage, attack)
    found = run(voyage[0], data, start(voyage), CONFIG)
    assert 100.0 <= found.first_alarm_s <= 103.0
    assert distance(found, voyage).max() < 12.0
    captured = run(voyage[0], data, start(voyage), as_published(17, exclusion="off"))
    assert distance(captured, voyage)[159] > 55.0
    said = " ".join(found.words())
    assert "beyond the threshold" in said
    assert "without GNSS" in said
    assert distance(found, voyage)[-1] < 5.0


def test_three_are_left_out_by_name(voyage):
    three = ("C02", "C05", "C08")
    attack = range_pull((0.0, 1.0, 0.0), 100.0, 160.0, satellites=three)
    found = run(voyage[0], measured(voyage, attack), start(voyage), CONFIG)
    assert any(set(e.excluded) == set(three) and e.state == "partial" for e in found.events)
    assert "left out: C02, C05, C08" in " ".join(found.words())
    assert distance(found, voyage).max() < 6.0


def test_a_clock_alone_moves_no_position(voyage):
    found = run(voyage[0], measured(voyage, clock_drag(4.0, 100.0)), start(voyage), CONFIG)
    assert found.first_alarm_s == 100.0
    assert STATES[found.state[-1]] == "trusted"
    assert distance(found, voyage).max() < 6.0


def test_power_of_three_alarms(voyage):
    data = measured(voyage)
    cn0 = data.cn0_dbhz.copy()
    cn0[120:, :4] += 10.0
    found = run(voyage[0], replace(data, cn0_dbhz=cn0), start(voyage), CONFIG)
    assert found.events[0].test == "power"


def test_a_jump_of_everything_is_called_undecidable(voyage):
    data = measured(voyage, velocity_drag((6.0, 8.0, 0.0), 60.0, 100.0))
    config = CONFIG.model_copy(update={"exclusion": "robust", "settle_s": 99.0})
    found = run(voyage[0], data, start(voyage), config)
    first = next(e for e in found.events if e.test)
    assert first.apart_m > 15.0
    assert "No rule tells them apart" in first.words()


def test_published_statistics_and_their_log(voyage):
    attack = range_pull((60.0, 0.0, 0.0), 100.0, satellites=("C03",))
    config = as_published(11, exclusion="printed")
    found = run(voyage[0], measured(voyage, attack), start(voyage), config)
    flagged = found.flagged(config.divisors, config.statistic_form)
    assert not flagged[60:100].any()
    assert flagged[105:110, 2].all()
    assert found.threat[105] == 1
    assert 0 < found.severity[105] < 1
    assert (found.usage[105:110, 2] == 3).all()


def test_carrier_phase_tells_velocity_better(voyage):
    data = measured(voyage)
    sigma = [
        np.sqrt(run(voyage[0], data, start(voyage), c).covariance[-1, 1, 0, 0])
        for c in (CONFIG, CONFIG.model_copy(update={"carrier_noise_m": 0.002}))
    ]
    assert sigma[1] < 0.7 * sigma[0]


def test_missing_values_are_left_out(voyage):
    log, data = voyage[0], measured(voyage)
    ranges, rates = data.range_m.copy(), data.rate_m_s.copy()
    ranges[80:90] = np.nan
    rates[80:90] = np.nan
    ranges[90:120, 2:] = np.nan
    velocity = log.velocity_m_s.copy()
    velocity[15000:15020] = np.nan
    found = run(
        replace(log, velocity_m_s=velocity),
        replace(data, range_m=ranges, rate_m_s=rates),
        start(voyage),
        CONFIG,
    )
    assert np.isfinite(found.position_m).all()
    assert (found.usage[85] == 0).all()
    assert distance(found, voyage).max() < 10.0


def test_epochs_without_increments_are_not_valid(voyage):
    log = voyage[0]
    part = replace(
        log,
        time_s=log.time_s[:10000],
        rotation_rad=log.rotation_rad[:10000],
        velocity_m_s=log.velocity_m_s[:10000],
    )
    found = run(part, measured(voyage), start(voyage), CONFIG)
    assert found.valid[:101].all()
    assert not found.valid[101:].any()
    assert np.isnan(found.position_m[101:]).all()


def test_runs_do_not_depend_on_threads_and_details(voyage):
    data = measured(voyage)
    stack = tuple(np.stack([m, m]) for m in (data.range_m, data.rate_m_s, data.change_m))
    starts = [start(voyage)] * 2
    one = run_many(voyage[0], data, stack, starts, CONFIG)
    two = run_many(voyage[0], data, stack, starts, CONFIG, detailed=False, threads=2)
    assert np.array_equal(one[1].position_m, two[0].position_m)
    assert two[0].usage.shape == (200, 0)


def test_what_does_not_fit_is_refused(voyage):
    log, data = voyage[0], measured(voyage)
    with pytest.raises(AidingError, match="do not overlap"):
        run(log, replace(data, time_s=data.time_s + 1e4), start(voyage))
    with pytest.raises(AidingError, match="lies outside"):
        run(log, data, replace(start(voyage), time_s=-50.0))
    times = log.time_s.copy()
    times[5000] = times[4000]
    with pytest.raises(AidingError, match="do not ascend"):
        run(replace(log, time_s=times), data, start(voyage))
    with pytest.raises(ValidationError):
        TightConfig(states=12)


def test_eleven_states_keep_biases_at_zero(voyage):
    found = run(voyage[0], measured(voyage), start(voyage), as_published(11))
    assert not found.gyro_bias_rad_s.any()
    assert not found.accelerometer_bias_m_s2.any()
    assert run(voyage[0], measured(voyage), start(voyage), CONFIG).gyro_bias_rad_s.any()
