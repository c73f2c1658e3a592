"""Evaluation of fitted methods on all splits: harness, controls, tables and run folders."""
