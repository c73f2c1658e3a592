"""Desks for the tests of the leaderboard."""

from __future__ import annotations

import pytest
from board_samples import Desk, make_desk


@pytest.fixture(scope="session")
def desk(tmp_path_factory) -> Desk:
    """A desk to read from: nothing on it is changed."""
    return make_desk(tmp_path_factory.mktemp("desk"))


@pytest.fixture
def spoilt(desk, tmp_path) -> Desk:
    """A desk of one's own, to spoil."""
    return desk.copy(tmp_path / "desk")
