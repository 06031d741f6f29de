"""YAML files of calibrations, and what is said of one that is none."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import yaml

from stereo_pick.core.errors import ArrayError, CalibrationError

Made = TypeVar("Made")


def read_yaml(path: Path) -> Any:
    """The content of a YAML file; raises CalibrationError, naming it, the cause and the line, where there is none."""
    try:
        return yaml.safe_load(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise CalibrationError(f"{path}: cannot be read: {error.strerror}") from None
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise CalibrationError(f"{path}: is no YAML: {' '.join(str(error).split())}") from None


def about(path: Path, build: Callable[[], Made]) -> Made:
    """Call `build`, and put the path before the message of what it raises."""
    try:
        return build()
    except (CalibrationError, ArrayError) as error:
        raise CalibrationError(f"{path}: {error}") from None
