"""The picture of what was found."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from outlines import PARALLEL, blank_pair, disc, seen
from rigs import SIZE_PX

from stereo_pick.core.annotation import annotate
from stereo_pick.core.arrays import Image
from stereo_pick.core.correspondence.feature import Feature
from stereo_pick.core.poses import estimate_poses
from stereo_pick.core.refusal import Refusal
from stereo_pick.core.triangulation import Triangulator

PAIR = blank_pair()
BLOBS = seen([disc(200, 150), disc(400, 300)], [disc(110, 150)])
FOUND = Feature().match(PAIR, BLOBS)


def greenness(picture: Image, x: int, y: int) -> int:
    """Green less red of the outline that passes within a pixel of this place."""
    near = picture[y - 1 : y + 2, x - 1 : x + 2].reshape(-1, 3).astype(int)
    stands_out = near[np.abs(near - 50).max(axis=1).argmax()]
    return int(stands_out[1] - stands_out[2])


def test_both_views_stand_side_by_side() -> None:
    assert annotate(PAIR, BLOBS, FOUND).shape == (SIZE_PX[1], 2 * SIZE_PX[0], 3)


def test_what_was_found_is_green_and_what_was_refused_is_red() -> None:
    picture = annotate(PAIR, BLOBS, FOUND)
    assert greenness(picture, 200, 130) > 50 and greenness(picture, SIZE_PX[0] + 110, 130) > 50
    assert greenness(picture, 400, 280) < -50


def test_of_the_other_polarity_only_what_was_found_is_drawn() -> None:
    """The rest are shadows and prints."""
    only_dark = replace(seen([], []), others=seen([disc(200, 150), disc(500, 100)], [disc(110, 150)]))
    plain, picture = annotate(PAIR, seen([], []), FOUND), annotate(PAIR, only_dark, FOUND)
    assert greenness(picture, 200, 130) > 50
    np.testing.assert_array_equal(picture[70:130, 470:530], plain[70:130, 470:530])


def test_positions_are_written_where_there_are_some() -> None:
    poses = estimate_poses(Triangulator().triangulate(FOUND, PARALLEL), FOUND, PARALLEL, 0)
    assert len(poses) == 1
    assert not np.array_equal(annotate(PAIR, BLOBS, FOUND, poses), annotate(PAIR, BLOBS, FOUND))


def test_what_is_refused_once_its_position_is_known_is_red_and_has_no_number() -> None:
    poses = estimate_poses(Triangulator(min_confidence=1.0).triangulate(FOUND, PARALLEL), FOUND, PARALLEL, 0)
    sure = annotate(PAIR, BLOBS, FOUND, poses)
    unsure = annotate(PAIR, BLOBS, FOUND, poses.confident(PARALLEL))
    assert greenness(sure, 200, 130) > 50 and greenness(unsure, 200, 130) < -50
    np.testing.assert_array_equal(unsure[250:350], sure[250:350])  # another object, refused in both


def test_what_was_found_where_its_outline_was_refused_keeps_its_number() -> None:
    again = replace(FOUND, refused=(*FOUND.refused, Refusal("merged", FOUND.left_px[0], FOUND.right_px[0])))
    poses = estimate_poses(Triangulator().triangulate(again, PARALLEL), again, PARALLEL, 0)
    row = annotate(PAIR, BLOBS, again, poses)[150, 260:600]  # the line that joins both views
    assert len(poses) == 1 and (row != 50).any(axis=1).all()


def test_the_pair_stays_as_it_is() -> None:
    before = PAIR.left.tobytes(), PAIR.right.tobytes()
    annotate(PAIR, BLOBS, FOUND)
    assert (PAIR.left.tobytes(), PAIR.right.tobytes()) == before
