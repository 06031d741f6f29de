"""The tables of scenes that were located with calibrations of their own."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from calibrated_scenes import Outcome
from family_scoring import SceneScore
from family_tables import by_family
from formatting import Row, decimals, markdown_table, mean_and_max
from mahalanobis import CHI2_ROW, HEADER, covered, distribution_row
from rendering.rigs import BENCH_RIGS, DISTANCES_M

from stereo_pick.core.arrays import Floats
from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration.verdict import judge


def report(outcomes: Sequence[Outcome]) -> str:
    """All tables."""
    with_true, with_own = ([each for each in outcomes if (each.calibration is None) == true] for true in (True, False))
    return "\n\n".join(
        [
            "Errors in mm of the objects that must be found, mean and max:",
            _error_table(with_true, with_own),
            "Squared Mahalanobis distances of all published positions. The true calibration has no part of its own in "
            "the covariance:",
            _covariance_table(with_true, with_own),
            "The calibrations, by the rig and by the distortion coefficients that they estimate; *left open* is what "
            "they state where the parts stand, one sigma, median:",
            _calibration_table(with_own),
        ]
    )


def _error_table(with_true: Sequence[Outcome], with_own: Sequence[Outcome]) -> str:
    header = ("family", "calibration", "found / required", "ghosts", "depth differences", "positions")
    rows = [
        (family, kind, _found(scores), str(sum(len(each.ghosts_m) for each in scores)), *_errors_mm(scores))
        for family, kind, scores in _in_turn(
            {"true": [each.whole for each in with_true], "own": [each.whole for each in with_own]}
        )
    ]
    return markdown_table(header, rows)


def _covariance_table(with_true: Sequence[Outcome], with_own: Sequence[Outcome]) -> str:
    said = {
        "true; image": [each.image for each in with_true],
        "own; image alone": [each.image for each in with_own],
        "own; image and calibration": [each.whole for each in with_own],
    }
    rows = [(family, kind, *distribution_row(_squares(scores))) for family, kind, scores in _in_turn(said)]
    header = ("family", "calibration; covariance", *HEADER)
    return markdown_table(header, [("chi-square, 3 degrees of freedom", "", *CHI2_ROW), *rows])


def _in_turn(kinds: Mapping[str, Sequence[SceneScore]]) -> Iterator[tuple[str, str, Sequence[SceneScore]]]:
    """Family by family, each kind's scores of it."""
    for families in zip(*(by_family(scores) for scores in kinds.values())):
        for kind, (family, scores) in zip(kinds, families):
            yield family, kind, scores


def _calibration_table(outcomes: Sequence[Outcome]) -> str:
    header = (
        "rig, coefficients", "calibrations", "verdicts", "rms px", "baseline off by mm, rms", "stated",
        "left open x, y, z mm", "depth differences", "positions", "d² < 7.81, image alone", "and calibration",
    )  # fmt: skip
    kinds: dict[str, list[Outcome]] = {}
    for each in outcomes:
        kinds.setdefault(f"{each.rig_name}, {each.result.solution.model.value}", []).append(each)
    return markdown_table(header, [(kind, *_calibration_row(some)) for kind, some in sorted(kinds.items())])


def _calibration_row(outcomes: Sequence[Outcome]) -> Row:
    results = {each.calibration: each.result for each in outcomes}.values()
    rig_name = outcomes[0].rig_name
    off_m = np.array([result.rig.baseline_m - BENCH_RIGS[rig_name].baseline_m for result in results])
    open_m = np.median([_left_open_m(result, rig_name) for result in results], axis=0)
    verdicts = Counter(judge(result).word.value for result in results)
    return (
        str(len(results)),
        ", ".join(f"{count} {word}" for word, count in verdicts.most_common()),
        decimals(float(np.mean([result.rms_px for result in results])), 3),
        decimals(1000 * float(np.sqrt(np.mean(off_m**2))), 3),
        decimals(1000 * float(np.median([result.baseline_sigma_m for result in results])), 3),
        ", ".join(decimals(1000 * sigma, 2) for sigma in open_m),
        *_errors_mm([each.whole for each in outcomes]),
        covered(_squares([each.image for each in outcomes])),
        covered(_squares([each.whole for each in outcomes])),
    )


def _left_open_m(result: CalibrationResult, rig_name: str) -> Floats:
    covariance = result.uncertainty.point_covariance([[0, 0, np.mean(DISTANCES_M[rig_name])]])[0]
    return np.asarray(np.sqrt(np.diag(covariance)))


def _found(scores: Sequence[SceneScore]) -> str:
    required = sum(each.required for each in scores)
    return f"{required - sum(len(each.missed) for each in scores)} / {required}"


def _errors_mm(scores: Sequence[SceneScore]) -> Row:
    """Of depth differences and of positions."""
    return (
        mean_and_max(1000 * depth for each in scores for depth in each.depths_m),
        mean_and_max(1000 * distance for each in scores for distance in each.distances_m),
    )


def _squares(scores: Sequence[SceneScore]) -> list[float]:
    return [square for each in scores for square in each.mahalanobis2]
