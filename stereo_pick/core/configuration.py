"""All parameters of the pipeline's steps, by their full names: `segmentation.polarity`, `ssd.cost`, ...

The ROS nodes, the command line, the YAML file and the documentation use these names.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from stereo_pick.core.correspondence import method_named, methods
from stereo_pick.core.errors import ParameterError
from stereo_pick.core.objects import Detector
from stereo_pick.core.parameter_groups import Values, configured, declared
from stereo_pick.core.params import Configurable, Parameter, Value, unknown_name
from stereo_pick.core.pipeline import Steps
from stereo_pick.core.triangulation import Triangulator

DEFAULT_METHOD = "feature"


def method_parameter() -> Parameter:
    """The parameter that chooses the correspondence method."""
    return Parameter(
        "method", DEFAULT_METHOD, "How objects are found again in the right view.", None, None, tuple(methods())
    )


def correspondence_groups() -> dict[str, type[Configurable]]:
    """The configurable parts of the correspondence step, by prefix."""
    return {"segmentation": Detector, **methods()}


def triangulation_groups() -> dict[str, type[Configurable]]:
    """The configurable parts of the triangulation step, by prefix."""
    return {"triangulation": Triangulator}


def steps(values: Values) -> Steps:
    """Build the pipeline's steps from full names and values; raises ParameterError on an unknown name or bad value."""
    known = pipeline_parameters()
    for name in values:
        _check_known(name, known)
    chosen = method_named(str(values.get("method", DEFAULT_METHOD)))
    # All, not only the chosen one: a bad value must be refused when it is set, not when its method is.
    every = {kind: configured(kind, name, values) for name, kind in methods().items()}
    return Steps(
        detector=configured(Detector, "segmentation", values),
        method=every[chosen],
        triangulator=configured(Triangulator, "triangulation", values),
    )


def pipeline_parameters() -> dict[str, Parameter]:
    """Every parameter of the pipeline by its full name."""
    return {"method": method_parameter(), **declared({**correspondence_groups(), **triangulation_groups()})}


def parsed(assignments: Iterable[str]) -> dict[str, Value]:
    """Read `name=value` texts; raises ParameterError on an unknown name or a bad value."""
    known = pipeline_parameters()
    values: dict[str, Value] = {}
    for assignment in assignments:
        name, equals, text = assignment.partition("=")
        if not equals:
            raise ParameterError(f"{assignment!r} must have the form name=value")
        _check_known(name, known)
        values[name] = known[name].parsed(text)
    return values


def _check_known(name: str, known: Mapping[str, Parameter]) -> None:
    if name not in known:
        raise ParameterError(unknown_name(name, known))
