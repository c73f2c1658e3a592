"""`--shard i/n`: parts that are disjoint, whole, and wait for each other nowhere."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from job_samples import word_job

from lcrl_bench.errors import UsageError
from lcrl_bench.jobs.shard import Shard

NAMES = [f"job{number}" for number in range(12)]


@given(st.lists(st.tuples(*[st.sampled_from(NAMES)] * 2), max_size=12), st.integers(1, 15))
def test_parts_are_all_of_the_jobs_and_keep_together_what_waits(pairs, count):
    after = {name: tuple({b for a, b in pairs if a == name and b < name}) for name in NAMES}
    jobs = [word_job(Path(), name, after=after[name]) for name in NAMES]
    parts = [Shard(index, count).of(jobs) for index in range(count)]
    assert sorted(job.name for part in parts for job in part) == sorted(NAMES)
    for part in parts:
        names = {job.name for job in part}
        assert all(names.issuperset(job.after) for job in part)


def test_independent_jobs_are_dealt_in_turn():
    jobs = [word_job(Path(), name) for name in NAMES]
    assert [job.name for job in Shard(1, 4).of(jobs)] == ["job1", "job5", "job9"]


@pytest.mark.parametrize("text", ["4/4", "1", "-1/4", "a/b", "0/0", "1/4/2", " 1/4"])
def test_what_is_no_part_is_refused(text):
    with pytest.raises(UsageError, match="write i/n, with i from 0 to n - 1"):
        Shard.parse(text)


def test_a_part_is_written_as_index_and_count():
    assert Shard.parse("3/4") == Shard(3, 4)
