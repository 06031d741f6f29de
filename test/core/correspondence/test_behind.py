"""Parts that stand behind others, in rendered scenes with exact truth."""

from __future__ import annotations

import pytest
from families import staged
from family_scoring import score
from marks import first_of

from stereo_pick.core.pipeline import Pipeline, Steps

SEEN_LESS_OF = (79, 51, 101)  # the outline of what is behind has the front one's edge, too
MERGED_IN_ONE_VIEW = (69, 87, 92)  # ... and of the front one the light shows other pieces in the other view
LONGER_BY_WHAT_IS_HIDDEN = (15, 80)


@pytest.mark.parametrize(
    "seed", [*first_of(*SEEN_LESS_OF), *first_of(*MERGED_IN_ONE_VIEW), *first_of(*LONGER_BY_WHAT_IS_HIDDEN)]
)
def test_what_another_hides_a_part_of_is_found_where_it_is(seed: int) -> None:
    scene = staged("occluded", seed)
    result = score("occluded", seed, Pipeline(scene.rig, Steps()), *scene.taken())
    assert len(result.missed) == 0 and len(result.ghosts_m) == 0
    assert max(each.distance_m for each in result.found) < 1.5e-3


def test_a_piece_of_one_and_the_whole_of_another_are_no_third() -> None:
    """A notch in the shade was cut, and the piece below it matched with a box: both were lost."""
    scene = staged("light_differences", 9)
    result = score("light_differences", 9, Pipeline(scene.rig, Steps()), *scene.taken())
    assert result.right
