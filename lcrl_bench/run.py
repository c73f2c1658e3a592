"""`python -m lcrl_bench.run`: the verb `run` of the `lcrl-bench` command."""

import sys

from lcrl_bench.cli.main import main

if __name__ == "__main__":
    sys.exit(main(["run", *sys.argv[1:]]))
