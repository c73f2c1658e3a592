"""Desks for the tests of the leaderboard's verbs."""

from __future__ import annotations

import pytest
from board_samples import Desk, make_desk


@pytest.fixture(scope="session")
def desk(tmp_path_factory) -> Desk:
    """A desk to copy: nothing on it is changed."""
    return make_desk(tmp_path_factory.mktemp("desk"))


@pytest.fixture
def spoilt(desk, tmp_path, monkeypatch) -> Desk:
    """A desk of one's own, to spoil; the verbs are run from where it is."""
    monkeypatch.chdir(tmp_path)
    return desk.copy(tmp_path)
