"""The tables of accuracy, time, refusals and stated uncertainty."""

from __future__ import annotations

import statistics
from collections import Counter
from collections.abc import Sequence

import numpy as np
from formatting import Row, decimals, markdown_table, mean_and_max
from rivals import FEATURE, SSD, Contender
from scenes import GROUPS
from scoring import Score, of

_NONE = "–"
_PACKAGE = (FEATURE, SSD)
_HARD_SCENES_APART = (
    "table_3_14/", "table_3_16/", "light/low_contrast", "light/right_gain", "light/side_light",
    "touching/box_and_cylinder", "touching/three_in_contact", "touching/two_in_left", "ambiguous/four_identical",
    "ambiguous/one_view_only", "many/", "empty/", "sequence/",
)  # fmt: skip
_COLUMNS = (
    "found / required", "ghosts", "refusals", "mm from centre of volume", "mm from the point it means",
    "mm error of depth differences", "ms a pair", "× `feature`",
)  # fmt: skip


def summary_table(scores: Sequence[Score], contenders: Sequence[Contender]) -> str:
    """Every contender over all scenes."""
    return markdown_table(
        ["method", "point it means", *_COLUMNS],
        [[contender.name, contender.meant, *_row(scores, contender.name, "")] for contender in contenders],
    )


def group_table(scores: Sequence[Score], contenders: Sequence[Contender], group: str) -> str:
    """Every contender in one group of scenes."""
    rows = [[contender.name, *_row(scores, contender.name, group)] for contender in contenders]
    return markdown_table([f"`{group}`", *_COLUMNS], rows)


def refusal_table(scores: Sequence[Score]) -> str:
    """What the package found and what it refused, and why; the hard groups scene by scene."""
    header = ["scenes"]
    for name in _PACKAGE:
        header += [f"{name}: found", "worst mm", "refused"]
    rows = []
    for prefix in _HARD_SCENES_APART:
        cells = [prefix.rstrip("/")]
        for name in _PACKAGE:
            cells += _found_and_refused([s for s in of(scores, name) if s.scene.name.startswith(prefix)])
        rows.append(cells)
    return markdown_table(header, rows)


def uncertainty_table(scores: Sequence[Score]) -> str:
    """The error in Z of the package's positions, against the point that they mean, beside the sigma that they state."""
    header = [
        "method, group", "positions", "mean error in Z mm (– is towards the cameras)", "rms error in Z mm",
        "stated σ of Z mm, median", "within 2 σ",
    ]  # fmt: skip
    rows = []
    for name in _PACKAGE:
        for group in GROUPS:
            row = _uncertainty(of(scores, name, group))
            if row:
                rows.append([f"{name} {group}", *row])
    return markdown_table(header, rows)


def _row(scores: Sequence[Score], contender: str, group: str) -> Row:
    own, reference = of(scores, contender, group), of(scores, FEATURE, group)
    hits = [hit for score in own for hit in score.hits]
    ratio = statistics.median(one.seconds / other.seconds for one, other in zip(own, reference))
    return [
        f"{len(hits)} / {sum(score.required for score in own)}",
        str(sum(score.ghosts for score in own)),
        str(sum(score.refused.total() for score in own)),
        mean_and_max(hit.error_mm for hit in hits),
        mean_and_max(float(np.linalg.norm(error)) for score in own for error, _ in score.placed),
        mean_and_max(abs(depth.calculated_m - depth.actual_m) * 1000 for score in own for depth in score.depths),
        decimals(statistics.median(score.seconds for score in own) * 1000, 1),
        decimals(ratio, 1),
    ]


def _found_and_refused(scores: Sequence[Score]) -> Row:
    reasons: Counter[str] = sum((score.refused for score in scores), Counter())
    errors_mm = [float(np.linalg.norm(error)) for score in scores for error, _ in score.placed]
    return [
        f"{sum(len(score.hits) for score in scores)} / {sum(score.required for score in scores)}",
        decimals(max(errors_mm), 2) if errors_mm else _NONE,
        ", ".join(f"{count} `{reason}`" for reason, count in reasons.most_common()) or _NONE,
    ]


def _uncertainty(scores: Sequence[Score]) -> Row:
    placed = [item for score in scores for item in score.placed]
    if not placed:
        return []
    error = np.array([error[2] for error, _ in placed])
    sigma = np.array([sigma for _, sigma in placed])
    return [
        str(len(placed)),
        f"{error.mean():+.2f}".replace("-", "−"),
        decimals(float(np.sqrt((error**2).mean())), 2),
        decimals(float(np.median(sigma)), 2),
        f"{100 * (np.abs(error) <= 2 * sigma).mean():.0f} %",
    ]
