"""Files that take the place of others as a whole: a full disk or Ctrl-C leaves those that were there, and no scraps."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory


@contextmanager
def drafted(path: Path) -> Iterator[Path]:
    """A file to write, which becomes `path` once it is written. OSError where that fails."""
    if path.exists() and not path.is_file():  # /dev/stdout and /dev/null must stay what they are
        yield path
        return
    file = path.resolve()
    draft = file.with_name(f".{file.name}.new")
    try:
        yield draft
        _store(draft)
        draft.replace(file)
    finally:
        draft.unlink(missing_ok=True)


@contextmanager
def renewed(folder: Path) -> Iterator[Path]:
    """A folder to write files into, which go to `folder`, which is made, once all are written: they belong together.

    OSError where that fails.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory(prefix=".new_", dir=folder, ignore_cleanup_errors=True) as made:
        yield Path(made)
        files = sorted(Path(made).iterdir())
        for file in files:
            _store(file)
        for file in files:
            file.replace(folder / file.name)


def _store(file: Path) -> None:
    with file.open("rb") as written:
        os.fsync(written.fileno())  # else it may be empty after a cut of power, in place of the old one
