"""`python -m lcrl_bench`: the `lcrl-bench` command."""

from lcrl_bench.cli.main import entry_point

if __name__ == "__main__":
    entry_point()
