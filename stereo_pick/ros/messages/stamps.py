"""Headers and stamps."""

from __future__ import annotations

from builtin_interfaces.msg import Time
from std_msgs.msg import Header

_NS_PER_S = 1_000_000_000


def stamp_ns(stamp: Time) -> int:
    """A message's stamp [ns]."""
    return int(stamp.sec) * _NS_PER_S + int(stamp.nanosec)


def time_message(time_ns: int) -> Time:
    """The message of a time [ns]."""
    return Time(sec=time_ns // _NS_PER_S, nanosec=time_ns % _NS_PER_S)


def header(time_ns: int, frame_id: str) -> Header:
    """A header of a stamp [ns] and a frame."""
    return Header(stamp=time_message(time_ns), frame_id=frame_id)
