"""When a recorded pair is due."""

from __future__ import annotations

_CATCH_UP = 2.0  # times the rate: in a burst what listens would lose pairs


class ReplayClock:
    """Maps recorded time to steady time from the first pair on; where it was held up it catches up, but in no burst."""

    def __init__(self, rate: float) -> None:
        self._rate = rate
        self._recorded_ns: int | None = None
        self._steady_ns = 0
        self._published_ns: tuple[int, int] | None = None

    def until_ns(self, recorded_ns: int, now_ns: int) -> int:
        """Time from now until what was recorded at `recorded_ns` is due [ns]; not above 0 where it is due."""
        if self._recorded_ns is None:
            self._recorded_ns, self._steady_ns = recorded_ns, now_ns
        due_ns = self._steady_ns + round((recorded_ns - self._recorded_ns) / self._rate)
        if self._published_ns is not None:
            before_ns, then_ns = self._published_ns
            due_ns = max(due_ns, then_ns + round((recorded_ns - before_ns) / (_CATCH_UP * self._rate)))
        return due_ns - now_ns

    def published(self, recorded_ns: int, now_ns: int) -> None:
        """Take down that what was recorded at `recorded_ns` went out now."""
        self._published_ns = recorded_ns, now_ns

    def start_over(self, first_ns: int, period_ns: int) -> None:
        """Go on with what was recorded at `first_ns`, so much recorded time after what went out last."""
        if self._published_ns is not None:
            last_ns, then_ns = first_ns - period_ns, self._published_ns[1]
            self._recorded_ns, self._steady_ns = last_ns, then_ns
            self._published_ns = last_ns, then_ns

    def set_rate(self, rate: float, now_ns: int) -> None:
        """Go on from where the replay stands, at another rate."""
        if self._recorded_ns is not None:
            self._recorded_ns += round((now_ns - self._steady_ns) * self._rate)
            self._steady_ns = now_ns
        self._rate = rate
        self._published_ns = None
