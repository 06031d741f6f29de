"""What every correspondence method owes, whatever its algorithm.

A method dropped into stereo_pick/core/correspondence is put through these tests with no edit here.
"""

from __future__ import annotations

import inspect
import re
import sys
from dataclasses import fields, is_dataclass, replace
from functools import cache

import numpy as np
import pytest
from outlines import blank_pair, seen
from rendering import Box, Scene, Solid, Sphere, balls, render
from rigs import RIGS

from stereo_pick.core.arrays import Floats, Image
from stereo_pick.core.camera import Camera
from stereo_pick.core.correspondence import Correspondences, Method, methods
from stereo_pick.core.errors import ParameterError
from stereo_pick.core.frames import RectifiedPair
from stereo_pick.core.objects import Blobs, Detector
from stereo_pick.core.params import Parameter
from stereo_pick.core.rectification import Rectifier

PLACES = ((-0.08, -0.03, 0.045), (0.0, 0.05, 0.05), (0.07, -0.04, 0.04))
SCENES = {
    "plain": Scene(balls(*PLACES)),
    "textured": Scene(balls(*PLACES, texture=0.4)),
    "alike in a row": Scene(balls((-0.08, 0.0, 0.04), (-0.02, 0.0, 0.04), (0.04, 0.0, 0.04), texture=0.3)),
    "boxes and balls": Scene(
        (Box(-0.07, 0.0, (0.05, 0.03, 0.03), 0.5, texture=0.4), Sphere(0.05, 0.03, (0.045,) * 3, texture=0.4))
    ),
    "empty": Scene(()),
}
SEEN_SCENES = [name for name in SCENES if name != "empty"]
PHYSICAL = re.compile(
    r"depth|distance|length|width|height|window|radius|row|column|disparity|area|time|sigma|size|offset|gap|shift|tolerance"
)
UNITS = ("_px", "_px2", "_m", "_m2", "_mm", "_rad", "_deg", "_s", "_ms", "_ns", "_hz", "_dn", "_sigma")
DIMENSIONLESS = ("_ratio", "_factor", "_fraction", "_percent", "_count")

every_method = pytest.mark.parametrize("name", methods())
every_scene = pytest.mark.parametrize("scene_name", SEEN_SCENES)
every_parameter = pytest.mark.parametrize(
    ("name", "parameter"),
    [(name, each) for name, method in methods().items() for each in method.parameters()],
    ids=lambda value: value.name if isinstance(value, Parameter) else value,
)


@cache
def view_of(scene_name: str, rig_name: str = "verged") -> tuple[RectifiedPair, Blobs]:
    rig = RIGS[rig_name]
    pair = Rectifier(rig).rectify(render(rig, SCENES[scene_name]))
    return pair, Detector().detect(pair)


def match(name: str, scene_name: str, rig_name: str = "verged", **values: object) -> Correspondences:
    return methods()[name].from_mapping(values).match(*view_of(scene_name, rig_name))


matched_once = cache(match)


def content(found: Correspondences) -> list[object]:
    others = ("refused", "extents", "turned_px", "moved_px")
    arrays = [getattr(found, field.name).tobytes() for field in fields(found) if field.name not in others]
    arrays += [found.turned_px, found.moved_px]
    arrays += [extent and extent.rotation.tobytes() + extent.size_m.tobytes() for extent in found.extents]
    places = [
        (r.reason, r.detail, *(None if p is None else p.tobytes() for p in (r.left_px, r.right_px)))
        for r in found.refused
    ]
    return [*arrays, *places]


def depths_m(found: Correspondences, pair: RectifiedPair) -> Floats:
    """Depths in the rectified frame, by equation 1.34."""
    offset = pair.rig.left.P[0, 2] - pair.rig.right.P[0, 2]
    disparity = found.left_px[:, 0] - found.right_px[:, 0] - offset
    return np.asarray(pair.rig.focal_px * pair.rig.baseline_m / disparity)


@every_method
@pytest.mark.parametrize("scene_name", SCENES)
def test_the_result_is_correspondences_with_frozen_arrays(name: str, scene_name: str) -> None:
    found = matched_once(name, scene_name)
    assert isinstance(found, Correspondences)
    for field in ("left_px", "right_px", "sigma_px", "size_px", "direction_rad"):
        array = getattr(found, field)
        assert len(array) == len(found) and not array.flags.writeable and np.isfinite(array).all(), field
    assert (found.sigma_px > 0).all() and (found.size_px > 0).all()


