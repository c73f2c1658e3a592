"""The `lcrl-bench` command, one module a verb; no logic."""
