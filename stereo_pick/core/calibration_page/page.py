"""The whole page, for a calibration and for a recording that gave none."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from stereo_pick.core.calibration.any_board import Board
from stereo_pick.core.calibration.detection import BoardImages
from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration.verdict import Verdict, Word
from stereo_pick.core.calibration.views import Detections
from stereo_pick.core.calibration_page.accuracy import accuracy_section
from stereo_pick.core.calibration_page.coverage import coverage_figure, coverage_section
from stereo_pick.core.calibration_page.epipolar import epipolar_section
from stereo_pick.core.calibration_page.evidence import typical_view
from stereo_pick.core.calibration_page.markup import Markup, element, section, table
from stereo_pick.core.calibration_page.numbers import numbers_section
from stereo_pick.core.calibration_page.points import points_section
from stereo_pick.core.calibration_page.residuals import arrows_section, rejected_table, views_section
from stereo_pick.core.calibration_page.rig import rig_section
from stereo_pick.core.calibration_page.style import CSS
from stereo_pick.core.calibration_page.summary import board_text, summary_section, verdict_box

FILE_NAME = "calibration_report.html"


def calibration_page(
    result: CalibrationResult, verdict: Verdict, warnings: Sequence[str] = (), example: BoardImages | None = None
) -> str:
    """The page of a calibration, whatever its verdict.

    example: the images of `typical_view(result)`, for the epipolar lines; without them, or where they show no corner
    in common, that part is left out.
    """
    parts = [
        verdict_box(verdict, warnings),
        summary_section(result),
        accuracy_section(result),
        points_section(result),
        numbers_section(result),
        coverage_section(result),
        views_section(result),
        arrows_section(result),
        rig_section(result),
    ]
    view = typical_view(result).in_both()
    if example is not None and len(view.left_px):
        parts.append(epipolar_section(result.rig, view, example))
    return _page(parts)


def refusal_page(reason: str, board: Board, recordings: Sequence[Detections]) -> str:
    """The page of a recording that gave no calibration: the reason, and what the best detector found."""
    found = max(recordings, key=lambda each: len(each.views))
    none = np.zeros((0, 2))
    sides = [np.concatenate([none, *(getattr(view, side) for view in found.views)]) for side in ("left_px", "right_px")]
    facts = [("board", board_text(board)), ("corners found by", found.detector), ("pairs with a board", _count(found))]
    seen = [(view.name, f"{len(view.in_both().left_px)}") for view in found.views]
    return _page(
        [
            verdict_box(Verdict(Word.REFUSED, (reason,)), ()),
            section("What was found", table("The recording in short", ("", "value"), facts)),
            section("Coverage", coverage_figure(found.size_px, sides[0], sides[1])),
            section("Pairs", table("Corners found in both images", ("pair", "corners"), seen)),
            section("Left out", rejected_table(found.rejected) if found.rejected else element("p", "None.")),
        ]
    )


def save_page(page: str, folder: Path) -> Path:
    """Write calibration_report.html into `folder`, which is made where it is missing; returns its path."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / FILE_NAME
    path.write_text(page, encoding="utf-8")
    return path


def _count(found: Detections) -> str:
    return f"{len(found.views)} of {len(found.views) + len(found.rejected)}"


def _page(parts: Sequence[Markup]) -> str:
    title = "Stereo calibration report"
    head = element(
        "head",
        element("meta", charset="utf-8"),
        element("meta", name="viewport", content="width=device-width, initial-scale=1"),
        element("title", title),
        element("style", Markup(CSS)),
    )
    body = element("body", element("main", element("h1", title), *parts))
    return f"<!DOCTYPE html>\n{element('html', head, body, lang='en')}\n"
