from collections.abc import Sequence
from typing import Any, Self, final

import numpy as np
from numpy.typing import NDArray

# signals
def signal_ids() -> list[str]: ...
def signal_spec(id: str) -> dict[str, Any]: ...
def signal_pairs() -> list[tuple[str, str]]: ...
def signal_components(name: str) -> list[str]: ...
def code_chips(id: str, prn: int) -> NDArray[np.int8]: ...
def secondary_chips(id: str, prn: int) -> NDArray[np.int8]: ...
def periods_per_symbol(id: str, prn: int) -> int | None: ...
def sample_formats() -> list[str]: ...
def sample_format(name: str) -> tuple[int, bool]: ...
def unpack(
    name: str, raw: NDArray[np.uint8], scale: float = ..., conjugate: bool = ...
) -> NDArray[np.int16]: ...

# synthesis
@final
class Spline:
    def __new__(
        cls,
        time_s: NDArray[np.float64],
        value: NDArray[np.float64],
        rate: NDArray[np.float64],
    ) -> Self: ...
    def value(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]: ...
    def rate(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]: ...

@final
class Emitter:
    def __new__(
        cls,
        signal: str,
        prn: int,
        cn0_dbhz: float,
        *,
        range_m: Spline | None = ...,
        delay_s: float = ...,
        phase_cycles: float = ...,
        doppler_hz: float = ...,
        doppler_rate_hz_s: float = ...,
        data_seed: int | None = ...,
        symbols: NDArray[np.int8] | None = ...,
        first_symbol: int = ...,
        data_delay_s: float = ...,
        data_error_rate: float = ...,
        power_db: Sequence[tuple[float, float]] = ...,
        code_offset_m: Sequence[tuple[float, float]] = ...,
        carrier_offset_hz: Sequence[tuple[float, float]] = ...,
        start_s: float = ...,
        end_s: float = ...,
    ) -> Self: ...
    @property
    def signal(self) -> str: ...
    @property
    def prn(self) -> int: ...
    @property
    def data_delay_s(self) -> float: ...
    def code_phase_chips(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]: ...
    def received_phase_cycles(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]: ...
    def doppler_hz(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]: ...
    def cn0_dbhz(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]: ...
    def data_symbols(self, index: NDArray[np.int64]) -> NDArray[np.int8]: ...

@final
class GainControl:
    def __new__(
        cls,
        sample_format: str,
        sample_rate_hz: float,
        lo_hz: float,
        emitters: Sequence[Emitter],
        *,
        duration_s: float,
        time_constant_s: float,
        update_s: float,
        range_db: tuple[float, float],
        noise_db: Sequence[tuple[float, float]] = ...,
        bandwidth_hz: float | None = ...,
        centre_hz: float | None = ...,
        filter_taps: int = ...,
    ) -> Self: ...
    def gain_db(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]: ...
    def input_db(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]: ...

@final
class Synthesizer:
    def __new__(
        cls,
        sample_format: str,
        sample_rate_hz: float,
        lo_hz: float,
        emitters: Sequence[Emitter],
        *,
        noise_rms_lsb: float,
        noise: bool = ...,
        seed: int = ...,
        bandwidth_hz: float | None = ...,
        centre_hz: float | None = ...,
        filter_taps: int = ...,
        noise_db: Sequence[tuple[float, float]] = ...,
        gain: GainControl | None = ...,
        threads: int = ...,
    ) -> Self: ...
    def generate(self, start_sample: int, count: int) -> NDArray[np.uint8]: ...

# acquisition
@final
class SearchPeak:
    @property
    def prn(self) -> int: ...
    @property
    def statistic(self) -> float: ...
    @property
    def cells(self) -> int: ...
    @property
    def doppler_hz(self) -> float: ...
    @property
    def code_delay_s(self) -> float: ...
    @property
    def cn0_dbhz(self) -> float: ...

