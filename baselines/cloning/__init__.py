"""Optimal policy cloning."""
