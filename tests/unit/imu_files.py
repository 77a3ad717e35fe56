"""Files of IMUs for tests."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pydantic import TypeAdapter

from sdr_spoof.aiding.imu.readers import novatel, table
from sdr_spoof.aiding.imu.simulate import ideal_increments
from sdr_spoof.aiding.records import ImuLog
from sdr_spoof.nav.time import GnssTime
from sdr_spoof.scenario.sky.receiver import AnyReceiver

PLACE = {"latitude_deg": 31.2, "longitude_deg": 121.5, "height_m": 20.0}
START = GnssTime.of_week(2253, 43218.0)


def drive(kind: str = "ship", duration_s: float = 60.0, rate_hz: float = 50.0) -> ImuLog:
    """Increments of a perfect IMU."""
    place = PLACE if kind != "uav" else {}
    receiver = TypeAdapter(AnyReceiver).validate_python({"kind": kind, "seed": 2, **place})
    trajectory = receiver.trajectory(duration_s)
    return ideal_increments(trajectory, duration_s, rate_hz, reference=START)


def csv_of(log: ImuLog, path: Path, **columns: NDArray[np.float64]) -> Path:
    """A table of given columns, in that order, beside ``time_s``."""
    names = ["time_s", *columns]
    values = np.column_stack([log.time_s, *columns.values()])
    rows = [",".join(f"{v:.12g}" for v in row) for row in values]
    path.write_text("\n".join([",".join(names), *rows]))
    return path


def rates_csv(
    log: ImuLog, path: Path, *, gyro: str = "rad_s", accel: str = "m_s2", of: tuple = (1.0, 1.0)
) -> Path:
    """Mean rates of increments, multiplied by ``of``, under names that may not be true."""
    w, f = log.rotation_rad / log.interval_s * of[0], log.velocity_m_s / log.interval_s * of[1]
    columns = {f"gyro_{a}_{gyro}": w[:, k] for k, a in enumerate("xyz")}
    columns |= {f"accel_{a}_{accel}": f[:, k] for k, a in enumerate("xyz")}
    return csv_of(log, path, **columns)


def write_table(log: ImuLog, path: Path) -> Path:
    table.write(path, log)
    return path


def write_novatel(log: ImuLog, path: Path) -> Path:
    """RAWIMUSXA of a STIM300 mounted right, forward, up."""
    scale = next(s for s in novatel.SCALES if "STIM300" in s.models)
    turn = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1]])
    gyro = np.rint(log.rotation_rad @ turn / scale.gyro).astype(int)
    accel = np.rint(log.velocity_m_s @ turn / scale.accel).astype(int)
    lines = []
    for time_s, g, a in zip(log.time_s, gyro, accel, strict=True):
        week, tow_s = (START + float(time_s)).week_tow()
        counts = f"{a[2]},{-a[1]},{a[0]},{g[2]},{-g[1]},{g[0]}"
        body = f"RAWIMUSXA,{week},{tow_s:.3f};00,32,{week},{tow_s:.6f},00000077,{counts}"
        lines.append(f"%{body}*{novatel.crc32(body.encode()):08x}")
    path.write_text("#BESTPOSA,COM1,0;SOL_COMPUTED*00000000\r\n" + "\r\n".join(lines))
    return path


WRITERS = {"csv": write_table, "novatel": write_novatel}
"""What writes a file that each registered reader reads."""
QUANTA = {"csv": (1e-15, 1e-13), "novatel": (5e-9, 1.2e-7)}
"""Half of their resolution in rad and m/s."""
