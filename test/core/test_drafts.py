"""Files that are replaced as a whole, or not at all."""

from __future__ import annotations

from pathlib import Path

import pytest

from stereo_pick.core.drafts import drafted, renewed


def test_what_is_not_written_to_its_end_leaves_what_was_there(tmp_path: Path) -> None:
    file = tmp_path / "left.yaml"
    file.write_text("old")
    for end in (KeyboardInterrupt, OSError):
        with pytest.raises(end), drafted(file) as draft:
            draft.write_text("half")
            raise end
        with pytest.raises(end), renewed(tmp_path) as folder:
            (folder / "left.yaml").write_text("new")
            raise end
    assert [path.name for path in tmp_path.iterdir()] == ["left.yaml"]
    assert file.read_text() == "old"


def test_what_is_written_takes_its_place_and_a_link_stays_one(tmp_path: Path) -> None:
    link, folder = tmp_path / "link.yaml", tmp_path / "made" / "rig"
    link.symlink_to(folder / "left.yaml")
    with renewed(folder) as made:
        for name in ("left.yaml", "right.yaml"):
            (made / name).write_text("first")
    with drafted(link) as draft:
        draft.write_text("second")
    assert link.is_symlink()
    assert sorted((path.name, path.read_text()) for path in folder.iterdir()) == [
        ("left.yaml", "second"),
        ("right.yaml", "first"),
    ]


def test_what_is_no_file_is_written_to_and_stays() -> None:
    with drafted(Path("/dev/null")) as draft:
        draft.write_text("nothing")
    assert Path("/dev/null").is_char_device()
