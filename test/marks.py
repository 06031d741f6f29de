"""Which tests `make test` runs, and which `make test-all` alone."""

from __future__ import annotations

from typing import Any

import pytest

more = pytest.mark.more


def first_of(one: Any, *others: Any) -> list[Any]:
    """Arguments of a test: `make test` runs the first, `make test-all` the others that show the same, too."""
    return [one, *(pytest.param(*(each if isinstance(each, tuple) else (each,)), marks=more) for each in others)]
