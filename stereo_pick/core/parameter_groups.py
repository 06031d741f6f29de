"""Parameters of several steps by their full names, `prefix.name`; no step is imported for them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

from stereo_pick.core.errors import ParameterError
from stereo_pick.core.params import Configurable, Parameter

Values = Mapping[str, object]
Step = TypeVar("Step", bound=Configurable)


def declared(groups: Mapping[str, type[Configurable]]) -> dict[str, Parameter]:
    """The parameters of `groups` by their full names; the group '' has no prefix."""
    return {
        f"{prefix}.{parameter.name}" if prefix else parameter.name: parameter
        for prefix, group in groups.items()
        for parameter in group.parameters()
    }


def configured(group: type[Step], prefix: str, values: Values) -> Step:
    """Build one group from full names and values; names of other groups are passed over."""
    own = declared({prefix: group})
    try:
        return group.from_mapping({own[name].name: value for name, value in values.items() if name in own})
    except ParameterError as error:
        raise ParameterError(f"{prefix}.{error}" if prefix else str(error)) from None