@every_method
def test_inputs_are_left_as_they_were(name: str) -> None:
    pair, blobs = view_of("textured")
    before = [pair.left.tobytes(), pair.right.tobytes(), *(b.contour_px.tobytes() for b in blobs.left + blobs.right)]
    match(name, "textured")
    after = [pair.left.tobytes(), pair.right.tobytes(), *(b.contour_px.tobytes() for b in blobs.left + blobs.right)]
    assert before == after


@every_method
@every_scene
def test_no_object_and_no_place_is_used_twice(name: str, scene_name: str) -> None:
    found = matched_once(name, scene_name)
    for pixels in (found.left_px, found.right_px):
        apart = np.abs(pixels[:, None] - pixels[None]).max(axis=2) + 1e6 * np.eye(len(pixels))
        assert not len(pixels) or apart.min() > 2


@every_method
@pytest.mark.parametrize("scene_name", SCENES)
@pytest.mark.parametrize("rig_name", ["verged", "parallel"])
def test_every_left_object_is_matched_or_refused(name: str, scene_name: str, rig_name: str) -> None:
    _, blobs = view_of(scene_name, rig_name)
    found = matched_once(name, scene_name, rig_name)
    accounted = [*found.left_px, *(r.left_px for r in found.refused if r.left_px is not None)]
    sound = blobs.sound()[0]
    assert len(accounted) >= len(sound)
    for blob in sound:
        assert any(np.abs(place - blob.centroid_px).max() < 3 for place in accounted)


@every_method
@every_scene
@pytest.mark.parametrize("rig_name", RIGS)
def test_what_is_matched_is_the_same_object(name: str, scene_name: str, rig_name: str) -> None:
    """Whatever a method finds lies on one object in both views; what it is not sure of it refuses."""
    pair, _ = view_of(scene_name, rig_name)
    found, scene = matched_once(name, scene_name, rig_name), SCENES[scene_name]
    owners = [
        [owner(lens, place, scene.solids, positions) for place in pixels]
        for lens, pixels, positions in (
            (pair.rig.left, found.left_px, scene.positions_m()),
            (pair.rig.right, found.right_px, pair.rig.right_T_left.apply(scene.positions_m())),
        )
    ]
    assert owners[0] == owners[1] and None not in owners[0]
    np.testing.assert_allclose(found.left_px[:, 1], found.right_px[:, 1], atol=2)


def owner(lens: Camera, place_px: Floats, solids: tuple[Solid, ...], positions_m: Floats) -> int | None:
    """The part whose image is at a rectified pixel."""
    turned = positions_m @ lens.R.T
    centres = turned[:, :2] / turned[:, 2:] * lens.P[0, 0] + lens.P[:2, 2]
    reach = np.array([max(solid.size_m) / 2 for solid in solids]) / turned[:, 2] * lens.P[0, 0]
    inside = np.linalg.norm(centres - place_px, axis=1) / reach
    return int(inside.argmin()) if inside.min() < 1 else None


@every_method
def test_what_only_the_left_camera_sees_is_refused(name: str) -> None:
    pair, blobs = view_of("textured")
    black = RectifiedPair(pair.left, blank_pair(pair.rig, level=50).right, pair.rig)
    found = methods()[name]().match(black, seen(blobs.left, []))
    assert len(found) == 0
    assert sum(refusal.left_px is not None for refusal in found.refused) == len(blobs.left)


@cache
def right_view_without(hidden: int) -> Image:
    scene, rig = SCENES["alike in a row"], RIGS["verged"]
    kept = scene.solids[:hidden] + scene.solids[hidden + 1 :]
    return Rectifier(rig).rectify(render(rig, replace(scene, solids=kept))).right


@every_method
def test_one_missing_of_several_alike_never_shifts_the_others(name: str) -> None:
    """Three alike parts in a row, the right view shows two: guessing pairs them with their neighbours."""
    pair, _ = view_of("alike in a row")
    scene = SCENES["alike in a row"]
    method = methods()[name]()
    for hidden in range(3):
        mixed = RectifiedPair(pair.left, right_view_without(hidden), pair.rig)
        found = method.match(mixed, Detector().detect(mixed))
        in_right = pair.rig.right_T_left.apply(scene.positions_m())
        for left_px, right_px in zip(found.left_px, found.right_px):
            left_owner = owner(pair.rig.left, left_px, scene.solids, scene.positions_m())
            assert left_owner == owner(pair.rig.right, right_px, scene.solids, in_right) != hidden


