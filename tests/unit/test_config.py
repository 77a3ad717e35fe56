"""One model: TOML, flags, help and errors."""

from __future__ import annotations

import argparse
from pathlib import Path

import pytest

from sdr_spoof.config import Config, add_flags, from_arguments, load_config
from sdr_spoof.errors import ConfigError

GROUPS = tuple(Config.model_fields)


def parsed(*arguments: str) -> Config:
    parser = argparse.ArgumentParser(allow_abbrev=False)
    add_flags(parser, GROUPS)
    return from_arguments(parser.parse_args(arguments))


def toml(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "settings.toml"
    path.write_text(text)
    return path


def test_defaults() -> None:
    assert load_config() == Config() == parsed()


def test_flags_win_over_the_file(tmp_path: Path) -> None:
    path = toml(tmp_path, "[acquisition]\npfa = 1e-4\ndoppler_max_hz = 6000\n")
    config = parsed("--config", str(path), "--acquisition-pfa", "1e-3")
    assert config.acquisition.pfa == 1e-3
    assert config.acquisition.doppler_max_hz == 6000.0
    assert config.tracking == Config().tracking


def test_flags_of_other_types() -> None:
    config = parsed(
        *("--acquisition-handover", "false", "--acquisition-blocks-long", "7"),
        *("--detection-detectors", "phase_difference_rate"),
        *("--detection-threshold-model", "thermal"),
    )
    assert config.acquisition.handover is False
    assert config.acquisition.blocks_long == 7
    assert config.detection.detectors == ("phase_difference_rate",)
    assert config.detection.threshold_model == "thermal"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "[acquisition]\ndopler_max_hz = 1\n",
            r"settings\.toml: \[acquisition\] dopler_max_hz: unknown key 'dopler_max_hz'; "
            "did you mean 'doppler_max_hz'",
        ),
        ("[aquisition]\n", r"settings\.toml: aquisition: .*did you mean 'acquisition'"),
        ("[acquisition]\npfa = 2\n", r"\[acquisition\] pfa: Input should be less than .* not 2"),
        ('[acquisition]\npfa = "x"\n', r"\[acquisition\] pfa: Input should be a valid number"),
        ("[acquisition\n", r"settings\.toml: not valid TOML: .*line 1"),
        ("acquisition = 3\n", r"settings\.toml: acquisition: .*not 3"),
    ],
)
def test_wrong_files(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        load_config(toml(tmp_path, text))


def test_all_mistakes_are_told_at_once(tmp_path: Path) -> None:
    path = toml(tmp_path, "[acquisition]\npfa = 2\nblocks = 3\n")
    with pytest.raises(ConfigError) as error:
        load_config(path)
    assert len(str(error.value).splitlines()) == 2


def test_missing_file(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="cannot be read: No such file"):
        load_config(tmp_path / "none.toml")


def test_wrong_flag_is_named_as_a_flag(tmp_path: Path) -> None:
    path = toml(tmp_path, "[acquisition]\npfa = 1e-4\n")
    with pytest.raises(ConfigError, match=r"^--acquisition-pfa: .*not 'high'"):
        parsed("--config", str(path), "--acquisition-pfa", "high")


def leaves(model: type) -> list[tuple[str, str | None]]:
    return [
        (f"{group}.{name}", field.description)
        for group in GROUPS
        for name, field in model.model_fields[group].annotation.model_fields.items()
    ]


def test_every_field_has_a_description_and_a_flag(capsys: pytest.CaptureFixture[str]) -> None:
    parser = argparse.ArgumentParser()
    add_flags(parser, GROUPS)
    text = parser.format_help()
    for name, description in leaves(Config):
        assert description, name
        assert "--" + name.replace(".", "-").replace("_", "-") in text
