"""Frozen benchmarks: houses, tasks, splits and fingerprint, one folder each."""
