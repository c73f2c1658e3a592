"""Benchmarks: commands, tasks with proofs, splits, fingerprints and demonstrations."""
