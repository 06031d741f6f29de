"""ROS parameters made from the core's declarations: descriptors, ranges, and live changes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor, SetParametersResult
from rclpy.exceptions import InvalidParameterTypeException, InvalidParameterValueException
from rclpy.node import Node
from rclpy.parameter import Parameter as RosParameter

from stereo_pick.core.errors import ParameterError
from stereo_pick.core.params import Parameter, Value

_INT_MAX = 2**31 - 1
_WRITTEN = {  # how YAML takes a value for one of that type
    bool: "true or false",
    int: "a whole number without a point",
    float: "a number with a point: 1.0, not 1",
    str: "a text; one that looks like a number needs quotes",
}

Values = dict[str, Value]


class LiveParameters:
    """Declares parameters on a node and keeps their values.

    A set is checked as a whole before it is accepted; `changed` is called with all values after it took effect. Values
    are swapped in the post-set callback only: a set that another check refuses must leave nothing behind.
    Raises ParameterError where a value given at the start is out of its range.
    """

    def __init__(
        self,
        node: Node,
        declared: Mapping[str, Parameter],
        check: Callable[[Values], object],
        changed: Callable[[], None],
    ) -> None:
        self._declared = dict(declared)
        self._check = check
        self._changed = changed
        self.values: Values = {name: _declare(node, name, parameter) for name, parameter in self._declared.items()}
        check(self.values)
        node.add_on_set_parameters_callback(self._on_set)
        node.add_post_set_parameters_callback(self._after_set)

    def _on_set(self, parameters: Sequence[RosParameter]) -> SetParametersResult:
        try:
            self._check({**self.values, **self._own(parameters)})
        except ParameterError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _after_set(self, parameters: Sequence[RosParameter]) -> None:
        own = self._own(parameters)
        if own:
            self.values.update(own)
            self._changed()

    def _own(self, parameters: Sequence[RosParameter]) -> Values:
        return {
            parameter.name: self._declared[parameter.name].checked(parameter.value)
            for parameter in parameters
            if parameter.name in self._declared
        }


def wrong_type(name: str, kind: type[Value], error: InvalidParameterTypeException) -> ParameterError:
    """What to raise where a parameter is given a value of another type than its own."""
    return ParameterError(f"{name} must be of type {kind.__name__} ({_WRITTEN[kind]}): {error}")


def descriptor(parameter: Parameter) -> ParameterDescriptor:
    """The ROS descriptor of a declared parameter."""
    text = ParameterDescriptor(
        name=parameter.name, description=parameter.doc, read_only=parameter.fixed, additional_constraints=""
    )
    if parameter.choices:
        text.additional_constraints = f"one of: {', '.join(parameter.choices)}"
    if isinstance(parameter.default, bool) or (parameter.low is None and parameter.high is None):
        return text
    if isinstance(parameter.default, int):
        low = 0 if parameter.low is None else int(parameter.low)
        high = _INT_MAX if parameter.high is None else int(parameter.high)
        text.integer_range = [IntegerRange(from_value=low, to_value=high, step=0)]
    elif isinstance(parameter.default, float):
        low_f, high_f = (float(v) if v is not None else None for v in (parameter.low, parameter.high))
        text.floating_point_range = [
            FloatingPointRange(
                from_value=-1e308 if low_f is None else low_f, to_value=1e308 if high_f is None else high_f, step=0.0
            )
        ]
    return text


def given_values(node: Node) -> dict[str, object]:
    """What a node was given at its start, on the command line and in files; rclpy has no public way to ask for it."""
    return {name: given.value for name, given in getattr(node, "_parameter_overrides", {}).items()}


def _declare(node: Node, name: str, parameter: Parameter) -> Value:
    try:
        value = node.declare_parameter(name, parameter.default, descriptor(parameter)).value
    except InvalidParameterTypeException as error:
        raise wrong_type(name, type(parameter.default), error) from None
    except InvalidParameterValueException as error:
        raise ParameterError(f"{name} must be within {parameter.range_text()}: {error}") from None
    return parameter.checked(value)
