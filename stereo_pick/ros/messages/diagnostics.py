"""diagnostic_msgs: how a node is doing, in one line and some values."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

from stereo_pick.ros.messages.stamps import time_message

OK, WARN, ERROR = (DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR)
PAIRS = "pairs"  # key of the value that counts them


@dataclass(frozen=True)
class Status:
    """One line, how bad it is (OK, WARN, ERROR), and values that explain it."""

    level: bytes
    message: str
    values: Mapping[str, str] = field(default_factory=dict)


def kind(message: str) -> str:
    """A status's line without its numbers: that only those have changed does not make it new."""
    return re.sub(r"[0-9.]+", "0", message)


def diagnostics_message(name: str, status: Status, now_ns: int) -> DiagnosticArray:
    """The message of one node's status."""
    message = DiagnosticStatus(
        level=status.level,
        name=name,
        message=status.message,
        hardware_id="stereo_pick",
        values=[KeyValue(key=key, value=value) for key, value in status.values.items()],
    )
    array = DiagnosticArray(status=[message])
    array.header.stamp = time_message(now_ns)
    return array
