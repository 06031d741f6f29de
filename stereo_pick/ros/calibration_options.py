"""The parameters of the calibration node."""

from __future__ import annotations

from dataclasses import dataclass

from stereo_pick.core.errors import ParameterError
from stereo_pick.core.params import check_folder, parameter, path_of
from stereo_pick.core.rig import MAX_BASELINE_M
from stereo_pick.ros.raw_pairs import RawImageOptions


@dataclass(frozen=True)
class CalibrationOptions(RawImageOptions):
    """The board, where the files go, and how raw images are paired and read."""

    board: str = parameter(
        "", "The board: chessboard:9x6 (inner corners) or charuco:11x8:0.75:5X5_100 (squares).", fixed=True
    )
    square_m: float = parameter(0.0, "Side of one square, measured on the board.", low=0.0, high=1.0, fixed=True)
    output: str = parameter("", "Folder that `~/save` writes to; files in it are replaced.", fixed=True)
    baseline_m: float = parameter(
        0.0,
        "Distance of the two lenses, measured on the rig with a ruler; 0 where it was not.",
        low=0.0,
        high=MAX_BASELINE_M,
        fixed=True,
    )
    max_waiting: int = parameter(
        20, "How many pairs may wait to be looked at; of more, the oldest are left out.", low=1, high=1000, fixed=True
    )

    def check_chosen(self) -> None:
        """Raise ParameterError where something that nobody can guess was not given, or nothing could be saved."""
        if not self.board:
            raise ParameterError(
                "parameter board is empty: give chessboard:9x6 (inner corners) or charuco:11x8:0.75:5X5_100"
            )
        if not self.square_m:
            raise ParameterError("parameter square_m is 0: measure the side of one square, in metres")
        if not self.output:
            raise ParameterError("parameter output is empty: name the folder that ~/save writes to")
        check_folder(f"parameter output = {self.output}", path_of(self.output))
