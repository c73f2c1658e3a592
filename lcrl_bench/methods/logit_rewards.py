"""Rewards of a discriminator's logit l, where D = sigmoid(l) is the probability of the expert.

    logit        l = log D - log(1 - D)      either sign (AIRL)
    softplus     -log(1 - D)                 non-negative (GAIL)
    log-sigmoid  log D                       non-positive
    probability  D                           in [0, 1]
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
    """Whether `name` is one of these rewards."""
    return isinstance(name, str) and name in _REWARDS


def reward_of_logit(name: str, logit: torch.Tensor) -> torch.Tensor:
    """Compute a reward from logits: float [...] -> float [...].

    Raises:
        UnknownNameError: If there is no such reward.
    """
    if name not in _REWARDS:
        raise UnknownNameError("reward", name, _REWARDS)
    return _REWARDS[name](logit)
