"""Thirty houses that every law is tried on."""

from __future__ import annotations

import pytest

from lcrl_bench.houses.house import House
from lcrl_bench.houses.procedural import generate_house


@pytest.fixture(scope="session")
def houses() -> tuple[House, ...]:
    return tuple(generate_house(seed) for seed in range(30))