@final
class Search:
    def __new__(
        cls,
        signal: str,
        raw: NDArray[np.uint8],
        sample_format: str,
        *,
        sample_rate_hz: float,
        if_hz: float,
        blocks: int,
        bins: tuple[int, int],
        threads: int,
        first: int = ...,
        scale: float = ...,
        conjugate: bool = ...,
    ) -> Self: ...
    def cancel(self, known: list[tuple[int, float, float]]) -> None: ...
    def run(self, jobs: list[tuple[int, int, int]]) -> list[SearchPeak]: ...

def search_rate_hz(signal: str) -> float: ...
def search_peak_shape(signal: str, delays: list[float]) -> tuple[float, list[float]]: ...

# tracking
@final
class Tracker:
    def __new__(
        cls,
        sample_format: str,
        sample_rate_hz: float,
        lo_hz: float,
        config_values: dict[str, Any],
        targets: list[tuple[str, int, int, float, float]],
        *,
        conjugate: bool = False,
        float_scale: float = 1.0,
        start_sample: int = 0,
        threads: int = 1,
    ) -> Tracker: ...
    def feed(self, raw: NDArray[np.uint8]) -> None: ...
    def position(self) -> int: ...
    def lost(self) -> list[tuple[str, int, float]]: ...
    def restart(self, seed: tuple[str, int, int, float, float]) -> None: ...
    def isolate(self, system: str, prn: int, signal: str) -> None: ...
    def rejoin(self, system: str, prn: int) -> None: ...
    def take_signals(self) -> list[dict[str, Any]]: ...
    def take_combos(self) -> list[dict[str, Any]]: ...
    def take_breaks(self) -> list[tuple[str, int, float, float]]: ...

@final
class Simulator:
    def __new__(
        cls,
        sample_rate_hz: float,
        lo_hz: float,
        config_values: dict[str, Any],
        emitters: Sequence[Emitter],
        targets: Sequence[tuple[str, int]],
        *,
        noise_power: float,
        seed: int = 0,
        complex_samples: bool = True,
        bandwidth_hz: float | None = None,
        centre_hz: float | None = None,
        filter_taps: int = 63,
        reacquire: bool = True,
        threads: int = 1,
        gaps: Sequence[tuple[float, float]] = ...,
        noise_db: Sequence[tuple[float, float]] = ...,
        gain: GainControl | None = ...,
    ) -> Simulator: ...
    def advance(self, end: int) -> None: ...
    def position(self) -> int: ...
    def isolate(self, system: str, prn: int, signal: str) -> None: ...
    def rejoin(self, system: str, prn: int) -> None: ...
    def take_signals(self) -> list[dict[str, Any]]: ...
    def take_combos(self) -> list[dict[str, Any]]: ...
    def take_breaks(self) -> list[tuple[str, int, float, float]]: ...

def early_late(modulation: str, half_chips: float) -> tuple[float, float]: ...

# speed
@final
class EngineBench:
    def __new__(
        cls,
        sample_format: str,
        sample_rate_hz: float,
        lo_hz: float,
        threads: Sequence[Sequence[tuple[str, int, str, bool, float, float]]],
        taps: Sequence[int],
        *,
        bands: Sequence[float] = ...,
    ) -> Self: ...
    def feed(self, raw: NDArray[np.uint8], times: int) -> int: ...

def simd_level() -> str: ...
def simd_levels() -> list[str]: ...

# error control of navigation messages
@final
class Cnav1Frame:
    @property
    def prn(self) -> int: ...
    @property
    def soh(self) -> int: ...
    @property
    def first_errors(self) -> int: ...
    @property
    def ok2(self) -> bool: ...
    @property
    def ok3(self) -> bool: ...
    @property
    def corrected2(self) -> int: ...
    @property
    def corrected3(self) -> int: ...
    @property
    def iterations2(self) -> int: ...
    @property
    def iterations3(self) -> int: ...
    @property
    def amplitude(self) -> float: ...
    @property
    def noise(self) -> float: ...
    @property
    def bits2(self) -> NDArray[np.uint8]: ...
    @property
    def bits3(self) -> NDArray[np.uint8]: ...

