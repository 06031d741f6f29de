"""Every parameter by its full name."""

from __future__ import annotations

import pytest

from stereo_pick.core.configuration import DEFAULT_METHOD, parsed, pipeline_parameters, steps
from stereo_pick.core.correspondence import methods
from stereo_pick.core.correspondence.ssd import Ssd
from stereo_pick.core.errors import ParameterError
from stereo_pick.core.pipeline import Steps


def test_no_values_make_the_default_steps() -> None:
    assert steps({}) == Steps() and isinstance(steps({}).method, methods()[DEFAULT_METHOD])


def test_a_value_reaches_its_own_step_only() -> None:
    made = steps(
        {"method": "ssd", "ssd.widest_window_px": 21, "segmentation.min_area_px": 99, "feature.assignment": "area"}
    )
    assert made.method == Ssd(widest_window_px=21)
    assert made.detector.min_area_px == 99
    assert made.triangulator == Steps().triangulator


def test_every_default_given_by_name_changes_nothing() -> None:
    assert steps({name: each.default for name, each in pipeline_parameters().items()}) == Steps()


@pytest.mark.parametrize(
    "values", [{"ssd.window": 15}, {"widest_window_px": 15}, {"method": "sdd"}, {"ssd.widest_window_px": 4}]
)
def test_a_wrong_name_or_value_is_refused_with_it(values: dict[str, object]) -> None:
    ((name, value),) = values.items()
    with pytest.raises(ParameterError) as caught:
        steps({"method": "ssd", **values})
    assert name.split(".")[-1] in str(caught.value) or str(value) in str(caught.value)


def test_a_value_of_a_method_that_is_not_chosen_is_checked_too() -> None:
    with pytest.raises(ParameterError, match="ssd.widest_window_px = 4 must be odd"):
        steps({"method": "feature", "ssd.widest_window_px": 4})


def test_a_misspelt_name_gets_the_one_that_was_meant() -> None:
    with pytest.raises(ParameterError, match="did you mean triangulation.max_ray_gap_m"):
        steps({"triangulation.max_raygap": 0.1})


def test_assignments_are_read_from_text() -> None:
    assert parsed(["method=ssd", "ssd.widest_window_px=21", "triangulation.max_ray_gap_m=0.02"]) == {
        "method": "ssd", "ssd.widest_window_px": 21, "triangulation.max_ray_gap_m": 0.02,
    }  # fmt: skip


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("method", "'method' must have the form name=value"),
        ("methods=ssd", "no parameter 'methods'; did you mean method"),
        ("ssd.widest_window_px=wide", "widest_window_px = 'wide' must be of type int"),
        ("segmentation.polarity=grey", "polarity = 'grey' must be one of: auto, bright, dark"),
    ],
)
def test_a_bad_assignment_is_refused(text: str, complaint: str) -> None:
    with pytest.raises(ParameterError, match=complaint):
        parsed([text])
