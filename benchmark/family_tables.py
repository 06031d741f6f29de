"""The tables of the families of scenes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence

import numpy as np
from family_scoring import WRONG_M, SceneScore
from formatting import Row, markdown_table
from mahalanobis import CHI2_ROW, HEADER, distribution_row

Column = tuple[str, Callable[[Sequence[SceneScore]], str]]


def detection_table(scores: Sequence[SceneScore]) -> str:
    """What was found, missed and invented."""
    columns: list[Column] = [
        ("scenes", lambda of: str(len(of))),
        ("wholly right", lambda of: str(sum(each.right for each in of))),
        ("required", lambda of: str(sum(each.required for each in of))),
        ("found", lambda of: str(sum(each.required - len(each.missed) for each in of))),
        ("missed", lambda of: str(sum(len(each.missed) for each in of))),
        ("ghosts", lambda of: str(sum(len(each.ghosts_m) for each in of))),
        ("between parts", lambda of: str(sum(each.between for each in of))),
        ("> 5 mm wrong", lambda of: str(sum(each.wrong for each in of))),
        ("refused", lambda of: _reasons(of)),
    ]
    return _table(scores, columns)


def accuracy_table(scores: Sequence[SceneScore]) -> str:
    """Errors [mm] of the required objects that were found."""
    columns: list[Column] = [
        ("ΔZ mean", lambda of: _mm(np.mean, _depths(of))),
        ("max", lambda of: _mm(np.max, _depths(of))),
        ("position median", lambda of: _mm(np.median, _distances(of))),
        ("mean", lambda of: _mm(np.mean, _distances(of))),
        ("max", lambda of: _mm(np.max, _distances(of))),
    ]
    return _table(scores, columns)


def size_table(scores: Sequence[SceneScore]) -> str:
    """Size [mm], yaw [degrees], and time."""
    columns: list[Column] = [
        ("length mean", lambda of: _mm(np.mean, _sizes(of, 0))),
        ("max", lambda of: _mm(np.max, _sizes(of, 0))),
        ("width mean", lambda of: _mm(np.mean, _sizes(of, 1))),
        ("max", lambda of: _mm(np.max, _sizes(of, 1))),
        ("height mean", lambda of: _mm(np.mean, _sizes(of, 2))),
        ("max", lambda of: _mm(np.max, _sizes(of, 2))),
        ("yaw median", lambda of: _number(np.median, _yaws_deg(of), 2)),
        ("max", lambda of: _number(np.max, _yaws_deg(of), 1)),
        ("ms a pair, median", lambda of: f"{np.median([each.seconds for each in of]) * 1000:.1f}"),
    ]
    return _table(scores, columns)


def covariance_table(scores: Sequence[SceneScore]) -> str:
    """Squared Mahalanobis distances of all poses that were published, beside chi-square."""
    rows: list[Row] = [
        (family, *distribution_row([square for each in of for square in each.mahalanobis2]))
        for family, of in by_family(scores)
    ]
    return markdown_table(("family", *HEADER), [("chi-square, 3 degrees of freedom", *CHI2_ROW), *rows])


def shape_table(scores: Sequence[SceneScore]) -> str:
    """The same by the shape of the part, and how many are wrong."""
    found = [each for score in scores for each in score.found]
    rows = []
    for shape in sorted({each.shape for each in found}):
        some = [each for each in found if each.shape == shape]
        wrong = sum(each.distance_m > WRONG_M for each in some)
        rows.append((shape, *distribution_row([each.mahalanobis2 for each in some])[:-1], str(wrong)))
    return markdown_table(("shape", *HEADER[:-1], "> 5 mm wrong"), rows)


def failed_scenes(scores: Iterable[SceneScore]) -> str:
    """The scenes that are not wholly right, and what is wrong with each."""
    return "\n".join(
        f"{each.family} {each.seed}: missed {each.missed}, ghosts {len(each.ghosts_m)}, "
        f"wrong {[found.which for found in each.found if found.distance_m > WRONG_M]}, refused {dict(each.refused)}"
        for each in scores
        if not each.right
    )


def by_family(scores: Sequence[SceneScore]) -> list[tuple[str, Sequence[SceneScore]]]:
    """The scores family by family, and where there are several, all of them at last."""
    names = dict.fromkeys(each.family for each in scores)
    apart: list[tuple[str, Sequence[SceneScore]]] = [
        (name, [each for each in scores if each.family == name]) for name in names
    ]
    return [*apart, ("all", scores)] if len(names) > 1 else apart


def _table(scores: Sequence[SceneScore], columns: Sequence[Column]) -> str:
    rows = [(family, *(cell(of) for _, cell in columns)) for family, of in by_family(scores)]
    return markdown_table(("family", *(name for name, _ in columns)), rows)


def _depths(scores: Iterable[SceneScore]) -> list[float]:
    return [depth for each in scores for depth in each.depths_m]


def _distances(scores: Iterable[SceneScore]) -> list[float]:
    return [distance for each in scores for distance in each.distances_m]


def _sizes(scores: Iterable[SceneScore], axis: int) -> list[float]:
    return [abs(float(found.size_m[axis])) for each in scores for found in each.found if found.size_m is not None]


def _yaws_deg(scores: Iterable[SceneScore]) -> list[float]:
    return [abs(float(np.rad2deg(f.yaw_rad))) for each in scores for f in each.found if f.yaw_rad is not None]


def _reasons(scores: Iterable[SceneScore]) -> str:
    total: Counter[str] = sum((each.refused for each in scores), Counter())
    return ", ".join(f"{count} {reason}" for reason, count in total.most_common()) or "–"


def _mm(of: Callable[[list[float]], float], values_m: list[float]) -> str:
    return _number(of, [1000 * value for value in values_m], 3)


def _number(of: Callable[[list[float]], float], values: list[float], places: int) -> str:
    return f"{of(values):.{places}f}" if values else "–"
