"""What `stereo-pick run` waits for, by a clock of the test's own."""

from __future__ import annotations

import threading
from types import SimpleNamespace

import pytest

from stereo_pick.cli import run
from stereo_pick.cli.chain import Chain
from stereo_pick.cli.monitor import Monitor
from stereo_pick.core.errors import SourceError


class Late(Monitor):
    """A subscriber to whom the poses of one captured pair come at some time, if ever."""

    def __init__(self, at_s: float, errors: tuple[str, ...] = ()) -> None:
        self.now_s = 0.0
        self._at_s = at_s
        self.count, self.captured, self.errors = 0, 1, list(errors)

    def spin(self, seconds: float) -> None:
        self.now_s += seconds
        self.count = int(self.now_s >= self._at_s)


class Statuses(Chain):
    """Processes with these exit statuses, None of one that runs."""

    def __init__(self, **statuses: int | None) -> None:
        super().__init__()
        self._processes = {
            name: SimpleNamespace(poll=lambda status=status: status) for name, status in statuses.items()
        }


def waited_s(monitor: Late, chain: Chain, monkeypatch: pytest.MonkeyPatch) -> float:
    monkeypatch.setattr(run, "time", SimpleNamespace(monotonic=lambda: monitor.now_s))
    run._follow(chain, monitor, "capture", threading.Event())
    return monitor.now_s


@pytest.mark.parametrize("status", [0, 1])
def test_poses_that_come_late_are_waited_for_whether_or_not_the_recording_broke_off(
    status: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monitor = Late(at_s=5.0)
    assert waited_s(monitor, Statuses(capture=status, correspondence=None), monkeypatch) == pytest.approx(6, abs=0.2)
    assert monitor.count == 1


def test_poses_that_nothing_can_send_or_that_a_node_has_told_of_are_not_waited_for_long(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert waited_s(Late(1e9), Statuses(capture=1, correspondence=0), monkeypatch) < 2
    assert waited_s(Late(1e9, ("too dark",)), Statuses(capture=0, correspondence=None), monkeypatch) < 2
    assert waited_s(Late(1e9), Statuses(capture=0, correspondence=None), monkeypatch) < 15


def test_what_keeps_nodes_apart_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    class Alone(Late):
        def downstream_is_up(self) -> bool:
            return False

    monitor = Alone(1e9)
    monkeypatch.setattr(run, "time", SimpleNamespace(monotonic=lambda: monitor.now_s))
    monkeypatch.setattr(run, "DOWNSTREAM", ())
    for name, value in (("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF"), ("ROS_DISCOVERY_SERVER", "10.0.0.1:11811")):
        monkeypatch.setenv(name, value)
    set_ones = "ROS_AUTOMATIC_DISCOVERY_RANGE=OFF, ROS_DISCOVERY_SERVER=10.0.0.1:11811"
    with pytest.raises(SourceError, match=f"no way to each other within 20 s: does {set_ones} keep them apart, or"):
        run._start_downstream(Statuses(), monitor, {}, threading.Event())
