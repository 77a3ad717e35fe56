"""Simulated correlator outputs: rays on the autocorrelation of the replica, and its noise.

Noise of the taps is correlated as the replica's own autocorrelation says, E|n|^2 = 2 in each.
"""

from __future__ import annotations

import numpy as np

from sdr_spoof import _core
from sdr_spoof.records import SignalTrack, State, TrackLog

SAMPLE_RATE_HZ = 120e6
HALF_CHIPS = {"Bpsk": 0.25, "Boc11": 0.1, "Qmboc": 0.06}
OUTER_CHIPS = {"Bpsk": 0.4, "Boc11": 0.5, "Qmboc": 0.5}
NOISE_CHIPS = -6.5


def offsets_chips(modulation):
    """Delays of very early, early, prompt, late, very late and noise tap, in chips."""
    near, far = HALF_CHIPS[modulation], OUTER_CHIPS[modulation]
    return np.array([-far, -near, 0.0, near, far, NOISE_CHIPS])


def correlation(modulation, delay_chips):
    """Autocorrelation of the replica at any array of delays in chips."""
    flat = np.abs(np.atleast_1d(delay_chips)).ravel()
    lags = np.arange(13) / 12.0  # corners of every shape
    values = [_core.early_late(modulation, lag / 2.0)[0] for lag in lags]
    return np.interp(flat, lags, values).reshape(np.shape(delay_chips))


def simulated_taps(modulation, amplitude, rng, rays=()):
    """Taps of shape (N, 6) for prompt amplitudes of shape (N,).

    ``rays`` are (amplitude factor, delay in chips, phase in cycles), each a number or shape (N,).
    """
    offsets = offsets_chips(modulation)
    taps = amplitude[:, None] * correlation(modulation, offsets)[None, :].astype(complex)
    for factor, delay, phase in rays:
        column = [np.broadcast_to(v, amplitude.shape)[:, None] for v in (factor, delay, phase)]
        shape = correlation(modulation, offsets[None, :] - column[1])
        taps += amplitude[:, None] * column[0] * shape * np.exp(2j * np.pi * column[2])
    root = np.linalg.cholesky(
        correlation(modulation, offsets[:, None] - offsets[None, :]) + 1e-9 * np.eye(6)
    )
    white = rng.standard_normal((2, amplitude.size, 6))
    return taps + (white[0] + 1j * white[1]) @ root.T


def quality_track(
    *,
    signal="B1I",
    prn=23,
    modulation="Bpsk",
    cn0_dbhz=45.0,
    duration_s=60.0,
    epoch_s=0.01,
    gain_db=0.0,
    rays=(),
    seed=1,
):
    """A track of one signal; ``cn0_dbhz``, ``gain_db`` and the rays may vary over the epochs."""
    rng = np.random.default_rng([seed, prn, len(signal)])
    time = (np.arange(round(duration_s / epoch_s)) + 0.5) * epoch_s
    cn0 = np.broadcast_to(np.asarray(cn0_dbhz, float), time.shape)
    gain = np.broadcast_to(10 ** (np.asarray(gain_db, float) / 20), time.shape)
    taps = simulated_taps(modulation, np.sqrt(2 * 10 ** (cn0 / 10) * epoch_s), rng, rays)
    taps *= gain[:, None] * np.where(rng.random(time.size) < 0.5, -1, 1)[:, None]  # data
    zeros = np.zeros(time.size)
    chip_rate = _core.signal_spec(signal)["chip_rate_hz"]
    return SignalTrack(
        signal=signal,
        prn=prn,
        modulation=modulation,
        tap_offsets_s=offsets_chips(modulation) / chip_rate,
        prompt_tap=2,
        time_s=time,
        integration_s=np.full(time.size, epoch_s),
        state=np.full(time.size, State.SYNCED, np.uint8),
        carrier_phase_cycles=zeros,
        doppler_hz=zeros,
        code_phase_chips=chip_rate * time + 0.003 * rng.standard_normal(time.size),
        phase_error_cycles=zeros,
        code_error_chips=zeros,
        cn0_dbhz=cn0.copy(),
        phase_lock=zeros + 0.98,
        noise_power=2.0 * gain**2 / (SAMPLE_RATE_HZ * epoch_s),
        taps=taps.astype(np.complex64),
        data_prompt=zeros.astype(np.complex64),
    )


def quality_log(*tracks):
    """A log of single-signal tracks."""
    duration_s = max((float(t.time_s[-1]) for t in tracks if t.epochs), default=0.0)
    return TrackLog("simulated", SAMPLE_RATE_HZ, duration_s, False, tracks, ())
