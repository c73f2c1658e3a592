"""What a process measures of itself is its own."""

from __future__ import annotations

import subprocess
import sys

import numpy as np

from tools.speed.stepping import peak_kb


def test_the_peak_of_a_process_is_not_what_its_parent_holds():
    held = np.ones(80_000_000)
    assert peak_kb() > held.nbytes / 1024
    script = "from tools.speed.stepping import peak_kb; print(peak_kb())"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert 10_000 < float(done.stdout) < held.nbytes / 1024
