"""`python -m lcrl_bench.run`: the verb `run` of the `lcrl-bench` command.

The function `lcrl_bench.run` shares its name with this module, so the module can be called like the
function: importing it takes nothing away.
"""

import sys
from types import ModuleType
from typing import Any

from lcrl_bench.registry import import_target


class _Callable(ModuleType):
    def __call__(self, *args: Any, **settings: Any) -> Any:  # noqa: ANN401 - as the function
        return import_target("lcrl_bench.evaluation.runs:run")(*args, **settings)


if __name__ == "__main__":
    from lcrl_bench.cli.main import main

    sys.exit(main(["run", *sys.argv[1:]]))

sys.modules[__name__].__class__ = _Callable
