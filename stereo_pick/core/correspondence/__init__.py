"""Correspondence: the objects of the left view found again in the right one. One file a method."""

from __future__ import annotations

import importlib
import pkgutil
from functools import cache
from inspect import isabstract
from types import ModuleType

from stereo_pick.core.correspondence.correspondences import Correspondences
from stereo_pick.core.correspondence.method import Method
from stereo_pick.core.errors import ParameterError

__all__ = ["Correspondences", "Method", "method_named", "methods"]


@cache
def methods() -> dict[str, type[Method]]:
    """All methods by name: every file of this folder that defines a `Method` is one."""
    found: dict[str, type[Method]] = {}
    for module_info in pkgutil.iter_modules(__path__):
        module = importlib.import_module(f"{__name__}.{module_info.name}")
        found.update((module_info.name, value) for value in vars(module).values() if _is_method_of(module, value))
    return found


def _is_method_of(module: ModuleType, value: object) -> bool:
    defined_here = isinstance(value, type) and value.__module__ == module.__name__
    return defined_here and issubclass(value, Method) and not isabstract(value)  # type: ignore[arg-type]


def method_named(name: str) -> type[Method]:
    """The method of that name; raises ParameterError listing those there are."""
    if name not in methods():
        raise ParameterError(f"method = {name!r} must be one of: {', '.join(methods())}")
    return methods()[name]
