"""Which camera_info belongs to an image: that of its own stamp, whatever came in between and in what order."""

from __future__ import annotations

from sensor_msgs.msg import CameraInfo

from stereo_pick.ros.info_of_stamp import InfoOfStamp
from stereo_pick.ros.messages.stamps import header


def info(stamp_ns: int, width: int = 640) -> CameraInfo:
    return CameraInfo(header=header(stamp_ns, "eye"), width=width)


def test_the_one_of_the_images_stamp_is_taken_not_the_latest() -> None:
    infos = InfoOfStamp()
    for stamp in (1, 2, 3):
        infos.add(info(stamp, width=stamp))
    assert [infos.take(stamp).width for stamp in (2, 1, 3)] == [2, 1, 3]


def test_without_matching_stamps_the_latest_is_taken() -> None:
    infos = InfoOfStamp()
    assert infos.awaits(7)
    assert infos.take(7) is None
    for width in (320, 640):
        infos.add(info(0, width))
    assert not infos.awaits(7)
    assert infos.take(7).width == infos.take(8).width == 640


def test_where_stamps_match_the_next_ones_is_awaited_and_a_lost_one_is_not_replaced() -> None:
    infos = InfoOfStamp()
    infos.add(info(1))
    assert infos.take(1) is not None
    assert infos.awaits(2)
    assert infos.take(2) is None
    infos.add(info(3))
    assert not infos.awaits(3)


def test_a_stamp_that_matched_once_by_chance_does_not_hold_the_latest_back_for_ever() -> None:
    infos = InfoOfStamp()
    infos.add(info(1))
    infos.take(1)
    infos.add(info(2, width=320))
    taken = [infos.take(stamp) for stamp in range(3, 50)]
    assert taken[0] is None
    assert taken[-1].width == 320
    assert not infos.awaits(50)


def test_a_stamp_that_comes_again_brings_its_own() -> None:
    infos = InfoOfStamp()
    infos.add(info(1, width=320))
    infos.take(1)
    assert infos.awaits(1)
    infos.add(info(1, width=640))
    assert infos.take(1).width == 640


def test_what_is_never_asked_for_is_forgotten() -> None:
    infos = InfoOfStamp()
    for stamp in range(1000):
        infos.add(info(stamp))
    assert len(infos._by_stamp) <= 20
    assert infos.take(999) is not None
