"""What a command writes must not take the place of what it reads."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from stereo_pick.core.errors import ParameterError


def keep(inputs: Sequence[Path], option: str, output: Path, what: str) -> None:
    """Raise ParameterError where `output` is one of the inputs, or lies in one; what: their name in messages."""
    if any(_is_in(output, given) for given in inputs):
        raise ParameterError(f"{option} {output} is {what}: give another file, or it would be lost")


def _is_in(output: Path, given: Path) -> bool:
    if given.is_dir():
        return given.resolve() in (output.resolve(), *output.resolve().parents)
    return output.exists() and given.exists() and output.samefile(given)
