"""Messages of several topics that belong together by their stamp."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from stereo_pick.ros.messages.stamps import stamp_ns

DEPTH = 10
_APART = 10  # messages on each topic


class StampJoin:
    """Calls back with one message of each topic as soon as all of one stamp are there.

    The package's own nodes stamp what belongs together alike, so only equal stamps join. Of what waits in vain the
    first to come is forgotten first, not the lowest stamp: a replay that starts over has lower stamps again.
    depth: how many stamps wait.
    """

    def __init__(self, topics: Sequence[str], joined: Callable[[dict[str, Any]], None], depth: int = DEPTH) -> None:
        self._topics = tuple(topics)
        self._joined = joined
        self._depth = depth
        self._waiting: dict[int, dict[str, Any]] = {}
        self.counts = dict.fromkeys(self._topics, 0)
        self._since = dict.fromkeys(self._topics, 0)  # the last join

    def add(self, topic: str, message: Any) -> None:
        """Take a message; may call back."""
        self.counts[topic] += 1
        self._since[topic] += 1
        stamp = stamp_ns(message.header.stamp)
        together = self._waiting.setdefault(stamp, {})
        together[topic] = message
        if len(together) == len(self._topics):
            del self._waiting[stamp]
            self._since = dict.fromkeys(self._topics, 0)
            self._joined(together)
        while len(self._waiting) > self._depth:
            del self._waiting[next(iter(self._waiting))]

    @property
    def is_apart(self) -> bool:
        """Whether nothing joins any more, although messages come on all topics."""
        return min(self._since.values()) >= _APART

    def silent(self) -> list[str]:
        """The topics on which nothing came so far."""
        return [topic for topic, count in self.counts.items() if count == 0]
