"""Entry point of `python -m tools.optics`."""

import sys

from lcrl_bench.cli.main import run_command
from tools.optics.command import PROGRAM, main

if __name__ == "__main__":
    sys.exit(run_command(main, sys.argv[1:], program=PROGRAM))
