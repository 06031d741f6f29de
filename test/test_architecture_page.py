"""The files that the page on architecture names."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
ROW = re.compile(r"^\| .+? \| (.*) \|$", re.MULTILINE)
FILE = re.compile(r"`([\w/]+(?:/|\.py|\.xml))`")


def named(page: str) -> list[str]:
    """Files and folders of the table of what to change where, each with its folder: the last one named before it."""
    _, table = page.split("| to change | go to |\n")
    paths: list[str] = []
    for row in ROW.finditer(table.split("\n\n")[0]):
        folder = ""
        for name in FILE.findall(row[1]):
            folder, _, file = name.rpartition("/") if "/" in name else (folder, "", name)
            paths.append(f"{folder}/{file}")
    return paths


def test_a_name_without_a_folder_is_in_the_folder_named_before_it() -> None:
    page = "| to change | go to |\n| a | `core/a.py`, `b.py`; `ros/c/` and `d.py` |\n\nmore"
    assert named(page) == ["core/a.py", "core/b.py", "ros/c/", "ros/c/d.py"]


def test_every_named_file_exists() -> None:
    paths = named((ROOT / "docs" / "architecture.md").read_text())
    assert [path for path in paths if not (ROOT / "stereo_pick" / path).exists()] == []