@every_method
def test_textureless_is_refused_or_right(name: str) -> None:
    """Nothing but outlines to go by: even grey within them."""
    pair, blobs = view_of("plain")
    flat = blank_pair(pair.rig)
    found = methods()[name]().match(flat, blobs)
    scene = SCENES["plain"]
    in_right = pair.rig.right_T_left.apply(scene.positions_m())
    for left_px, right_px in zip(found.left_px, found.right_px):
        assert owner(pair.rig.left, left_px, scene.solids, scene.positions_m()) == owner(
            pair.rig.right, right_px, scene.solids, in_right
        )
    assert len(found) + len(found.refused) >= len(blobs.left)


@every_method
def test_nothing_there_gives_nothing(name: str) -> None:
    found = matched_once(name, "empty")
    assert len(found) == 0 and not found.refused


@every_method
@pytest.mark.parametrize("limits_m", [(0.2, 0.7), (0.9, 5.0), (0.86, 0.91), (1.2, 10.0)], ids=str)
def test_depths_stay_within_their_limits(name: str, limits_m: tuple[float, float]) -> None:
    pair, _ = view_of("textured")
    found = match(name, "textured", min_depth_m=limits_m[0], max_depth_m=limits_m[1])
    depths = depths_m(found, pair)
    assert ((depths >= limits_m[0] - 1e-9) & (depths <= limits_m[1] + 1e-9)).all()


@every_method
def test_within_wide_limits_something_is_found(name: str) -> None:
    assert max(len(matched_once(name, scene_name)) for scene_name in SEEN_SCENES) >= 2


@every_method
@every_scene
def test_the_same_input_gives_the_same_output(name: str, scene_name: str) -> None:
    assert content(match(name, scene_name)) == content(matched_once(name, scene_name))


@every_method
def test_the_method_and_its_module_say_what_they_do(name: str) -> None:
    method = methods()[name]
    assert is_dataclass(method) and not inspect.isabstract(method) and issubclass(method, Method)
    for documented in (sys.modules[method.__module__], method, method.match):
        assert documented.__doc__ and len(documented.__doc__) > 20
    assert method.__module__.rpartition(".")[2] == name


@every_method
def test_a_method_is_frozen(name: str) -> None:
    method = methods()[name]()
    with pytest.raises(AttributeError):
        method.min_depth_m = 1.0  # type: ignore[misc]


@every_method
def test_depths_with_nothing_between_them_are_refused(name: str) -> None:
    with pytest.raises(ParameterError, match="min_depth_m = 5 must be less than max_depth_m = 1"):
        methods()[name](min_depth_m=5.0, max_depth_m=1.0)


@every_method
def test_every_field_is_a_declared_parameter(name: str) -> None:
    method = methods()[name]
    assert {field.name for field in fields(method)} == {each.name for each in method.parameters()}


@every_parameter
def test_every_parameter_is_documented(name: str, parameter: Parameter) -> None:
    assert len(parameter.doc.split()) >= 3 and parameter.doc.endswith(".")


@every_parameter
def test_every_parameter_has_a_range_that_is_kept(name: str, parameter: Parameter) -> None:
    if isinstance(parameter.default, bool):
        return
    if isinstance(parameter.default, str):
        assert not parameter.choices or (parameter.default in parameter.choices and len(parameter.choices) > 1)
        beyond: list[object] = ["nothing of the kind"]
    else:
        assert parameter.low is not None and parameter.high is not None
        assert parameter.low <= parameter.default <= parameter.high and parameter.low < parameter.high
        kind = type(parameter.default)
        beyond = [kind(parameter.low - 1), kind(parameter.high + 1)]
    for value in beyond:
        with pytest.raises(ParameterError, match=parameter.name):
            methods()[name].from_mapping({parameter.name: value})


@every_parameter
def test_a_physical_parameter_carries_its_unit(name: str, parameter: Parameter) -> None:
    if isinstance(parameter.default, (bool, str)) or not PHYSICAL.search(parameter.name):
        return
    says_what_part_it_is = "part of" in parameter.doc
    assert parameter.name.endswith(UNITS + DIMENSIONLESS) or says_what_part_it_is
