"""What is found in the families of scenes, as Markdown: all tables, and the scenes they speak of."""

from __future__ import annotations

import platform
from collections.abc import Iterator, Sequence

import cv2
import numpy as np
from families import FAMILIES
from family_rivals import RivalScore, rivals_table
from family_scoring import WRONG_M, SceneScore
from family_tables import accuracy_table, covariance_table, detection_table, shape_table, size_table
from formatting import markdown_table
from reliability import reliability_table


def report(scores: Sequence[SceneScore], rivals: Sequence[RivalScore]) -> str:
    """All tables, each under its heading."""
    return "\n\n".join(_sections(scores, rivals))


def _sections(scores: Sequence[SceneScore], rivals: Sequence[RivalScore]) -> Iterator[str]:
    seeds, required = [each.seed for each in scores], sum(each.required for each in scores)
    found = required - sum(len(each.missed) for each in scores)
    published, wrong = sum(each.published for each in scores), sum(each.wrong for each in scores)
    unadmitted = sum(each.unadmitted for each in scores)
    yield (
        f"{len(scores)} scenes, seeds {min(seeds)} to {max(seeds)} of each family. Of {required} parts that must be "
        f"found, {found} are; of {published} positions that are published, {wrong} are more than {1000 * WRONG_M:g} mm "
        f"wrong, {unadmitted} of them by more than their covariance admits with 95 %. OpenCV {cv2.__version__}, NumPy "
        f"{np.__version__}, Python {platform.python_version()}, {platform.machine()}."
    )
    yield _families_table(scores)
    yield "### Found, missed, refused"
    yield (
        f"*Wrong* are published positions more than {1000 * WRONG_M:g} mm from the part's centre, ghosts among them; a "
        "scene is *right* where nothing is missed and nothing wrong. Refused are outlines, not parts."
    )
    yield detection_table(scores)
    yield "### Errors"
    yield "In mm, of the parts that must be found and were found: depth differences within a scene, and positions."
    yield accuracy_table(scores)
    yield "### The stated covariance"
    yield (
        "Squared Mahalanobis distances of all positions that were published, however wrong: parts that need not be "
        "found count, too, and a position that is no part's is infinitely far off."
    )
    yield covariance_table(scores)
    yield "The same of the parts of each shape, over all families:"
    yield shape_table(scores)
    yield "### Confidence"
    yield (
        "The confidence of the same positions, the probability by their covariance that they are within a tolerance, "
        "beside how many are: for several tolerances, by confidence."
    )
    yield reliability_table(scores)
    yield "### Size, orientation, time"
    yield "Errors in mm and in degrees of everything that was found and is a part's."
    yield size_table(scores)
    if rivals:
        yield "### Beside other methods"
        yield (
            "The scenes of some families that the thesis's rig sees. Here a part counts as found within 60 mm. "
            "Positions, and depths between them, are held against the point that the method means: the centre of the "
            "volume, or, where it finds the surface, the mean of what the left view shows of it. Errors in mm."
        )
        yield rivals_table(rivals)


def _families_table(scores: Sequence[SceneScore]) -> str:
    rows = [(family, (FAMILIES[family].__doc__ or "").strip()) for family in dict.fromkeys(s.family for s in scores)]
    return markdown_table(("family", "scene"), rows, words=True)