def crc24q(bits: NDArray[np.uint8]) -> int: ...
def d1_encode(bits: NDArray[np.uint8]) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]: ...
def d1_decode(
    values: NDArray[np.float32], noise: float
) -> tuple[NDArray[np.uint8], NDArray[np.int64], NDArray[np.float64]]: ...
def d1_correct(
    symbols: NDArray[np.uint8],
) -> tuple[NDArray[np.uint8], NDArray[np.int64], NDArray[np.float64]]: ...
def d1_wrong_blocks(symbols: NDArray[np.uint8]) -> NDArray[np.bool_]: ...
def d1_layout() -> tuple[NDArray[np.int64], NDArray[np.int64]]: ...
def word_doubt(
    costs: NDArray[np.float64], magnitudes: NDArray[np.float64], more: int, noise: float
) -> NDArray[np.float64]: ...
def ldpc64_encode(name: str, information: NDArray[np.uint8]) -> NDArray[np.uint8]: ...
def ldpc64_decode(
    name: str, likelihoods: NDArray[np.float32], iterations: int = ...
) -> tuple[NDArray[np.uint8], int, int, bool]: ...
def symbol_level(values: NDArray[np.float32]) -> tuple[float, float]: ...
def cnav1_encode(
    prn: int, soh: int, data2: NDArray[np.uint8], data3: NDArray[np.uint8]
) -> NDArray[np.int8]: ...
def cnav1_first(prn: int, soh: int) -> NDArray[np.int8]: ...
def cnav1_find(
    values: NDArray[np.float32], prn: int, limit: int = ...
) -> list[tuple[int, bool, int, float]]: ...
def cnav1_decode(
    values: NDArray[np.float32],
    iterations: int = ...,
    amplitude: float | None = ...,
    noise: float | None = ...,
) -> list[Cnav1Frame]: ...

# navigation
def satellite_states(
    table: NDArray[np.float64], row: NDArray[np.int64], time_s: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]: ...
def geodetic(ecef_m: NDArray[np.float64], ellipsoid_name: str) -> NDArray[np.float64]: ...
def ecef(place: NDArray[np.float64], ellipsoid_name: str) -> NDArray[np.float64]: ...
def azimuth_elevation(
    receiver_m: NDArray[np.float64], target_m: NDArray[np.float64]
) -> NDArray[np.float64]: ...
def ionosphere_m(
    model: str,
    parameters: Sequence[float],
    place: NDArray[np.float64],
    direction: NDArray[np.float64],
    gpst_s: NDArray[np.float64],
    carrier_hz: float,
) -> NDArray[np.float64]: ...
def troposphere_m(
    place: NDArray[np.float64], direction: NDArray[np.float64], gpst_s: NDArray[np.float64]
) -> NDArray[np.float64]: ...
def smooth_code(
    range_m: NDArray[np.float64],
    carrier_m: NDArray[np.float64],
    broken: NDArray[np.bool_],
    epochs: int,
) -> NDArray[np.float64]: ...
def solve_fixes(
    table: NDArray[np.float64],
    reference_s: float,
    columns: Sequence[tuple[int, int, int, float]],
    groups: Sequence[tuple[int, int]],
    systems: int,
    settings_values: dict[str, Any],
    time_s: NDArray[np.float64],
    orbit: NDArray[np.int32],
    range_m: NDArray[np.float64],
    variance: NDArray[np.float64],
    rate_m_s: NDArray[np.float64],
    rate_variance: NDArray[np.float64],
    *,
    ekf: dict[str, float] | None = ...,
    threads: int = ...,
) -> dict[str, NDArray[Any]]: ...
def solve_snapshot(
    table: NDArray[np.float64],
    reference_s: float,
    phases: Sequence[tuple[int, int, int, float, int, float, float, float]],
    settings_values: dict[str, Any],
    place_m: Sequence[float],
    time_s: float,
    place_uncertainty_m: float,
    time_uncertainty_s: float,
) -> tuple[int, list[float], float, list[float], list[float], float, int, int | None] | None: ...

