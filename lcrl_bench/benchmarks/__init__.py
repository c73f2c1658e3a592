"""Benchmarks: commands, tasks and their proof, splits, fingerprint, demonstrations."""
