"""DQN for many tasks in parallel: one network per task, model-free."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lcrl_bench.lazy import lazy_names

if TYPE_CHECKING:
    from lcrl_bench.mdp.dqn.agents import DqnAgents as DqnAgents
    from lcrl_bench.mdp.dqn.config import DqnConfig as DqnConfig
    from lcrl_bench.mdp.dqn.solve import solve_dqn as solve_dqn
    from lcrl_bench.mdp.dqn.solve import solve_seeded as solve_seeded
    from lcrl_bench.mdp.dqn.stack import TaskStack as TaskStack
else:
    __getattr__, __dir__, __all__ = lazy_names(
        __name__,
        {
            "DqnAgents": ".agents",
            "DqnConfig": ".config",
            "TaskStack": ".stack",
            "solve_dqn": ".solve",
            "solve_seeded": ".solve",
        },
    )
