"""Instruments for developing the suite, run from a checkout (`python -m tools.speed`).

They are not part of the package that is installed.
"""
