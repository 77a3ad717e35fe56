"""Key paths into nested values, such as ``scenario.attack.0.drag_rate_m_s``."""

from __future__ import annotations

import copy
from typing import Any


def put(values: dict[str, Any], key: str, value: Any) -> None:
    """Set the value at a key path, in place.

    A number is an element of a list, ``*`` is every element. Tables that are missing on the way
    are made: whether a key exists is for the model to say.

    Raises:
        ValueError: a list has no such element, or something on the way is no table or list.
    """
    steps = key.split(".")
    for place in _places([values], steps[:-1], key):
        if isinstance(place, list):
            for index in _indices(place, steps[-1], key):
                place[index] = copy.deepcopy(value)
        elif isinstance(place, dict):
            place[steps[-1]] = copy.deepcopy(value)
        else:
            raise ValueError(f"{key}: {steps[-1]!r} is inside {place!r}, which is not a table")


def _places(places: list[Any], steps: list[str], key: str) -> list[Any]:
    """Everything that the steps lead to."""
    for step in steps:
        found: list[Any] = []
        for place in places:
            if isinstance(place, list):
                found += [place[index] for index in _indices(place, step, key)]
            elif isinstance(place, dict):
                found.append(place.setdefault(step, {}))
            else:
                raise ValueError(f"{key}: {step!r} is inside {place!r}, which is not a table")
        places = found
    return places


def _indices(place: list[Any], step: str, key: str) -> list[int]:
    if step == "*":
        return list(range(len(place)))
    if not step.isdecimal():
        raise ValueError(f"{key}: {step!r} stands where the number of an element, or *, should")
    if int(step) >= len(place):
        raise ValueError(f"{key}: there is no element {step}; there are {len(place)}, from 0")
    return [int(step)]
