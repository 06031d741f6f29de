"""What `run` hears of the nodes."""

from __future__ import annotations

from pathlib import Path

import pytest
from recordings import DEMO_BAG
from ros_tools import Graph, environment, reserved_domain, stereo_pick

from stereo_pick.cli.monitor import Monitor
from stereo_pick.ros.messages.diagnostics import ERROR, OK, PAIRS, Status, diagnostics_message
from stereo_pick.ros.topics import DIAGNOSTICS


def test_it_hears_its_own_chain_and_no_other_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    """Errors of another namespace's nodes were printed as those of the run, and its pairs were counted."""
    with reserved_domain() as domain:
        monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
        graph, failed = Graph(domain), list[str]()
        publisher = graph.publisher(DIAGNOSTICS)
        monitor = Monitor(lambda *_: None, failed.append)
        told = {
            "cell1/rectification": Status(ERROR, "the other cell's camera is dead"),
            "cell1/capture": Status(OK, "finished", {PAIRS: "99"}),
            "calibration": Status(ERROR, "no image"),
            "capture": Status(OK, "finished", {PAIRS: "3"}),
            "rectification": Status(ERROR, "its own"),
        }

        def heard() -> bool:
            for name, status in told.items():
                publisher.publish(diagnostics_message(f"stereo_pick: {name}", status, 0))
            for _ in told:
                monitor.spin(0.02)
            return bool(failed)

        try:
            graph.wait(heard, "its own error")
            assert (failed, monitor.captured) == (["its own"], 3)
        finally:
            monitor.close()
            graph.close()


def test_run_says_why_ros_does_not_start(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    for name, value in (("ROS_DOMAIN_ID", "cell"), ("ROS_LOG_DIR", str(tmp_path / "file" / "log"))):
        error = stereo_pick("run", "--source", DEMO_BAG, env=environment(0) | {name: value}).error
        assert "ROS 2 does not start (failed to initialize" in error
        assert "or the environment (ROS_DOMAIN_ID, ROS_LOG_DIR)" in error


def test_a_domain_that_dds_does_not_have_is_named() -> None:
    """Fast DDS ends the process, with lines of its own."""
    done = stereo_pick("run", "--source", DEMO_BAG, env=environment(233))
    assert done.error == "stereo-pick: error: ROS_DOMAIN_ID = 233 is outside its range 0 .. 232"
    assert done.stdout == ""
