"""The open benchmark suite for language-conditioned reward learning in MuJoCo houses.

    import lcrl_bench

    benchmark = lcrl_bench.load_benchmark("mini")
    results = lcrl_bench.run("lcrl", benchmark, seeds=[0, 1, 2])
    print(results)

Names are imported on first use: importing the package imports neither torch nor MuJoCo. The
environment `lcrl_bench/House-v1` is registered with Gymnasium, whichever is imported first.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from lcrl_bench.after_import import import_after
from lcrl_bench.lazy import lazy_names
from lcrl_bench.version import __version__ as __version__

if TYPE_CHECKING:
    from lcrl_bench.benchmarks.catalogue import list_benchmarks as list_benchmarks
    from lcrl_bench.benchmarks.task import Task as Task
    from lcrl_bench.benchmarks.task_sets import load_benchmark as load_benchmark
    from lcrl_bench.evaluation.results import Results as Results
    from lcrl_bench.evaluation.runs import evaluate as evaluate
    from lcrl_bench.evaluation.runs import run as run
    from lcrl_bench.houses.house import House as House
    from lcrl_bench.houses.procedural.generate import generate_house as generate_house
    from lcrl_bench.houses.sources import import_house as import_house
    from lcrl_bench.methods.contract import Method as Method
    from lcrl_bench.methods.learned import Policy as Policy
    from lcrl_bench.methods.learned import Reward as Reward
    from lcrl_bench.methods.registry import list_methods as list_methods
    from lcrl_bench.scenes.scene import Scene as Scene
else:
    __getattr__, __dir__, __all__ = lazy_names(
        __name__,
        {
            "list_benchmarks": ".benchmarks.catalogue",
            "Task": ".benchmarks.task",
            "load_benchmark": ".benchmarks.task_sets",
            "Results": ".evaluation.results",
            "evaluate": ".evaluation.runs",
            "run": ".evaluation.runs",
            "House": ".houses.house",
            "generate_house": ".houses.procedural.generate",
            "import_house": ".houses.sources",
            "Method": ".methods.contract",
            "Policy": ".methods.learned",
            "Reward": ".methods.learned",
            "list_methods": ".methods.registry",
            "Scene": ".scenes.scene",
        },
    )

import_after("gymnasium", "lcrl_bench.envs")
