"""The report page: complete, well-formed, needing nothing else, and true to the result in every number."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from page_reading import Nesting, drawings, parsed, references, tables, words
from simulated_views import BOARD, RIG, SIZE_PX, make_views

from stereo_pick.core.calibration.charuco import CharucoBoard
from stereo_pick.core.calibration.detection import BoardImages
from stereo_pick.core.calibration.fingerprint import calibration_hash
from stereo_pick.core.calibration.parameters import NAMES
from stereo_pick.core.calibration.result import CalibrationResult
from stereo_pick.core.calibration.solving import calibrate
from stereo_pick.core.calibration.verdict import Verdict, Word, judge
from stereo_pick.core.calibration.views import BoardView, Detections, RejectedCorner, RejectedView
from stereo_pick.core.calibration_page.evidence import typical_view
from stereo_pick.core.calibration_page.page import calibration_page, refusal_page, save_page

HOSTILE = (
    "<script>alert(1)</script>.png",
    "\"onmouseover='alert(1)",
    "a&amp;b & c]]><!--",
    "</td></table><img src=http://example.org/x>",
    "x" * 300,
    "right\u202egnp.exe",
)
REJECTED = (RejectedView("pair_a", "no board found in left_a.png"), RejectedView("pair_b", "blurred: 3.2 px > 1 px"))


@cache
def result() -> CalibrationResult:
    return calibrate(make_views(9, noise_px=0.15), SIZE_PX, BOARD, rejected=REJECTED)


def images() -> BoardImages:
    grey = np.tile(np.linspace(0, 255, SIZE_PX[0]).astype(np.uint8), (SIZE_PX[1], 1))
    return BoardImages("any", "left", "right", grey, grey)


@cache
def page() -> str:
    return calibration_page(result(), judge(result()), ("mind the gap",), images())


def renamed(names: tuple[str, ...]) -> CalibrationResult:
    views = [BoardView(names[i % len(names)], v.left_px, v.right_px) for i, v in enumerate(result().views)]
    return replace(result(), views=tuple(views), rejected=tuple(RejectedView(name, name) for name in names))


def assert_shown(text: str, value: float) -> None:
    """The text is this value, rounded to the digits that it shows."""
    decimals = len(text.partition(".")[2])
    assert float(text) == pytest.approx(value, abs=0.5001 * 10**-decimals), (text, value)
    assert abs(float(text)) > 0 or abs(value) < 10**-decimals


@pytest.fixture(params=["result", "refused result", "no result"])
def any_page(request: pytest.FixtureRequest) -> str:
    if request.param == "result":
        return page()
    if request.param == "refused result":
        return calibration_page(result(), Verdict(Word.REFUSED, ("a < b",)))
    return refusal_page("both see the same", BOARD, [Detections("d", SIZE_PX, result().views, REJECTED)])


def test_is_well_formed(any_page: str) -> None:
    assert any_page.startswith("<!DOCTYPE html>")
    assert parsed(any_page).get("lang") == "en"
    assert Nesting(any_page).faults == []


def test_needs_nothing_else(any_page: str) -> None:
    root = parsed(any_page)
    assert all(reference.startswith("data:image/") for reference in references(root))
    assert {"script", "link", "iframe", "object", "embed", "base"}.isdisjoint({each.tag for each in root.iter()})
    assert not [name for each in root.iter() for name in each.attrib if name.startswith("on")]
    assert not re.search(r"https?:|url\(|@import", re.sub(r"data:image/[^\"]*", "", any_page))


def test_drawings_are_said_in_words(any_page: str) -> None:
    for alternative, svg in drawings(parsed(any_page)).items():
        assert svg.get("role") == "img"
        assert svg.find("title").text == alternative
        assert len(alternative) > 10


def test_headings_and_tables_are_named(any_page: str) -> None:
    root = parsed(any_page)
    assert len(list(root.iter("h1"))) == 1
    assert all(len(words(section.find("h2"))) > 2 for section in root.iter("section"))
    assert all(words(table.find("caption")) and table.findall("thead/tr/th") for table in root.iter("table"))


@pytest.mark.parametrize("word", list(Word))
def test_verdict_and_its_reasons_come_first(word: Word) -> None:
    root = parsed(calibration_page(result(), Verdict(word, ("first reason", "second <reason>")), ("a warning",)))
    heading, box, *_ = root.find("body/main")
    assert heading.tag == "h1"
    assert box.find("p/strong").text == word.value
    assert [item.text for item in box.iter("li")] == ["first reason", "second <reason>", "Warning: a warning"]


def test_residuals_are_the_results() -> None:
    rows = tables(parsed(page()))["Rms residuals, in the image and on the board"]
    alone = result().rms_left_px, result().rms_right_px
    for (side, *cells), name, of_camera, alone_px in zip(rows, ("left", "right"), result().residuals, alone):
        assert side == name
        mm = of_camera.x_m * 1000, of_camera.y_m * 1000, of_camera.distance_m * 1000
        for text, value in zip(cells, (of_camera.x_px, of_camera.y_px, *mm, alone_px), strict=True):
            assert_shown(text, value)
    assert f"in one rig: {result().rms_px:.3f} px" in words(parsed(page()))


def test_held_out_errors_are_the_results() -> None:
    (_, epipolar), (_, length) = tables(parsed(page()))["Rms errors of views that were held out"]
    assert_shown(epipolar.removesuffix(" px"), result().held_out.epipolar_rms_px)
    assert_shown(length.removesuffix(" mm"), result().held_out.length_rms_m * 1000)


def test_too_few_views_to_hold_out_are_said() -> None:
    few = calibrate(make_views(3, noise_px=0.1), SIZE_PX, BOARD)
    assert "Too few views to hold any out" in words(parsed(calibration_page(few, judge(few))))


def test_every_parameter_has_its_value_and_sigma() -> None:
    found = tables(parsed(page()))
    shown = dict[str, str]()
    for name, left, right in found["Cameras, ± one sigma"]:
        shown |= {f"left.{name}": left, f"right.{name}": right}
    pose = found["From the left to the right camera's frame: X' = R X + T, ± one sigma"]
    shown |= {name.replace("rotation vector", "rotation").replace(" ", "."): text for name, text in pose}
    assert set(shown) == set(NAMES)
    for name, value, sigma in zip(NAMES, result().uncertainty.parameters, result().uncertainty.sigma):
        factor, unit = {"r": (np.degrees(1), " deg"), "t": (1000, " mm")}.get(name[0], (1, ""))
        factor, unit = (1, "") if name.startswith("right") else (factor, unit)
        if sigma == 0:
            assert shown[name] == "0 (not estimated)"
        else:
            text, sigma_text = shown[name].removesuffix(unit).split(" ± ")
            assert_shown(text, value * factor)
            assert_shown(sigma_text, sigma * factor)
            assert float(sigma_text) == pytest.approx(sigma * factor, rel=0.06)


def test_point_sigmas_are_the_results() -> None:
    rows = tables(parsed(page()))["One sigma at the depths of the boards"]
    for row, expected in zip(rows, result().point_sigmas, strict=True):
        for text, value_m in zip(row, (expected.depth_m, expected.x_m, expected.y_m, expected.z_m), strict=True):
            assert_shown(text, value_m * 1000)


def test_every_pair_is_named_with_its_errors_or_its_reason() -> None:
    rows = tables(parsed(page()))["Pairs used and left out"]
    assert [row[0] for row in rows] == [view.name for view in (*result().used, *REJECTED)]
    for i, (row, view) in enumerate(zip(rows, result().used)):
        assert row[1] == f"used, view {i + 1}"
        assert_shown(row[2], view.left_px)
        assert_shown(row[3], view.right_px)
    assert [row[1:] for row in rows[-2:]] == [["rejected", view.reason] for view in REJECTED]


def test_bars_are_as_long_as_the_errors() -> None:
    charts = [svg for svg in parsed(page()).iter("svg") if svg.get("class") == "bar"]
    bars = [[float(bar.get("width")) for bar in svg.iter("rect")] for svg in charts]
    errors_px = [[view.left_px, view.right_px] for view in result().used]
    assert np.max(bars) == 100
    np.testing.assert_allclose(bars, 100 * np.array(errors_px) / np.max(errors_px), atol=0.01)


def test_hostile_names_stay_text() -> None:
    hostile = renamed(HOSTILE)
    root = parsed(calibration_page(hostile, Verdict(Word.USABLE, HOSTILE), HOSTILE, images()))
    assert {"script", "img"}.isdisjoint({each.tag for each in root.iter()})
    names = [row[0] for row in tables(root)["Pairs used and left out"]]
    assert names == [view.name for view in (*hostile.used, *hostile.rejected)]
    assert [item.text for item in root.iter("li")][: len(HOSTILE)] == list(HOSTILE)


def test_hostile_names_of_a_recording_without_a_result_stay_text() -> None:
    recording = Detections(HOSTILE[0], SIZE_PX, renamed(HOSTILE).views, renamed(HOSTILE).rejected)
    root = parsed(refusal_page(HOSTILE[0], BOARD, [recording]))
    assert {"script", "img"}.isdisjoint({each.tag for each in root.iter()})
    assert {row[0] for row in tables(root)["Pairs used and left out"]} == set(HOSTILE)


def test_a_name_that_is_no_text_can_be_saved(tmp_path: Path) -> None:
    path = save_page(calibration_page(renamed(("file\udcff\x00.png",)), judge(result())), tmp_path / "new" / "folder")
    assert path.name == "calibration_report.html"
    assert "file\N{REPLACEMENT CHARACTER}" in words(parsed(path.read_text(encoding="utf-8")))


def test_refusal_says_why_and_shows_what_the_best_detector_found() -> None:
    poor = Detections("poor", SIZE_PX, result().views[:2], ())
    rich = Detections("rich", SIZE_PX, result().views, REJECTED)
    root = parsed(refusal_page("the reason", BOARD, [poor, rich]))
    assert [item.text for item in root.iter("li")] == ["the reason"]
    found = tables(root)
    assert ["corners found by", "rich"] in found["The recording in short"]
    assert ["pairs with a board", "9 of 11"] in found["The recording in short"]
    assert [row[0] for row in found["Corners found in both images"]] == [view.name for view in result().views]
    assert [row[2] for row in found["Pairs used and left out"]] == [view.reason for view in REJECTED]


def test_refusal_without_any_board_is_a_page_too() -> None:
    root = parsed(refusal_page("nothing", BOARD, [Detections("d", SIZE_PX, (), REJECTED)]))
    assert "48 of 48 cells crossed" in words(root)


def test_without_images_there_are_no_epipolar_lines() -> None:
    without = calibration_page(result(), judge(result()))
    assert "Epipolar lines" in words(parsed(page()))
    assert "Epipolar lines" not in words(parsed(without))


def test_typical_view_is_neither_the_best_nor_the_worst() -> None:
    errors_px = {view.name: np.hypot(view.left_px, view.right_px) for view in result().used}
    chosen_px = errors_px[typical_view(result()).name]
    assert sum(error < chosen_px for error in errors_px.values()) == len(errors_px) // 2


def test_exact_corners_have_a_page() -> None:
    exact = calibrate(make_views(6, rig=RIG), SIZE_PX, BOARD)
    assert Nesting(calibration_page(exact, judge(exact))).faults == []


def partly(view: BoardView, left: slice, right: slice) -> BoardView:
    """Only these corners of a view."""
    every = np.arange(BOARD.corner_count)
    return BoardView(view.name, view.left_px[left], view.right_px[right], every[left], every[right])


def test_boards_seen_in_part_another_one_in_each_image_have_their_page() -> None:
    board = CharucoBoard.parse("charuco:9x7:0.75:5X5_100", BOARD.square_m)
    views = [partly(view, slice(None, 40), slice(8, None)) for view in make_views(9, noise_px=0.15)]
    partial = calibrate(views, SIZE_PX, board)
    root = parsed(calibration_page(partial, judge(partial), (), images()))
    assert "Over all 32 corners" in words(root)
    assert f"{9 * 40} corners over the left image" in " ".join(drawings(root))


def test_images_without_a_corner_in_common_have_no_epipolar_lines() -> None:
    board = CharucoBoard.parse("charuco:9x7:0.75:5X5_100", BOARD.square_m)
    name = typical_view(result()).name
    cut = [partly(view, slice(None, 24), slice(24, None)) if view.name == name else view for view in result().views]
    apart = replace(result(), board=board, views=tuple(cut))
    assert "Epipolar lines" not in words(parsed(calibration_page(apart, judge(result()), (), images())))


def test_hash_is_that_of_the_rig() -> None:
    rows = tables(parsed(page()))["The rig in short, ± one sigma"]
    assert ["calibration hash", calibration_hash(result().rig)] in rows


def test_single_corners_that_were_left_out_are_all_named() -> None:
    corners = tuple(RejectedCorner(f"pair{i % 9}", "right", i, 2.5 + i) for i in range(20))
    root = parsed(calibration_page(replace(result(), rejected_corners=corners), judge(result())))
    items = [item.text for item in root.iter("li")]
    assert items[-20:] == [corner.describe(BOARD) for corner in corners]
    assert "Single corners left out" not in words(parsed(page()))
