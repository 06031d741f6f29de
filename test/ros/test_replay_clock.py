from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from stereo_pick.ros.replay_clock import ReplayClock

S = 1_000_000_000
RECORDED = 1_760_000_000 * S
rates = st.floats(0.01, 100)


@given(rates, st.integers(0, 100 * S), st.integers(0, 100 * S))
def test_what_was_recorded_later_is_due_later_by_the_rate(rate: float, recorded_ns: int, passed_ns: int) -> None:
    clock = ReplayClock(rate)
    assert clock.until_ns(RECORDED, 5 * S) == 0
    wait_ns = clock.until_ns(RECORDED + recorded_ns, 5 * S + passed_ns)
    assert abs(wait_ns - (recorded_ns / rate - passed_ns)) < 10


@given(rates, rates, st.integers(1, 50 * S))
def test_another_rate_holds_from_now_on_without_a_jump(before: float, after: float, passed_ns: int) -> None:
    clock = ReplayClock(before)
    clock.until_ns(RECORDED, 0)
    clock.set_rate(after, passed_ns)
    played_ns = round(passed_ns * before)
    assert abs(clock.until_ns(RECORDED + played_ns, passed_ns)) < 200
    assert abs(clock.until_ns(RECORDED + played_ns + S, passed_ns) - S / after) < 200


def test_a_rate_set_before_the_start_holds_from_the_start() -> None:
    clock = ReplayClock(1.0)
    clock.set_rate(2.0, 123)
    assert clock.until_ns(RECORDED, 7 * S) == 0
    assert clock.until_ns(RECORDED + 4 * S, 7 * S) == 2 * S


@given(rates, st.integers(1, 100 * S))
def test_a_replay_that_was_held_up_catches_up_at_twice_its_rate(rate: float, held_up_ns: int) -> None:
    clock, interval_ns = ReplayClock(rate), round(S / rate)
    now_ns = clock.until_ns(RECORDED, 0)
    clock.published(RECORDED, now_ns)
    now_ns = interval_ns + held_up_ns
    for n in range(1, 5):
        wait_ns = max(0, clock.until_ns(RECORDED + n * S, now_ns))
        assert n == 1 or abs(now_ns + wait_ns - max(n * interval_ns, now_ns + interval_ns // 2)) < 10
        now_ns += wait_ns
        clock.published(RECORDED + n * S, now_ns)


@given(rates, st.integers(1, 100 * S), st.integers(0, 100 * S))
def test_what_starts_over_comes_a_period_after_the_last(rate: float, period_ns: int, late_ns: int) -> None:
    clock = ReplayClock(rate)
    clock.until_ns(RECORDED, 0)
    clock.published(RECORDED + 9 * S, late_ns)
    clock.start_over(RECORDED, period_ns)
    assert abs(clock.until_ns(RECORDED, late_ns) - period_ns / rate) < 10
    clock.published(RECORDED, late_ns + round(period_ns / rate))
    assert abs(clock.until_ns(RECORDED + S, late_ns) - (period_ns + S) / rate) < 10
