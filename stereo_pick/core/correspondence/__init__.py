"""Correspondence: the objects of the left view found again in the right one. One file a method."""

from __future__ import annotations

import importlib
import pkgutil
from functools import cache

from stereo_pick.core.correspondence.correspondences import Correspondences
from stereo_pick.core.correspondence.method import Method
from stereo_pick.core.errors import ParameterError

__all__ = ["Correspondences", "Method", "method_named", "methods"]


@cache
def methods() -> dict[str, type[Method]]:
    """All methods by name: every file of this folder that defines a `Method` is one."""
    found = {}
    for module_info in pkgutil.iter_modules(__path__):
        module = importlib.import_module(f"{__name__}.{module_info.name}")
        for value in vars(module).values():
            if isinstance(value, type) and issubclass(value, Method) and value.__module__ == module.__name__:
                if not getattr(value, "__abstractmethods__", None):
                    found[module_info.name] = value
    return found


def method_named(name: str) -> type[Method]:
    """The method of that name; raises ParameterError listing those there are."""
    if name not in methods():
        raise ParameterError(f"method = {name!r} must be one of: {', '.join(methods())}")
    return methods()[name]
