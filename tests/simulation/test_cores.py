"""Work on all cores."""

from __future__ import annotations

from threadpoolctl import threadpool_info, threadpool_limits

from workbench.simulation import on_all_cores


def threads_of_linear_algebra(*_: object) -> set[int]:
    """How many threads a call of it takes."""
    return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}


def test_results_come_in_the_order_of_the_arguments() -> None:
    assert on_all_cores(lambda a, b: a - b, range(50), range(50, 0, -1)) == [2 * k - 50 for k in range(50)]


def test_linear_algebra_keeps_to_one_thread_beside_ours() -> None:
    with threadpool_limits(2, user_api="blas"):
        assert threads_of_linear_algebra() == {2}
        assert on_all_cores(threads_of_linear_algebra, range(4)) == [{1}] * 4
        assert threads_of_linear_algebra() == {2}
