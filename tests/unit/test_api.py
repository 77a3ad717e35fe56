"""The public names exist and say what they are."""

from __future__ import annotations

import importlib
import inspect
import pkgutil

import pytest

import sdr_spoof


def test_every_public_name_can_be_imported() -> None:
    for name in sdr_spoof.__all__:
        item = getattr(sdr_spoof, name)
        assert inspect.getdoc(item), name
        assert item.__module__.startswith("sdr_spoof."), name


def test_unknown_name() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        _ = sdr_spoof.nothing  # type: ignore[attr-defined]


def test_every_module_imports_and_is_documented() -> None:
    found = 0
    for module in pkgutil.walk_packages(sdr_spoof.__path__, "sdr_spoof."):
        if module.name != "sdr_spoof._core":
            assert importlib.import_module(module.name).__doc__, module.name
            found += 1
    assert found > 40
