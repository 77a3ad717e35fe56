"""Track logs with a known range: what tracking would hand over of satellites that move so."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sdr_spoof import _core
from sdr_spoof.nav.records import Anchor, Frame, Navigation
from sdr_spoof.nav.time import GnssTime
from sdr_spoof.records import ComboTrack, SignalTrack, State, TrackLog
from sdr_spoof.signals import signal_spec

LIGHT_M_S = 299_792_458.0
START = GnssTime(1_362_571_218, 0.25)
"""GPST at the first sample."""


@dataclass(frozen=True)
class Moving:
    """A satellite whose delay is a parabola of time."""

    prn: int = 27
    delay_s: float = 0.078
    doppler_hz: float = 5000.0
    """Of a signal at 1575.42 MHz."""
    doppler_rate_hz_s: float = -1.0
    cn0_dbhz: float = 45.0
    signals: tuple[str, ...] = ("B1I", "B1CP")
    noise: float = 0.0
    """Scales the noise of 45 dB-Hz."""
    inverted: tuple[str, ...] = ()
    """Signals whose phase is upside down."""
    group_delay_s: dict[str, float] = field(default_factory=dict)
    lost: tuple[tuple[float, float], ...] = ()
    """Stretches without rows, s."""
    begins_s: float = 0.0

    def delay(self, time_s):
        rate = -self.doppler_hz / 1575.42e6
        return self.delay_s + rate * time_s - 0.5 * self.doppler_rate_hz_s / 1575.42e6 * time_s**2


def counter_start(satellite: Moving, signal: str) -> GnssTime:
    """Transmit time of code phase 0: the whole code period before the first sample."""
    period = signal_spec(signal).period_s
    sent = START + -float(satellite.delay(0.0))
    return GnssTime(sent.seconds) + np.floor(sent.fraction / period) * period


def signal_track(satellite: Moving, signal: str, duration_s: float, seed: int = 1) -> SignalTrack:
    spec = signal_spec(signal)
    rng = np.random.default_rng([seed, satellite.prn, *signal.encode()])
    epoch_s = 0.01
    # Each signal's integrations lie elsewhere.
    shift = (satellite.prn * 0.37 + len(signal) * 0.21) % 1.0
    time = satellite.begins_s + (np.arange(round(duration_s / epoch_s)) + shift) * epoch_s
    time = time[time <= duration_s]
    for start, stop in satellite.lost:
        time = time[(time < start) | (time > stop)]
    own = satellite.group_delay_s.get(signal, 0.0)
    origin = counter_start(satellite, signal)
    white = satellite.noise * rng.standard_normal((2, time.size))
    error = 0.02 * white[0]
    code = ((START - origin) + (time - satellite.delay(time) - own)) * spec.chip_rate_hz + error
    phase = spec.carrier_hz * (satellite.delay(time) - satellite.delay_s) + 0.3
    phase = phase + 0.5 * (signal in satellite.inverted) + 0.0064 * white[1]
    rate = -np.gradient(spec.carrier_hz * satellite.delay(time), time) if time.size > 1 else time
    columns = np.zeros((time.size, 5), np.complex64)
    return SignalTrack(
        signal=signal,
        prn=satellite.prn,
        modulation="Bpsk",
        tap_offsets_s=np.zeros(5),
        prompt_tap=2,
        time_s=time,
        integration_s=np.full(time.size, epoch_s),
        state=np.full(time.size, State.SYNCED, np.uint8),
        carrier_phase_cycles=phase,
        doppler_hz=rate,
        code_phase_chips=code,
        phase_error_cycles=-0.0064 * white[1],
        code_error_chips=error,
        cn0_dbhz=np.full(time.size, satellite.cn0_dbhz),
        phase_lock=np.ones(time.size),
        noise_power=np.ones(time.size),
        taps=columns,
        data_prompt=columns[:, 0],
    )


def combo_track(satellite: Moving, pair: tuple[SignalTrack, SignalTrack]) -> ComboTrack:
    """Joint epochs at the upper track's times; both tracks without noise or at equal times."""
    lower, upper = pair
    time = upper.time_s
    spec_l, spec_u = signal_spec("B1I"), signal_spec("B1CP")
    phase_l = np.interp(time, lower.time_s, lower.carrier_phase_cycles)
    course = spec_l.carrier_hz * (satellite.delay(time) - satellite.delay_s)
    phase_l = course + np.interp(
        time,
        lower.time_s,
        lower.carrier_phase_cycles
        - spec_l.carrier_hz * (satellite.delay(lower.time_s) - satellite.delay_s),
    )
    # A beat in phase with the code: what the phases have in common at the satellite.
    beat = spec_u.carrier_hz - spec_l.carrier_hz
    phase_u = upper.carrier_phase_cycles + beat * satellite.delay_s
    sent_u = upper.code_phase_chips / spec_u.chip_rate_hz
    own = satellite.group_delay_s
    return ComboTrack(
        prn=satellite.prn,
        lower="B1I",
        upper="B1CP",
        time_s=time,
        integration_s=upper.integration_s,
        state=np.full(time.size, State.COMBO, np.uint8),
        phase_lower_cycles=phase_l,
        phase_upper_cycles=phase_u,
        main_phase_cycles=0.5 * (phase_u + phase_l),
        subcarrier_phase_cycles=0.5 * (phase_u - phase_l),
        subcarrier_range_m=LIGHT_M_S * (time - sent_u),
        code_delay_lower_s=time - sent_u,
        code_delay_upper_s=time - sent_u,
        cn0_lower_dbhz=np.full(time.size, satellite.cn0_dbhz),
        cn0_upper_dbhz=np.full(time.size, satellite.cn0_dbhz),
        code_difference_s=np.full(time.size, own.get("B1CP", 0.0) - own.get("B1I", 0.0)),
        subcarrier_lock=np.ones(time.size),
    )


def anchor(satellite: Moving, signal: str, *, from_s=0.0, until_s=1e9, late_s=0.0) -> Anchor:
    """What the message would tell: a whole code period some time after the counter's start."""
    spec = signal_spec(signal)
    periods = 30
    origin = counter_start(satellite, signal)
    transmitted = origin + (periods * spec.period_s + late_s)
    return Anchor(signal, satellite.prn, from_s, until_s, periods * spec.code_length, transmitted)


def frames(satellite: Moving, signal: str, duration_s: float, length_s: float = 6.0):
    if _core.periods_per_symbol(signal, satellite.prn) is None:
        return ()
    return tuple(
        Frame(
            "C",
            satellite.prn,
            signal,
            "D1",
            1,
            START + at,
            np.zeros(300, np.uint8),
            0.0,
            at,
            length_s,
            inverted=signal in satellite.inverted,
        )
        for at in np.arange(0.5, duration_s - length_s, length_s).tolist()
    )


def observed_log(*satellites: Moving, duration_s=20.0, combos=False, seed=1) -> TrackLog:
    tracks, pairs = [], []
    for satellite in satellites:
        mine = [signal_track(satellite, s, duration_s, seed) for s in satellite.signals]
        tracks += mine
        if combos:
            pairs.append(combo_track(satellite, (mine[0], mine[1])))
    return TrackLog("simulated", 25e6, duration_s, False, tuple(tracks), tuple(pairs))


def navigation(*satellites: Moving, duration_s=20.0, **more) -> Navigation:
    told = [(s, name) for s in satellites for name in s.signals]
    return Navigation(
        anchors=tuple(anchor(s, name) for s, name in told),
        frames=tuple(f for s, name in told for f in frames(s, name, duration_s)),
        **more,
    )
