"""What outlines alone leave open, and the edges around them tell, in rendered scenes with exact truth."""

from __future__ import annotations

import pytest
from families import staged
from family_scoring import SceneScore, score

from stereo_pick.core.pipeline import Pipeline, Steps

A_PART_IS_LIT = [("glossy", 146, 4), ("bright_and_dark", 150, 0), ("low_contrast", 150, 4)]
MERGED_WITH_A_SHADOW = [("dark_on_light", 146, 0), ("dark_on_light", 151, 2), ("planks_and_prints", 158, 1)]
LIES_AMONG_ITS_SHADOWS = [("bright_and_dark", 150, 1), ("tubes", 147, 2), ("tubes", 19, 1)]


def found(family: str, seed: int) -> SceneScore:
    scene = staged(family, seed)
    return score(family, seed, Pipeline(scene.rig, Steps()), *scene.taken())


@pytest.mark.parametrize(("family", "seed", "which"), [*A_PART_IS_LIT, *MERGED_WITH_A_SHADOW, *LIES_AMONG_ITS_SHADOWS])
def test_what_was_refused_is_found_by_the_edges_around_it(family: str, seed: int, which: int) -> None:
    result = found(family, seed)
    assert {each.which: each.distance_m for each in result.found}[which] < 5e-4
    assert result.wrong == 0 and len(result.ghosts_m) == 0


def test_what_shows_nearly_all_of_its_silhouette_is_not_replaced_by_what_shows_less() -> None:
    """A lying cylinder whose end is as bright as the table; one 43 mm longer, behind another part, has that one's
    edges for its rim."""
    result = found("occluded", 151)
    assert len(result.missed) == 0 and max(each.distance_m for each in result.found) < 1e-3


@pytest.mark.parametrize("seed", [0, 3, 7])
def test_prints_have_nothing_around_them_that_stands(seed: int) -> None:
    result = found("labels", seed)
    assert len(result.ghosts_m) == 0 and result.refused["flat"] >= 1
