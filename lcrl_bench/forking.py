"""Whether this process was forked, and so must avoid the state of its parent's threads.

A fork copies all memory but only the calling thread. OpenGL drivers and thread pools (such as
PyTorch's OpenMP) are left with locks and queues whose threads are gone, and the first call that
needs one of them hangs. Processes that are spawned, or forked by a fork server, which runs nothing
itself, don't have this problem.
"""

from __future__ import annotations

import multiprocessing
import os
from typing import Any, Final

from lcrl_bench.errors import UsageError

_IMPORTED_BY: Final = os.getpid()
"""Id of the process that imported this module; its forks inherit the number."""


def is_forked() -> bool:
    """Whether this process is a fork of one that may have used OpenGL or threads.

    A fork can't know what its parent did, so it always counts.
    """
    started = _start_method()
    # A fork server may have imported this module, but hasn't run anything.
    return started == "fork" or (started != "forkserver" and os.getpid() != _IMPORTED_BY)


def refuse_opengl_if_forked() -> None:
    """Guard the start of an OpenGL context.

    Raises:
        UsageError: In a forked process.
    """
    if is_forked():
        raise UsageError(
            "OpenGL hangs in a forked process if its parent has used it. Render with "
            "renderer='auto' or renderer='rays', or start the process afresh: context='spawn' "
            "(Gymnasium's AsyncVectorEnv) or multiprocessing.get_context('spawn')."
        )


def _start_method() -> str | None:
    """How multiprocessing started this process; None if it didn't."""
    if multiprocessing.parent_process() is None:
        return None
    process = multiprocessing.current_process()
    for method in multiprocessing.get_all_start_methods():
        context: Any = multiprocessing.get_context(method)
        if isinstance(process, context.Process):
            return method
    return multiprocessing.get_start_method(allow_none=True)
