from __future__ import annotations

from typing import Any

from hypothesis import given
from hypothesis import strategies as st
from sensor_msgs.msg import CameraInfo

from stereo_pick.ros.messages.stamps import header, stamp_ns
from stereo_pick.ros.stamp_join import StampJoin

TOPICS = ("a", "b", "c")


class Joined(list[tuple[int, ...]]):
    """The stamps of the messages of each join."""

    def __call__(self, together: dict[str, Any]) -> None:
        self.append(tuple(stamp_ns(together[topic].header.stamp) for topic in TOPICS))


def made() -> tuple[StampJoin, Joined]:
    joined = Joined()
    return StampJoin(TOPICS, joined), joined


def put(join: StampJoin, topic: str, stamp: int) -> None:
    join.add(topic, CameraInfo(header=header(stamp, "")))


@given(st.permutations([(topic, stamp) for topic in TOPICS for stamp in range(5)]))
def test_whatever_the_order_each_stamp_joins_once(order: list[tuple[str, int]]) -> None:
    join, joined = made()
    for topic, stamp in order:
        put(join, topic, stamp)
    assert sorted(joined) == [(stamp,) * 3 for stamp in range(5)]


def test_only_equal_stamps_join() -> None:
    join, joined = made()
    for topic, stamp in (("a", 1), ("b", 1), ("c", 2), ("a", 2)):
        put(join, topic, stamp)
    assert joined == []


def test_what_waits_is_bounded_and_the_newest_still_joins() -> None:
    join, joined = made()
    for stamp in range(1000):
        put(join, "a", stamp)
    put(join, "b", 0)
    put(join, "c", 0)
    assert joined == []
    put(join, "b", 999)
    put(join, "c", 999)
    assert joined == [(999,) * 3]


def test_a_replay_that_starts_over_joins_although_newer_stamps_wait_in_vain() -> None:
    join, joined = made()
    for stamp in range(100, 120):
        put(join, "a", stamp)
    for topic in TOPICS:
        put(join, topic, 3)
    assert joined == [(3, 3, 3)]


def test_silent_topics_are_named() -> None:
    join, _ = made()
    assert join.silent() == ["a", "b", "c"]
    put(join, "b", 1)
    assert join.silent() == ["a", "c"]


def test_as_many_stamps_wait_as_it_is_told() -> None:
    joined = Joined()
    join = StampJoin(TOPICS, joined, depth=100)
    for stamp in range(101):
        put(join, "a", stamp)
        put(join, "b", stamp)
    put(join, "c", 1)
    put(join, "c", 0)
    assert joined == [(1,) * 3]


def test_where_nothing_joins_any_more_it_says_so_until_something_does() -> None:
    join, joined = made()
    for stamp in range(100):
        put(join, "a", stamp)
        put(join, "b", stamp)
    assert not join.is_apart  # nothing came on the third: it may be slow
    for stamp in range(200, 210):
        assert not join.is_apart
        put(join, "c", stamp)
    assert join.is_apart
    for topic in TOPICS:
        put(join, topic, 300)
    assert joined == [(300,) * 3] and not join.is_apart
