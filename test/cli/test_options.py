"""Options that several commands share."""

from __future__ import annotations

import pytest

from stereo_pick.cli.main import main

COMMANDS = {
    "locate": ["left.png", "right.png", "--calibration", "rig"],
    "replay": ["bag"],
    "run": ["--source", "bag"],
    "background": ["--source", "bag", "--output", "b.npz"],
    "table": ["--source", "bag", "--board", "9x6", "--square", "0.03"],
    "calibrate": ["--bag", "bag", "--board", "9x6", "--square", "0.03", "--output", "rig"],
}


@pytest.mark.parametrize("value", [0, -5, 70000])
@pytest.mark.parametrize("command", COMMANDS)
def test_a_full_scale_of_no_16_bits_is_refused_whatever_the_images_are(
    command: str, value: int, capsys: pytest.CaptureFixture[str]
) -> None:
    """Images of 8 bits never ask for it, and nobody learned that the value was wrong."""
    assert main([command, *COMMANDS[command], "--full-scale-16", str(value)]) == 1
    said = capsys.readouterr().err
    assert said == f"stereo-pick: error: full_scale_16 = {value} is outside its range 1 .. 65535\n"
