"""Compares a set of houses with statistics of published ones: 25 checks by plane geometry."""
