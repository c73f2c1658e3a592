"""Reward regression, the oracle."""
