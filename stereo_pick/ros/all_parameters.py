"""The parameters of all nodes, which their documentation, their YAML file and the search for misspelled ones need."""

from __future__ import annotations

from stereo_pick.core.configuration import correspondence_groups, method_parameter, triangulation_groups
from stereo_pick.core.parameter_groups import declared
from stereo_pick.core.params import Parameter
from stereo_pick.ros.calibration_options import CalibrationOptions
from stereo_pick.ros.nodes.capture import CaptureOptions
from stereo_pick.ros.nodes.triangulation import TriangulationOptions
from stereo_pick.ros.raw_pairs import RawImageOptions


def all_parameters() -> dict[str, dict[str, Parameter]]:
    """The parameters of each node, by their full names."""
    return {
        "capture": declared({"": CaptureOptions}),
        "rectification": declared({"": RawImageOptions}),
        "correspondence": {"method": method_parameter(), **declared(correspondence_groups())},
        "triangulation": declared({"": TriangulationOptions, **triangulation_groups()}),
        "calibration": declared({"": CalibrationOptions}),
    }
