"""The README's subscriber, run as written, receives the PoseArray."""

from __future__ import annotations

import re
import signal
import sys
from pathlib import Path

import pytest
from recordings import DEMO_RIG, Recording, demo_pairs
from ros_tools import System

from stereo_pick.core.calibration.files import load_rig

README = Path(__file__).parents[2] / "README.md"


def subscriber() -> str:
    """The first Python block after the heading about the controller."""
    if not README.is_file():
        pytest.skip("README.md is not written yet")
    match = re.search(r"^#+ [^\n]*controller[^\n]*\n.*?^```python\n(.*?)^```$", README.read_text(), re.M | re.S | re.I)
    assert match, "README.md has no ```python block under a heading about a controller"
    return match[1]


def test_the_subscriber_of_the_readme_receives_the_pose_array(system: System, tmp_path: Path) -> None:
    (tmp_path / "picker.py").write_text(subscriber())
    bag = Recording.of(load_rig(DEMO_RIG), *demo_pairs(2)).write(tmp_path / "bag")
    picker = system.start(sys.executable, "picker.py", cwd=tmp_path)
    nodes = system.start_node("stereo_pick", {"source": bag, "loop": True, "rate": 0.3})
    picker.wait_for_output("PoseArray")
    picker.wait_for_output("left_eye")
    assert picker.output.count("Point(") >= 4
    picker.end(signal.SIGINT)
    assert nodes.end(signal.SIGINT)[0] == 0


def test_the_subscriber_is_about_ten_lines_long() -> None:
    assert len([line for line in subscriber().splitlines() if line.strip()]) <= 12
