"""A board looked for in a recording of stereo pairs, by every detector."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from stereo_pick.core.arrays import Image
from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.board_size import goes_on
from stereo_pick.core.calibration.boards import Chessboard
from stereo_pick.core.calibration.detectors import SeenCorners, board_view, finders
from stereo_pick.core.calibration.views import BoardView, Detections, RejectedView
from stereo_pick.core.errors import CalibrationError

_NAMED_FILES = 6


@dataclass(frozen=True, eq=False)
class BoardImages:
    """One raw pair: grey images (H, W) uint8, and what messages call the pair and each image."""

    name: str
    left_name: str
    right_name: str
    left: Image
    right: Image

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height [px] of the left image."""
        return self.left.shape[1], self.left.shape[0]


def detect(pairs: Iterable[BoardImages], board: Board) -> list[Detections]:
    """Look for the board in both images of each pair; returns what each detector found.

    Takes the pairs one by one, so that they need not all be in memory. Raises CalibrationError where
    the images differ in size, where no detector finds the board in both images of any pair, or where most images show
    a larger chessboard.
    """
    first: BoardImages | None = None
    looks = finders(board)
    outcomes: dict[str, list[BoardView | RejectedView]] = {name: [] for name in looks}
    names, larger = list[str](), dict[str, bool]()
    for pair in pairs:
        first = first or pair
        check_size(pair, first)
        names += [pair.left_name, pair.right_name]
        for name, find in looks.items():
            left, right = find(pair.left), find(pair.right)
            outcomes[name].append(_outcome(pair, board, left, right))
            for image, picture, corners in ((pair.left_name, pair.left, left), (pair.right_name, pair.right, right)):
                if corners is not None:
                    larger[image] = larger.get(image, False) or _goes_on(picture, corners, board)
    _check_board(larger, board)
    if first is None:
        raise CalibrationError("there are no image pairs to look for a board in")
    found = [_detections(name, first.size_px, outcome) for name, outcome in outcomes.items()]
    if not any(detections.views for detections in found):
        more = f" and {len(names) - _NAMED_FILES} more" if len(names) > _NAMED_FILES else ""
        where = f"{', '.join(names[:_NAMED_FILES])}{more}"
        raise CalibrationError(f"no {board.title} found in both images of any pair ({where}): {board.advice}")
    return found


def _check_board(larger: Mapping[str, bool], board: Board) -> None:
    """Raise CalibrationError where most of the images in which the board was found show a larger one."""
    files = [name for name, shows in larger.items() if shows]
    if 2 * len(files) > len(larger):
        raise CalibrationError(
            f"{files[0]} shows more than a {board.title}: its squares go on beyond them, in {len(files)} of the "
            f"{len(larger)} images in which they were found; {board.advice}"
        )


def _goes_on(picture: Image, corners: SeenCorners, board: Board) -> bool:
    return isinstance(board, Chessboard) and goes_on(picture, corners.px, board)


def _outcome(
    pair: BoardImages, board: Board, left: SeenCorners | None, right: SeenCorners | None
) -> BoardView | RejectedView:
    if left is not None and right is not None:
        return board_view(pair.name, left, right, board)
    without = [name for name, corners in ((pair.left_name, left), (pair.right_name, right)) if corners is None]
    return RejectedView(pair.name, f"no {board} board found in {' and '.join(without)}")


def _detections(detector: str, size_px: tuple[int, int], outcome: list[BoardView | RejectedView]) -> Detections:
    views = tuple(view for view in outcome if isinstance(view, BoardView))
    rejected = tuple(view for view in outcome if isinstance(view, RejectedView))
    return Detections(detector, size_px, views, rejected)


def check_size(pair: BoardImages, first: BoardImages) -> None:
    """Raise CalibrationError, naming the image, where the pair is not of the size of the first one."""
    width, height = first.size_px
    for name, picture in ((pair.left_name, pair.left), (pair.right_name, pair.right)):
        if picture.shape[:2] != (height, width):
            raise CalibrationError(
                f"{name} is {picture.shape[1]} x {picture.shape[0]}, but {first.left_name} is {width} x {height}: "
                "record all images, left and right, at one resolution"
            )
