"""Every acceptance number of the INS/DME study, with few runs; errata; the registry."""

import pytest

from sdr_spoof.progress import silent
from sdr_spoof.reproduce import STUDIES
from sdr_spoof.reproduce.sprt_dme import PARTS, published
from sdr_spoof.reproduce.study import Effort

QUICK = Effort(runs=24, quick=True)
FEWEST = {
    "variance_section": 12,
    "delay_section": 40,
    "satellites_section": 3,
    "comparison_section": 15,
    "dme_section": 8,
    "isolation_section": 8,
    "laws_section": 9,
}


@pytest.mark.parametrize("part", PARTS, ids=lambda p: p.__name__.split(".")[-1])
def test_every_number_is_met_within_its_errors(part):
    section = part.section(QUICK, silent)
    assert len(section.numbers) >= FEWEST[part.__name__.split(".")[-1]]
    missed = [
        f"{n.what}: {n.value} not in {n.low} to {n.high}" for n in section.numbers if not n.met
    ]
    assert not missed
    assert all(p.png.startswith(b"\x89PNG") for p in section.pictures)
    assert all(len(row) == len(t.columns) for t in section.tables for row in t.rows if t.rows)
    names = [n.name for n in section.numbers]
    assert len(set(names)) == len(names)


def test_the_study_is_registered_with_its_errata():
    study = STUDIES["sprt-dme"]
    assert study.full_runs >= 2000
    titles = [e.title for e in study.errata()]
    assert len(titles) == len(set(titles)) >= 11


def test_published_settings():
    assert pytest.approx(11.5119, abs=1e-4) == published.THRESHOLD
    assert pytest.approx(-6.9077, abs=1e-4) == published.LOWER
