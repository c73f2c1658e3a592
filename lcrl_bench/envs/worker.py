"""Set-up of environments in forked processes."""

from __future__ import annotations

import torch

from lcrl_bench.forking import is_forked


def compute_alone_if_forked() -> None:
    """Keep torch on one thread in a forked process, where the parent's thread pool would hang."""
    if is_forked() and torch.get_num_threads() > 1:
        torch.set_num_threads(1)
