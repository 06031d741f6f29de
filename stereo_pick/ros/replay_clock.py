"""When a recorded pair is due."""

from __future__ import annotations


class ReplayClock:
    """Maps recorded time to steady time; starts with the first pair that it is asked about."""

    def __init__(self, rate: float) -> None:
        self._rate = rate
        self._recorded_ns: int | None = None
        self._steady_ns = 0

    def until_ns(self, recorded_ns: int, now_ns: int) -> int:
        """Time from now until what was recorded at `recorded_ns` is due [ns]; not above 0 where it is due."""
        if self._recorded_ns is None:
            self._recorded_ns, self._steady_ns = recorded_ns, now_ns
        return round((recorded_ns - self._recorded_ns) / self._rate) - (now_ns - self._steady_ns)

    def set_rate(self, rate: float, now_ns: int) -> None:
        """Go on from where the replay stands, at another rate."""
        if self._recorded_ns is not None:
            self._recorded_ns += round((now_ns - self._steady_ns) * self._rate)
            self._steady_ns = now_ns
        self._rate = rate
