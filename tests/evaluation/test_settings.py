"""`--set key=value` gives a method's fields values of their own types."""

from dataclasses import dataclass
from typing import ClassVar

import pytest

from lcrl_bench.errors import UnknownNameError, UsageError
from lcrl_bench.evaluation.settings import make_method, parse_settings


@dataclass(frozen=True)
class Config:
    passes: int = 3
    learning_rate: float = 0.1
    shuffle: bool = True


class Configured:
    Config = Config
    presets: ClassVar = {"long": {"passes": 30}}

    def __init__(self, config=None):
        self.config = config or Config()


class Plain:
    presets: ClassVar = {}


def test_a_preset_replaces_defaults_and_settings_replace_the_preset():
    assert make_method(Configured, {}, preset="long").config.passes == 30
    assert make_method(Configured, {"passes": "7"}, preset="long").config.passes == 7
    with pytest.raises(UnknownNameError, match="default, long"):
        make_method(Configured, {}, preset="short")


def test_values_take_the_type_of_their_field():
    settings = parse_settings(("passes=7", "learning_rate=2e-3", "shuffle=false"))
    assert make_method(Configured, settings).config == Config(7, 2e-3, False)


def test_without_settings_the_defaults_hold():
    assert make_method(Configured, {}).config == Config()
    assert isinstance(make_method(Plain, {}), Plain)


def test_an_unknown_setting_names_the_nearest():
    with pytest.raises(UnknownNameError, match=r"'passs'. Did you mean 'passes'\?"):
        make_method(Configured, {"passs": "1"})
    with pytest.raises(UnknownNameError, match="Valid: none"):
        make_method(Plain, {"passes": "1"})


def test_a_value_of_the_wrong_type_is_named():
    with pytest.raises(UsageError, match="--set passes=many"):
        make_method(Configured, {"passes": "many"})


def test_a_setting_without_a_value_is_refused():
    with pytest.raises(UsageError, match="key=value, found 'passes'"):
        parse_settings(("passes",))
