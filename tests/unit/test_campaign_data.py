"""Every campaign that comes with the package is right, and small enough to read."""

from __future__ import annotations

from pathlib import Path

import pytest

import sdr_spoof.campaign
from sdr_spoof.campaign import plan_campaign

FOLDER = Path(sdr_spoof.campaign.__file__).parent / "data"


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.toml")), ids=lambda path: path.stem)
def test_shipped_campaigns_are_right(path: Path) -> None:
    plan = plan_campaign(path)
    assert plan.total >= len(plan.points) >= 1
    assert f"sdr-spoof campaign {path.name} -o results" in path.read_text()


def test_drags_have_the_rates_that_their_ramps_say() -> None:
    for point in plan_campaign(FOLDER / "slow-drags.toml").points:
        (attack,) = point.scenario.attack
        wavelength_m = 299_792_458.0 / 1575.42e6
        assert attack.drag_rate_m_s == pytest.approx(attack.drag_ramp_s * wavelength_m, rel=1e-3)
