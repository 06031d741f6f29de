"""Parameters, each declared once: a field of the step that uses it.

A step (detector, correspondence method, triangulator, ...) is a frozen dataclass derived from
`Configurable`; its fields, made by `parameter`, are its parameters. The ROS descriptors, the
YAML file and the documentation are generated from these declarations.
"""

from __future__ import annotations

import math
import os
from collections.abc import Collection, Mapping
from dataclasses import MISSING, dataclass, field, fields
from difflib import get_close_matches
from pathlib import Path
from typing import Any, TypeVar

from stereo_pick.core.errors import ParameterError

Value = bool | int | float | str
Self = TypeVar("Self", bound="Configurable")


def parameter(
    default: Value,
    doc: str,
    *,
    low: float | None = None,
    high: float | None = None,
    choices: tuple[str, ...] = (),
    fixed: bool = False,
) -> Any:
    """Declare a parameter as a dataclass field: its default, legal range and meaning.

    fixed: it is read once, at the start, and cannot be changed in a running node.
    """
    declared = {"doc": doc, "low": low, "high": high, "choices": choices, "fixed": fixed}
    return field(default=default, metadata=declared)


@dataclass(frozen=True)
class Parameter:
    """A declared parameter. Its name's suffix is its unit."""

    name: str
    default: Value
    doc: str
    low: float | None
    high: float | None
    choices: tuple[str, ...] = ()
    fixed: bool = False

    def checked(self, value: object) -> Value:
        """Return `value` in the parameter's own type, or raise ParameterError."""
        kind = type(self.default)
        if kind is float and type(value) is int:
            value = float(value)
        if type(value) is not kind:
            raise ParameterError(f"{self.name} = {value!r} must be of type {kind.__name__}")
        if isinstance(value, float) and not math.isfinite(value):
            raise ParameterError(f"{self.name} = {value} must be finite")
        if self.choices and value not in self.choices:
            raise ParameterError(f"{self.name} = {value!r} must be one of: {', '.join(self.choices)}")
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            self._check_range(value)
        return value

    def parsed(self, text: str) -> Value:
        """Read a value from a command line's text, in the parameter's own type."""
        kind = type(self.default)
        if kind is bool and text.lower() in ("true", "false"):
            return text.lower() == "true"
        try:
            return self.checked(kind(text) if kind is not bool else text)
        except ValueError as error:
            if isinstance(error, ParameterError):
                raise
            raise ParameterError(f"{self.name} = {text!r} must be of type {kind.__name__}") from None

    def range_text(self) -> str:
        """The legal values, for people."""
        if self.choices:
            return " | ".join(self.choices)
        if self.low is None and self.high is None:
            return ""
        low = "" if self.low is None else f"{self.low:g}"
        high = "" if self.high is None else f"{self.high:g}"
        return f"{low} .. {high}"

    def _check_range(self, value: float) -> None:
        too_low = self.low is not None and value < self.low
        too_high = self.high is not None and value > self.high
        if too_low or too_high:
            raise ParameterError(f"{self.name} = {value} is outside its range {self.range_text()}")


@dataclass(frozen=True)
class Configurable:
    """A frozen dataclass whose fields, declared by `parameter`, are checked at birth."""

    def __post_init__(self) -> None:
        for declared in self.parameters():
            object.__setattr__(self, declared.name, declared.checked(getattr(self, declared.name)))

    @classmethod
    def parameters(cls) -> tuple[Parameter, ...]:
        """The declared parameters, in order."""
        return tuple(
            Parameter(f.name, f.default, **f.metadata)
            for f in fields(cls)
            if "doc" in f.metadata and f.default is not MISSING
        )

    @classmethod
    def from_mapping(cls: type[Self], values: Mapping[str, object]) -> Self:
        """Build from names and values; raises ParameterError on a name that is not declared."""
        known = {declared.name for declared in cls.parameters()}
        for name in values:
            if name not in known:
                raise ParameterError(f"there is no parameter {name!r}; there are: {', '.join(sorted(known))}")
        return cls(**values)


def path_of(text: str) -> Path:
    """The path that a parameter holds; ~ is the user's folder, which no shell puts in behind `:=` or in a file."""
    try:
        return Path(text).expanduser()
    except RuntimeError:  # there is no such user
        return Path(text)


def check_folder(what: str, folder: Path) -> None:
    """Raise ParameterError, beginning with `what`, where no files can be written to a folder that need not be yet."""
    nearest = next(path for path in (folder, *folder.absolute().parents) if os.access(path, os.F_OK))
    if not nearest.is_dir():
        raise ParameterError(
            f"{what} is a file: name a folder" if nearest == folder else f"{what} cannot be made: {nearest} is a file"
        )
    if not os.access(nearest, os.W_OK | os.X_OK):
        raise ParameterError(f"{what} cannot be written: {nearest} is not yours to write to; name another folder")


def unknown_name(name: str, known: Collection[str]) -> str:
    """What to say of a name that is none of the known parameters', with the one that may have been meant."""
    near = get_close_matches(name, known, n=1, cutoff=0.4)
    hint = f"did you mean {near[0]}?" if near else "docs/parameters.md lists them all"
    return f"there is no parameter {name!r}; {hint}"
