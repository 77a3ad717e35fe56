"""Settings that TOML can spell but no stage can use."""

import pytest
from pydantic import ValidationError

from sdr_spoof.acquisition import AcquisitionConfig
from sdr_spoof.detectors import DetectionConfig
from sdr_spoof.pvt import PvtConfig


def floats(model):
    return [
        (model, name)
        for name, field in model.model_fields.items()
        if field.annotation in (float, float | None)
    ]


@pytest.mark.parametrize("value", [float("nan"), float("inf"), float("-inf")])
@pytest.mark.parametrize(
    ("model", "name"), [*floats(AcquisitionConfig), *floats(DetectionConfig), *floats(PvtConfig)]
)
def test_no_setting_is_infinite_or_not_a_number(model, name, value):
    # An infinite handover_doppler_hz ended in an OverflowError; a min_cn0_dbhz that is not a
    # number left every window untested.
    with pytest.raises(ValidationError):
        model(**{name: value})
