"""Simulated track logs: what tracking would hand over, without the signal processing.

Noise is white from epoch to epoch, sigma = sqrt(1 / (2 C/N0 T)) rad per band. The attack is the
sum of two phasors, authentic 1 and spoofed eta(t) exp(j phi(t)), whose argument the loop follows.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from simulated_taps import SAMPLE_RATE_HZ, offsets_chips, simulated_taps

from sdr_spoof.records import ComboTrack, SignalTrack, State, TrackLog

F_UPPER_HZ = 1575.42e6
F_LOWER_HZ = 1561.098e6
LIGHT_M_S = 299_792_458.0
RATIO = F_UPPER_HZ / F_LOWER_HZ


@dataclass(frozen=True)
class Attack:
    """A spoofer in one band: amplitude ramps to eta, then the carrier is dragged."""

    band: str = "B1CP"
    start_s: float = 10.0
    ramp_s: float = 0.0
    amplitude: float = 1.5
    drag_hz: float = 1.0
    phase_cycles: float = 0.0

    def apply(self, time_s):
        """(phase shift in cycles, amplitude factor) at each time."""
        since = time_s - self.start_s
        on = np.clip(since / self.ramp_s, 0, 1) if self.ramp_s else (since >= 0).astype(float)
        eta = self.amplitude * on
        turn = self.phase_cycles + self.drag_hz * np.maximum(since - self.ramp_s, 0)
        total = 1 + eta * np.exp(2j * np.pi * turn)
        return np.unwrap(np.angle(total)) / (2 * np.pi), np.abs(total)


@dataclass(frozen=True)
class Satellite:
    prn: int = 23
    cn0_dbhz: float = 45.0
    doppler_hz: float = 2500.0
    doppler_rate_hz_s: float = -1.0
    attack: Attack | None = None
    slips: dict[float, tuple[str, float]] = field(default_factory=dict)
    """time in s -> (band, cycles)"""
    lost: tuple[float, float] | None = None


def sigma_cycles(cn0_dbhz, epoch_s):
    return np.sqrt(1 / (2 * 10 ** (cn0_dbhz / 10) * epoch_s)) / (2 * np.pi)


def phases(satellite: Satellite, time_s, epoch_s, rng):
    """(lower, upper) phase in cycles and (lower, upper) C/N0 in dB-Hz."""
    out = []
    for band, scale in (("B1I", 1.0), ("B1CP", RATIO)):
        # Positive Doppler = approaching = phase falls.
        course = satellite.doppler_hz * time_s + 0.5 * satellite.doppler_rate_hz_s * time_s**2
        phase = -scale * course + 0.3 * scale
        amplitude = np.ones_like(time_s)
        if satellite.attack and satellite.attack.band == band:
            shift, amplitude = satellite.attack.apply(time_s)
            phase = phase + shift
        for at, (slipped, cycles) in satellite.slips.items():
            if slipped == band:
                phase = phase + cycles * (time_s >= at)
        noise = sigma_cycles(satellite.cn0_dbhz, epoch_s) / np.maximum(amplitude, 0.05)
        cn0 = satellite.cn0_dbhz + 20 * np.log10(np.maximum(amplitude, 0.05))
        out.append((phase + noise * rng.standard_normal(time_s.size), cn0))
    return out


def simulate_combo(satellite: Satellite, *, duration_s=20.0, epoch_s=0.01, seed=1) -> ComboTrack:
    rng = np.random.default_rng([seed, satellite.prn])
    time = (np.arange(round(duration_s / epoch_s)) + 0.5) * epoch_s
    (lower, cn0_lower), (upper, cn0_upper) = phases(satellite, time, epoch_s, rng)
    state = np.full(time.size, State.COMBO, dtype=np.uint8)
    if satellite.lost:
        gone = (time >= satellite.lost[0]) & (time < satellite.lost[1])
        state[gone] = State.LOST
        again = time >= satellite.lost[1]
        lower, upper = lower + 17.37 * again, upper - 4.81 * again
    return ComboTrack(
        prn=satellite.prn,
        lower="B1I",
        upper="B1CP",
        time_s=time,
        integration_s=np.full(time.size, epoch_s),
        state=state,
        phase_lower_cycles=lower,
        phase_upper_cycles=upper,
        main_phase_cycles=0.5 * (upper + lower),
        subcarrier_phase_cycles=0.5 * (upper - lower),
        subcarrier_range_m=LIGHT_M_S / (F_UPPER_HZ - F_LOWER_HZ) * (upper - lower),
        code_delay_lower_s=lower / F_LOWER_HZ,
        code_delay_upper_s=upper / F_UPPER_HZ,
        cn0_lower_dbhz=cn0_lower,
        cn0_upper_dbhz=cn0_upper,
        code_difference_s=1e-9 * rng.standard_normal(time.size),
        subcarrier_lock=np.ones(time.size),
    )


def sideband(combo: ComboTrack, signal: str, *, seed=2) -> SignalTrack:
    """A single-band track that goes with a simulated combo track."""
    rng = np.random.default_rng([seed, combo.prn])
    upper = signal == combo.upper
    phase = combo.phase_upper_cycles if upper else combo.phase_lower_cycles
    time = combo.time_s
    chip_rate, carrier = (1.023e6, F_UPPER_HZ) if upper else (2.046e6, F_LOWER_HZ)
    modulation = "Boc11" if upper else "Bpsk"
    cn0 = combo.cn0_upper_dbhz if upper else combo.cn0_lower_dbhz
    amplitude = np.sqrt(2 * 10 ** (cn0 / 10) * combo.integration_s)
    taps = simulated_taps(modulation, amplitude, rng)
    code = chip_rate * (time - phase / carrier) + 0.003 * rng.standard_normal(time.size)
    return SignalTrack(
        signal=signal,
        prn=combo.prn,
        modulation=modulation,
        tap_offsets_s=offsets_chips(modulation) / chip_rate,
        prompt_tap=2,
        time_s=time,
        integration_s=combo.integration_s,
        state=combo.state,
        carrier_phase_cycles=phase,
        doppler_hz=-np.gradient(phase, time),
        code_phase_chips=code,
        phase_error_cycles=np.zeros(time.size),
        code_error_chips=np.zeros(time.size),
        cn0_dbhz=cn0,
        phase_lock=np.full(time.size, 0.98),
        noise_power=2.0 / (SAMPLE_RATE_HZ * combo.integration_s),
        taps=taps.astype(np.complex64),
        data_prompt=np.zeros(time.size, np.complex64),
    )


def simulate_log(*satellites: Satellite, single=(), duration_s=20.0, seed=1) -> TrackLog:
    """A log with both bands of every satellite, and one band of those in ``single``."""
    combos = tuple(simulate_combo(s, duration_s=duration_s, seed=seed) for s in satellites)
    signals = [sideband(c, name) for c in combos for name in (c.lower, c.upper)]
    for satellite, name in single:
        combo = simulate_combo(satellite, duration_s=duration_s, seed=seed)
        signals.append(sideband(combo, name))
    return TrackLog("simulated", SAMPLE_RATE_HZ, duration_s, False, tuple(signals), combos)
