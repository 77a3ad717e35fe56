"""The two descriptions of the environment agree, and its licences can be shipped with ours."""

from __future__ import annotations

import re
import tomllib
from importlib.metadata import distribution, requires
from pathlib import Path

ROOT = Path(__file__).parents[2]
PERMISSIVE = re.compile(r"\b(MIT|BSD|Apache|PSF|Python|ISC|MPL|HPND|Unlicense|LGPL|0BSD)", re.I)
COPYLEFT = re.compile(r"(?<!L)(?<!Lesser )\b(GPL|AGPL|GNU General Public)", re.I)


def test_requirements_file_is_the_lock() -> None:
    """requirements-dev.txt serves where uv is missing; `make lock` writes it."""
    lock = tomllib.loads((ROOT / "uv.lock").read_text())
    locked = {(p["name"], p["version"]) for p in lock["package"] if "virtual" not in p["source"]}
    lines = (ROOT / "requirements-dev.txt").read_text().splitlines()
    pinned = {tuple(line.split(" ;")[0].strip().split("==")) for line in lines if line}
    assert pinned == locked


def test_lock_has_one_public_source() -> None:
    lock = tomllib.loads((ROOT / "uv.lock").read_text())
    sources = [p["source"] for p in lock["package"] if "virtual" not in p["source"]]
    assert len({tuple(s.items()) for s in sources}) == 1
    assert sources[0]["registry"].startswith("https://")
    assert "@" not in sources[0]["registry"]


def runtime_packages() -> set[str]:
    """Everything that `pip install sdr-spoof` brings."""
    found: set[str] = set()
    waiting = ["sdr-spoof"]
    while waiting:
        for requirement in requires(waiting.pop()) or []:
            name, *_ = re.split(r"[ <>=!~;\[(]", requirement)
            if "extra ==" in requirement or "sys_platform" in requirement or name in found:
                continue
            if re.search(r'python_version *< *"3\.1[01]', requirement):
                continue
            found.add(name)
            waiting.append(name)
    return found


def licence_of(package: str) -> str:
    metadata = distribution(package).metadata
    classifiers = [c for c in metadata.get_all("Classifier") or [] if c.startswith("License")]
    return " ".join([metadata.get("License-Expression") or "", *classifiers]).strip() or (
        metadata.get("License") or ""
    )


def test_runtime_licences_are_permissive_or_lgpl() -> None:
    packages = runtime_packages()
    assert {"numpy", "sigmf", "jsonschema", "pillow"} <= packages
    for package in sorted(packages):
        licence = licence_of(package)
        assert PERMISSIVE.search(licence), f"{package}: {licence!r}"
        assert not COPYLEFT.search(licence), f"{package}: {licence!r}"
