"""A set of houses held to the statistics of published ones: 25 checks, by plane geometry alone."""

from lcrl_bench.houses.statistics.report import Finding, judge, measure

__all__ = ["Finding", "judge", "measure"]
