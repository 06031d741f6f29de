"""`stereo-pick board`: a file to print, or one clear sentence and no file."""

from __future__ import annotations

from pathlib import Path

import pytest

from stereo_pick.cli.main import main


def run(output: Path, board: str = "chessboard:9x6", square: str = "0.025", page: str = "a4") -> int:
    return main(["board", "--board", board, "--square", square, "--page", page, "--output", str(output)])


@pytest.mark.parametrize(("name", "begins"), [("board.svg", b"<?xml"), ("board.PDF", b"%PDF-1.4")])
def test_writes_a_file_and_says_how_to_print_it(
    tmp_path: Path, name: str, begins: bytes, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(tmp_path / name) == 0
    assert (tmp_path / name).read_bytes().startswith(begins)
    printed = capsys.readouterr().out
    assert "297 x 210 mm; print at 100 %" in printed
    assert "hint" not in printed


@pytest.mark.parametrize("board", ["8x6", "7x5"])
def test_a_board_with_two_ways_up_gets_a_hint(tmp_path: Path, board: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(tmp_path / "board.svg", board, square="0.02") == 0
    assert f"hint: {board} inner corners look the same turned by half" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"square": "0.03"}, "the page is 210 x 297 mm"),
        ({"square": "25"}, "give metres, 0.025"),
        ({"page": "a5"}, "page 'a5' is not understood"),
        ({"board": "charuco:11x8"}, "charuco:11x8:0.75:5X5_100"),
    ],
)
def test_what_cannot_be_printed_is_refused(
    tmp_path: Path, changed: dict[str, str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(tmp_path / "board.svg", **changed) == 1
    assert message in capsys.readouterr().err
    assert not (tmp_path / "board.svg").exists()


@pytest.mark.parametrize(("name", "message"), [("board.png", "neither .svg nor .pdf"), ("no/board.pdf", "cannot be")])
def test_output_that_cannot_be_is_refused(
    tmp_path: Path, name: str, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(tmp_path / name) == 1
    assert message in capsys.readouterr().err
