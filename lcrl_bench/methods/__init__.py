"""The contract a method keeps, and the registry that finds it. No concrete method."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lcrl_bench.lazy import lazy_names

if TYPE_CHECKING:
    from lcrl_bench.methods.contract import Log as Log
    from lcrl_bench.methods.contract import Method as Method
    from lcrl_bench.methods.learned import Plan as Plan
    from lcrl_bench.methods.learned import Policy as Policy
    from lcrl_bench.methods.learned import Reward as Reward
    from lcrl_bench.methods.learned import RewardMap as RewardMap
    from lcrl_bench.methods.network_method import NetworkMethod as NetworkMethod
    from lcrl_bench.methods.network_policy import NetworkPolicy as NetworkPolicy
    from lcrl_bench.methods.network_reward import NetworkReward as NetworkReward
    from lcrl_bench.methods.registry import list_methods as list_methods
    from lcrl_bench.methods.registry import method_registry as method_registry
    from lcrl_bench.methods.registry import resolve_method as resolve_method
    from lcrl_bench.methods.tensors import TensorPolicy as TensorPolicy
    from lcrl_bench.methods.tensors import TensorReward as TensorReward
    from lcrl_bench.methods.train_set import TrainSet as TrainSet
    from lcrl_bench.methods.training import TrainingConfig as TrainingConfig
else:
    __getattr__, __dir__, __all__ = lazy_names(
        __name__,
        {
            "Log": ".contract",
            "Method": ".contract",
            "Plan": ".learned",
            "Policy": ".learned",
            "Reward": ".learned",
            "RewardMap": ".learned",
            "NetworkMethod": ".network_method",
            "NetworkPolicy": ".network_policy",
            "NetworkReward": ".network_reward",
            "list_methods": ".registry",
            "method_registry": ".registry",
            "resolve_method": ".registry",
            "TensorPolicy": ".tensors",
            "TensorReward": ".tensors",
            "TrainSet": ".train_set",
            "TrainingConfig": ".training",
        },
    )
