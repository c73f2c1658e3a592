"""Rewards made of a discriminator's logit l, with D = sigmoid(l) the probability of the expert.

    logit        l = log D - log(1 - D)      either sign (AIRL)
    softplus     -log(1 - D)                 never negative (GAIL)
    log-sigmoid  log D                       never positive
    probability  D                           0 .. 1
    binary       1 where D > 1/2, else 0     (AGILE)

Source: Ho & Ermon (2016); Bahdanau et al. (2019); Fu, Luo & Levine (2018).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, Literal, TypeGuard

import torch
from torch.nn import functional

from lcrl_bench.errors import UnknownNameError

LogitReward = Literal["logit", "softplus", "log-sigmoid", "probability", "binary"]

_REWARDS: Final[dict[str, Callable[[torch.Tensor], torch.Tensor]]] = {
    "logit": lambda logit: logit,
    "softplus": functional.softplus,
    "log-sigmoid": functional.logsigmoid,
    "probability": torch.sigmoid,
    "binary": lambda logit: (logit > 0).to(logit.dtype),
}


def is_logit_reward(name: object) -> TypeGuard[LogitReward]:
    """Whether there is such a reward."""
    return isinstance(name, str) and name in _REWARDS


def reward_of_logit(name: str, logit: torch.Tensor) -> torch.Tensor:
    """Make a reward of logits: float [...] -> float [...].

    Raises:
        UnknownNameError: If there is no such reward.
    """
    if name not in _REWARDS:
        raise UnknownNameError("reward", name, _REWARDS)
    return _REWARDS[name](logit)
