"""Batched tabular MDPs, solved exactly: Q-iteration, occupancy, success. Nothing about houses."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lcrl_bench.lazy import lazy_names

if TYPE_CHECKING:
    from lcrl_bench.mdp.dynamics import fold_cells as fold_cells
    from lcrl_bench.mdp.dynamics import spread_cells as spread_cells
    from lcrl_bench.mdp.expert import expert_policy as expert_policy
    from lcrl_bench.mdp.expert import shortest_way_policy as shortest_way_policy
    from lcrl_bench.mdp.expert import true_reward as true_reward
    from lcrl_bench.mdp.maximum_entropy import Marginals as Marginals
    from lcrl_bench.mdp.maximum_entropy import soft_marginals as soft_marginals
    from lcrl_bench.mdp.maximum_entropy import soft_marginals_of as soft_marginals_of
    from lcrl_bench.mdp.planning import Solution as Solution
    from lcrl_bench.mdp.planning import q_iteration as q_iteration
    from lcrl_bench.mdp.planning import soft_q_iteration as soft_q_iteration
    from lcrl_bench.mdp.policy_outcome import PolicyOutcome as PolicyOutcome
    from lcrl_bench.mdp.policy_outcome import follow as follow
    from lcrl_bench.mdp.policy_outcome import follow_greedy as follow_greedy
    from lcrl_bench.mdp.rollouts import Trajectories as Trajectories
    from lcrl_bench.mdp.rollouts import rollout as rollout
    from lcrl_bench.mdp.rollouts import sample_trajectories as sample_trajectories
    from lcrl_bench.mdp.success import UNREACHABLE as UNREACHABLE
    from lcrl_bench.mdp.success import distance_to_goal as distance_to_goal
    from lcrl_bench.mdp.success import final_success_probability as final_success_probability
    from lcrl_bench.mdp.success import optimal_length as optimal_length
    from lcrl_bench.mdp.success import success_probability as success_probability
    from lcrl_bench.mdp.success import uniform_policy as uniform_policy
    from lcrl_bench.mdp.task_batch import ACTIONS as ACTIONS
    from lcrl_bench.mdp.task_batch import HEADINGS as HEADINGS
    from lcrl_bench.mdp.task_batch import Action as Action
    from lcrl_bench.mdp.task_batch import TaskBatch as TaskBatch
    from lcrl_bench.mdp.visitation import empirical_occupancy as empirical_occupancy
    from lcrl_bench.mdp.visitation import occupancy as occupancy
    from lcrl_bench.mdp.visitation import occupancy_mass as occupancy_mass
else:
    __getattr__, __dir__, __all__ = lazy_names(
        __name__,
        {
            "fold_cells": ".dynamics",
            "spread_cells": ".dynamics",
            "expert_policy": ".expert",
            "shortest_way_policy": ".expert",
            "true_reward": ".expert",
            "Marginals": ".maximum_entropy",
            "soft_marginals": ".maximum_entropy",
            "soft_marginals_of": ".maximum_entropy",
            "Solution": ".planning",
            "q_iteration": ".planning",
            "soft_q_iteration": ".planning",
            "PolicyOutcome": ".policy_outcome",
            "follow": ".policy_outcome",
            "follow_greedy": ".policy_outcome",
            "Trajectories": ".rollouts",
            "rollout": ".rollouts",
            "sample_trajectories": ".rollouts",
            "UNREACHABLE": ".success",
            "distance_to_goal": ".success",
            "final_success_probability": ".success",
            "optimal_length": ".success",
            "success_probability": ".success",
            "uniform_policy": ".success",
            "ACTIONS": ".task_batch",
            "Action": ".task_batch",
            "HEADINGS": ".task_batch",
            "TaskBatch": ".task_batch",
            "empirical_occupancy": ".visitation",
            "occupancy": ".visitation",
            "occupancy_mass": ".visitation",
        },
    )
