"""Fields of B-CNAV1: subframe 2 and the pages of subframe 3.

Sources: BDS-SIS-ICD-B1C-1.0, figures 6-6 to 6-21 (places), tables 7-5 to 7-22 (scales).
"""

from __future__ import annotations

from .bits import SEMICIRCLE, Field, Layout

ORBIT_ANGLE, ORBIT_RATE = SEMICIRCLE * 2.0**-32, SEMICIRCLE * 2.0**-44
MIDI_ANGLE, REDUCED_ANGLE = SEMICIRCLE * 2.0**-15, SEMICIRCLE * 2.0**-6
TIME_STEP_S, TOA_STEP_S, OFFSET_STEP_S = 300, 4096, 16
"""Steps of toe and toc, of the almanac's time, and of the times that offsets refer to."""


def consecutive(
    first: int, *fields: tuple[str, int] | tuple[str, int, float], signed: str = ""
) -> Layout:
    """Layout of fields one behind the other from a bit on: (name, number of bits, scale)."""
    built, names = [], signed.split()
    for name, count, *scale in fields:
        built.append(Field(name, ((first, count),), scale[0] if scale else 1.0, name in names))
        first += count
    return Layout(tuple(built))


SUBFRAME2 = consecutive(
    1,
    ("week", 13),
    ("how", 8),
    ("iodc", 10),
    ("iode", 8),
    ("toe", 11, TIME_STEP_S),
    ("sat_type", 2),
    ("delta_a", 26, 2.0**-9),
    ("a_dot", 25, 2.0**-21),
    ("delta_n", 17, ORBIT_RATE),
    ("delta_n_dot", 23, SEMICIRCLE * 2.0**-57),
    ("m0", 33, ORBIT_ANGLE),
    ("e", 33, 2.0**-34),
    ("omega", 33, ORBIT_ANGLE),
    ("omega0", 33, ORBIT_ANGLE),
    ("i0", 33, ORBIT_ANGLE),
    ("omega_dot", 19, ORBIT_RATE),
    ("i_dot", 15, ORBIT_RATE),
    ("cis", 16, 2.0**-30),
    ("cic", 16, 2.0**-30),
    ("crs", 24, 2.0**-8),
    ("crc", 24, 2.0**-8),
    ("cus", 21, 2.0**-30),
    ("cuc", 21, 2.0**-30),
    ("toc", 11, TIME_STEP_S),
    ("a0", 25, 2.0**-34),
    ("a1", 22, 2.0**-50),
    ("a2", 11, 2.0**-66),
    ("tgd_b2ap", 12, 2.0**-34),
    ("isc_b1cd", 12, 2.0**-34),
    ("tgd_b1cp", 12, 2.0**-34),
    signed="delta_a a_dot delta_n delta_n_dot m0 omega omega0 i0 omega_dot i_dot cis cic crs crc "
    "cus cuc a0 a1 a2 tgd_b2ap isc_b1cd tgd_b1cp",
)
HEADER = consecutive(
    1, ("page", 6), ("health", 2), ("dif", 1), ("sif", 1), ("aif", 1), ("sismai", 4)
)
BODY = 16
"""First bit of a page behind its header. Pages with the accuracy of the orbit (1 and 3) begin with
its 5 bits, those with the accuracy of the clock (1, 2 and 4) with 22, or have them next."""
BDGIM = consecutive(
    BODY + 5 + 22,
    ("alpha1", 10, 0.125),
    ("alpha2", 8, 0.125),
    ("alpha3", 8, 0.125),
    ("alpha4", 8, 0.125),
    ("alpha5", 8, -0.125),
    ("alpha6", 8, 0.125),
    ("alpha7", 8, 0.125),
    ("alpha8", 8, 0.125),
    ("alpha9", 8, 0.125),
    signed="alpha2 alpha6 alpha7 alpha8 alpha9",
)
UTC = consecutive(
    BODY + 5 + 22 + 74,
    ("a0", 16, 2.0**-35),
    ("a1", 13, 2.0**-51),
    ("a2", 7, 2.0**-68),
    ("leap_s", 8),
    ("tow", 16, OFFSET_STEP_S),
    ("week", 13),
    ("leap_week", 13),
    ("leap_day", 3),
    ("leap_future_s", 8),
    signed="a0 a1 a2 leap_s leap_future_s",
)
ALMANAC_WEEK = consecutive(BODY + 22, ("week", 13), ("toa", 8, TOA_STEP_S))
REDUCED_COUNT, REDUCED_BITS = 4, 38
REDUCED = tuple(
    consecutive(
        BODY + 22 + 21 + REDUCED_BITS * n,
        ("prn", 6),
        ("sat_type", 2),
        ("delta_a", 8, 512.0),
        ("omega0", 7, REDUCED_ANGLE),
        ("phi0", 7, REDUCED_ANGLE),
        ("health", 8),
        signed="delta_a omega0 phi0",
    )
    for n in range(REDUCED_COUNT)
)
BGTO = consecutive(
    BODY + 5 + 138,
    ("system", 3),
    ("week", 13),
    ("tow", 16, OFFSET_STEP_S),
    ("a0", 16, 2.0**-35),
    ("a1", 13, 2.0**-51),
    ("a2", 7, 2.0**-68),
    signed="a0 a1 a2",
)
"""Behind the Earth orientation parameters, which nothing here needs: they are sent as zeros."""
MIDI = consecutive(
    BODY + 22,
    ("prn", 6),
    ("sat_type", 2),
    ("week", 13),
    ("toa", 8, TOA_STEP_S),
    ("e", 11, 2.0**-16),
    ("delta_i", 11, SEMICIRCLE * 2.0**-14),
    ("sqrt_a", 17, 2.0**-4),
    ("omega0", 16, MIDI_ANGLE),
    ("omega_dot", 11, SEMICIRCLE * 2.0**-33),
    ("omega", 16, MIDI_ANGLE),
    ("m0", 16, MIDI_ANGLE),
    ("a0", 11, 2.0**-20),
    ("a1", 10, 2.0**-37),
    ("health", 8),
    signed="delta_i omega0 omega_dot omega m0 a0 a1",
)
