"""Collecting views out of pairs that come one after the other, and the picture of what is still missing."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from board_bags import BOARD, GREY, Pairs, rendered_pairs

from stereo_pick.core.calibration.collecting import Collector, Pace, timed_pair
from stereo_pick.core.calibration.guidance import guide
from stereo_pick.core.calibration.guidance_picture import guidance_picture
from stereo_pick.core.errors import CalibrationError


@pytest.fixture(scope="module")
def pairs(render_board) -> Pairs:
    return rendered_pairs(render_board)


def collected(pairs: Pairs) -> Collector:
    collector = Collector(BOARD)
    for i, pair in enumerate(pairs):
        collector.look(timed_pair(0.2 * i, *pair))
    return collector


def test_keeps_the_pairs_that_show_the_board(pairs: Pairs) -> None:
    collector = collected([(GREY, GREY), *pairs[:3], (pairs[3][0], GREY)])
    assert (collector.looked_at, collector.shown) == (5, 3)
    assert [pair.name for pair in collector.images()] == ["pair at 0.20 s", "pair at 0.40 s", "pair at 0.60 s"]
    assert [view.name for view in collector.views] == [pair.name for pair in collector.images()]
    np.testing.assert_array_equal(collector.images()[0].left, pairs[0][0])


def test_no_search_in_vain_is_made_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    searched, search = list[int](), cv2.findChessboardCorners

    def counted(*args: object, **options: object) -> object:
        searched.append(1)
        return search(*args, **options)

    monkeypatch.setattr(cv2, "findChessboardCorners", counted)
    collected([(GREY, GREY)])
    assert len(searched) == 1


def test_nothing_kept_says_what_to_check() -> None:
    with pytest.raises(CalibrationError, match="no chessboard of 7x5 inner corners .* any of 2 pairs: count"):
        collected([(GREY, GREY)] * 2).images()


def test_another_size_is_refused_and_the_rest_kept(pairs: Pairs) -> None:
    collector = collected(pairs[:2])
    with pytest.raises(CalibrationError, match="left at 9.00 s is 320 x 200, but left at 0.00 s is 320 x 240"):
        collector.look(timed_pair(9, GREY[:200], GREY[:200]))
    assert (collector.looked_at, len(collector.images())) == (2, 2)


def test_the_size_of_images_without_a_board_binds_no_others(pairs: Pairs) -> None:
    """As of the first image of a driver that is set up only then: all others were refused until a restart."""
    collector = collected([(GREY[:200], GREY[:200]), pairs[0]])
    assert (collector.looked_at, collector.shown) == (2, 1)
    with pytest.raises(CalibrationError, match="right at 9.00 s is 320 x 200, but left at 9.00 s is 320 x 240"):
        Collector(BOARD).look(timed_pair(9, GREY, GREY[:200]))


def test_pace_takes_ten_pairs_a_second_and_begins_anew_with_a_replay() -> None:
    pace = Pace()
    taken = [stamp for stamp in range(0, 10**9, 33_000_000) if pace.takes(stamp)]
    assert len(taken) == 8
    assert min(np.diff(taken)) >= 100_000_000
    assert pace.takes(0)


def test_the_picture_marks_corners_and_empty_parts(pairs: Pairs) -> None:
    collector = collected(pairs[:1])
    (view,) = collector.views
    guidance = guide(collector.views, (320, 240), BOARD)
    pair = timed_pair(0, *(cv2.resize(picture, (1280, 960)) for picture in pairs[0]))
    assert guidance_picture(pair, None, (), guidance).shape == (480, 1280, 3)
    plain = guidance_picture(timed_pair(0, GREY, GREY), None, (), guidance)
    assert plain.shape == (240, 640, 3)
    drawn = guidance_picture(timed_pair(0, GREY, GREY), view, collector.views, guidance)
    for shift, corners_px in ((0, view.left_px), (320, view.right_px)):
        x, y = np.rint(corners_px[-1]).astype(int)
        blue, green, red = drawn[y, x + shift].tolist()
        assert green > max(blue, red) + 50
        np.testing.assert_array_equal(plain[y, x + shift], [128, 128, 128])
    row, column = np.argwhere(guidance.right_empty)[-1]
    blue, green, red = plain[int((row + 0.9) * 80), 320 + int((column + 0.5) * 320 / 3)].tolist()
    assert red > green
    assert red > blue
