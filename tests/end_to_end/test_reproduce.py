"""``sdr-spoof reproduce`` as a user runs it."""

import csv
import json

import jsonschema
import pytest
from commands import failing

from sdr_spoof.cli import main
from sdr_spoof.reproduce import sprt_dme
from sdr_spoof.reproduce.combo import echo_section, multipath, receiver, receiver_section
from sdr_spoof.reproduce.ins_rate import (
    drag_section,
    drift_section,
    false_alarms,
    flight_section,
    rules_section,
)
from sdr_spoof.reproduce.ship import (
    attack_section,
    clean_section,
    coasting_section,
    literal_section,
)
from sdr_spoof.reproduce.study import Section

NUMBER = {
    "type": "object",
    "required": ["name", "what", "value", "low", "high", "unit", "reference", "met"],
    "properties": {
        "name": {"type": "string"},
        "what": {"type": "string"},
        "unit": {"type": "string"},
        "value": {"type": "number"},
        "low": {"type": ["number", "null"]},
        "high": {"type": ["number", "null"]},
        "reference": {"type": ["number", "null"]},
        "met": {"type": "boolean"},
    },
    "additionalProperties": False,
}
SCHEMA = {
    "type": "object",
    "required": ["study", "effort", "met", "acceptance", "tables", "errata", "skipped", "files"],
    "properties": {
        "study": {"const": "combo"},
        "met": {"type": "boolean"},
        "acceptance": {"type": "array", "items": NUMBER, "minItems": 90},
        "tables": {
            "type": "object",
            "additionalProperties": {"type": "array", "items": {"type": "object"}},
        },
        "errata": {"type": "array", "minItems": 6},
        "skipped": {"type": "array", "items": {"type": "string"}},
    },
}


def few_points(cn0_dbhz):
    return [receiver.Point(cn0_dbhz, drag_hz, 1.5) for drag_hz in (1.0, 10.0)]


@pytest.fixture
def short(monkeypatch):
    """Parts that take seconds even with one run, shortened."""
    monkeypatch.setattr(multipath, "EPOCHS", 400)
    monkeypatch.setattr(receiver_section, "IF_QUICK_HZ", (1.0,))
    monkeypatch.setattr(receiver_section, "CN0S_QUICK_DBHZ", (30.0,))
    monkeypatch.setattr(receiver_section, "_points", few_points)
    monkeypatch.setattr(echo_section, "AMPLITUDES", (0.5,))
    monkeypatch.setattr(echo_section, "LEAST_SPOOFED", 1)


def test_quick_reproduction(tmp_path, capsys, short):
    folder = tmp_path / "study"
    command = ["reproduce", "combo", "--quick", "--runs", "2", "--threads", "1", "-o", str(folder)]
    code = main([*command, "--json"])
    printed = json.loads(capsys.readouterr().out)
    jsonschema.validate(printed, SCHEMA)
    assert code == int(not printed["met"])
    assert len(printed["tables"]["receiver_30_dbhz"]) == 2
    assert sorted(p.name for p in folder.iterdir()) == sorted(printed["files"])
    saved = json.loads((folder / "combo.json").read_text())
    assert saved == {k: v for k, v in printed.items() if k != "output"}
    html = (folder / "combo.html").read_text()
    assert html.count("data:image/png;base64,") == sum(f.endswith("png") for f in saved["files"])
    assert 'src="http' not in html
    with (folder / "pd_by_drag.csv").open() as file:
        assert next(csv.DictReader(file))["published"] == "0.6196"
    _, message = failing(capsys, *command)
    assert "add --force" in message


def test_quick_reproduction_of_ins_rate(tmp_path, capsys, monkeypatch):
    def nothing(effort, stages, executor=None):
        return Section("left out")

    for module in (drift_section, drag_section, flight_section, rules_section):
        monkeypatch.setattr(module, "section", nothing)
    monkeypatch.setattr(false_alarms, "QUICK_FLIGHTS", 2)
    folder = tmp_path / "study"
    command = ["reproduce", "ins-rate", "--quick", "--threads", "1", "-o", str(folder), "--json"]
    main(command)
    printed = json.loads(capsys.readouterr().out)
    assert printed["study"] == "ins-rate"
    assert len(printed["errata"]) == 9
    assert len(printed["tables"]["table5"]) == 9
    assert {"figure11.png", "local_test.png", "samples.csv"} < set(printed["files"])


def test_quick_reproduction_of_ship(tmp_path, capsys, monkeypatch):
    def nothing(effort, stages):
        return Section("left out")

    for module in (literal_section, coasting_section, clean_section):
        monkeypatch.setattr(module, "section", nothing)
    three = [a for a in attack_section.LIST if a.name == "three_0.5"]
    monkeypatch.setattr(attack_section, "LIST", three)
    folder = tmp_path / "study"
    command = ["reproduce", "ship", "--quick", "--runs", "1", "-o", str(folder), "--json"]
    assert main(command) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed["met"]
    assert len(printed["errata"]) == 7
    assert printed["tables"]["attacks"][0]["three named right"] == 1.0
    assert {"attack_errors.png", "statistic_delays.csv"} < set(printed["files"])


def test_quick_reproduction_of_sprt_dme(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(sprt_dme, "PARTS", (sprt_dme.PARTS[0], sprt_dme.PARTS[5]))
    folder = tmp_path / "study"
    command = ["reproduce", "sprt-dme", "--quick", "--threads", "1", "-o", str(folder), "--json"]
    assert main(command) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed["study"] == "sprt-dme"
    assert printed["met"]
    assert len(printed["errata"]) == 11
    assert {"equations.csv", "isolation.csv", "sprt-dme.html"} < set(printed["files"])


def test_unknown_study(tmp_path, capsys):
    code, message = failing(capsys, "reproduce", "nothing", "-o", tmp_path / "out")
    assert code == 2
    assert "known studies: combo" in message


def test_folder_that_is_a_file(tmp_path, capsys):
    path = tmp_path / "file"
    path.write_text("")
    _, message = failing(capsys, "reproduce", "combo", "-o", path)
    assert "is not a folder" in message