# inertial sensors
def imu_increments(
    origin: Sequence[float], knots: NDArray[np.float64], step: float, per: int
) -> list[NDArray[np.float64]]: ...
def imu_readings(
    rotation: NDArray[np.float64],
    velocity: NDArray[np.float64],
    interval: float,
    errors: Any,
    *,
    first: int = ...,
) -> list[NDArray[np.float64]]: ...

# inertial navigation
def inertial_navigate(
    rotation: NDArray[np.float64],
    velocity: NDArray[np.float64],
    interval: NDArray[np.float64],
    start: NDArray[np.float64],
    *,
    every: int,
    errors: Sequence[Any],
    alignments: NDArray[np.float64] | None = ...,
    realigned: tuple[Sequence[tuple[int, bool]], NDArray[np.float64]] | None = ...,
    vertical: NDArray[np.float64] | None = ...,
    earth_fixed: bool = ...,
) -> NDArray[np.float64]: ...
def inertial_covariance(
    rotation: NDArray[np.float64],
    velocity: NDArray[np.float64],
    interval: NDArray[np.float64],
    start: NDArray[np.float64],
    *,
    every: int,
    gyro: Sequence[float],
    accelerometer: Sequence[float],
    alignment: Sequence[Sequence[float]],
) -> NDArray[np.float64]: ...
def inertial_fit(
    rotation: NDArray[np.float64],
    velocity: NDArray[np.float64],
    interval: NDArray[np.float64],
    epochs: NDArray[np.float64],
    readings: NDArray[np.float64],
) -> NDArray[np.float64]: ...
def normal_gravity(
    latitude: NDArray[np.float64], height: NDArray[np.float64]
) -> NDArray[np.float64]: ...

# decision
def sprt_path(
    samples: NDArray[np.float64], form: str, variance: str, risk: float, guard: int
) -> NDArray[np.float64]: ...
def cusum_path(samples: NDArray[np.float64], shifts: Sequence[float]) -> NDArray[np.float64]: ...
def glr_path(samples: NDArray[np.float64], windows: Sequence[int]) -> NDArray[np.float64]: ...
def squares_path(samples: NDArray[np.float64], window: int) -> NDArray[np.float64]: ...
def student_path(samples: NDArray[np.float64], window: int, known: bool) -> NDArray[np.float64]: ...
def local_mean_path(
    samples: NDArray[np.float64], window: int, baseline: int, slope: bool, known: bool
) -> NDArray[np.float64]: ...
def change_log_ratio(
    samples: NDArray[np.float64],
    shifts: Sequence[tuple[float, float]],
    energy: bool,
    from_start: bool,
) -> NDArray[np.float64]: ...

# tightly coupled filter
def navigate_tight(
    imu_time: NDArray[np.float64],
    interval: float,
    rotation: NDArray[np.float64],
    velocity: NDArray[np.float64],
    time: NDArray[np.float64],
    system: Sequence[int],
    place: NDArray[np.float64],
    place_velocity: NDArray[np.float64],
    cn0: NDArray[np.float64],
    spoofed: NDArray[np.bool_],
    range_m: NDArray[np.float64],
    rate_m_s: NDArray[np.float64],
    change_m: NDArray[np.float64],
    starts: NDArray[np.float64],
    start_time: float,
    lever_arm: Sequence[float],
    settings_values: dict[str, Any],
    *,
    errors: Sequence[Any] | None = ...,
    detailed: bool = ...,
    threads: int = ...,
) -> list[dict[str, Any]]: ...
