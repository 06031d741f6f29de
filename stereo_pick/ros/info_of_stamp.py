"""One camera's camera_info, found again by the stamp of the image that it came with."""

from __future__ import annotations

from sensor_msgs.msg import CameraInfo

from stereo_pick.ros.messages.stamps import stamp_ns

_DEPTH = 20


class InfoOfStamp:
    """Keeps camera_info until its image comes; drivers that stamp it otherwise give the latest one.

    It is given away once only: in a replay that starts over, the same stamp may come with another calibration.
    """

    def __init__(self) -> None:
        self._by_stamp: dict[int, CameraInfo] = {}
        self._misses = _DEPTH  # since the last image whose stamp was that of a camera_info
        self.latest: CameraInfo | None = None

    def add(self, message: CameraInfo) -> None:
        """Take a message."""
        self.latest = message
        self._by_stamp[stamp_ns(message.header.stamp)] = message
        if len(self._by_stamp) > _DEPTH:
            del self._by_stamp[next(iter(self._by_stamp))]

    def awaits(self, stamp: int) -> bool:
        """Whether that of this image's stamp should still come: it is not here, but those of others had theirs."""
        return self.latest is None or (self._stamps_match() and stamp not in self._by_stamp)

    def take(self, stamp: int) -> CameraInfo | None:
        """That of this stamp [ns]; else the latest where stamps never match, or None where this one was lost."""
        found = self._by_stamp.pop(stamp, None)
        self._misses = 0 if found is not None else self._misses + 1
        return found or (None if self._stamps_match() else self.latest)

    def _stamps_match(self) -> bool:
        return self._misses < _DEPTH
