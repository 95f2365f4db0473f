"""Single pictures in a map."""

import threading

import numpy
import pytest

import alidade
from conftest import DESK


@pytest.fixture(scope="module")
def mapped():
    """The map of a rendered desk, with the poses of its frames."""
    return alidade.run(DESK, sensor="rgbd")


def off(pose, row):
    return numpy.linalg.norm(pose[:3, 3] - row[1:4])


def test_a_picture_of_the_recording_is_placed_where_it_was_taken(mapped, desk):
    localizer = alidade.Localizer(mapped.map)
    frames = desk[1]
    for index in (5, 20, 35):
        found = localizer.localize(frames[index].image)
        assert found.placed and found.reason == "" and found.metric
        assert found.pose.shape == (4, 4) and off(found.pose, mapped.trajectory[index]) < 0.02
        assert found.probability >= 0.99 and found.inliers <= found.expected
        sigma = numpy.sqrt(numpy.diag(found.covariance))
        assert (sigma > 0).all() and sigma[:3].max() < 0.1
        assert found.keyframe in mapped.map.parts[found.part].keyframes.ids


def test_another_lens_is_told_by_camera_file_or_field_of_view(mapped, desk, tmp_path):
    localizer = alidade.Localizer(mapped.map)
    camera = mapped.map.camera
    wide = desk[1][20].image[40:200, 60:260]                 # a part: another field of view and principal point
    part = alidade.Camera(200, 160, camera.fx, camera.fy, camera.cx - 60, camera.cy - 40)
    part.to_yaml(tmp_path / "part.yaml")
    fov = 2 * numpy.degrees(numpy.arctan(100 / camera.fx))
    for found in (localizer.localize(wide, part), localizer.localize(wide, tmp_path / "part.yaml"),
                  localizer.localize(wide, fov=fov)):
        assert found.placed, found.why
        assert off(found.pose, mapped.trajectory[20]) < 0.03


def test_threads_share_the_map(mapped, desk):
    localizer = alidade.Localizer(mapped.map)
    alone = [localizer.localize(desk[1][index].image).pose for index in range(0, 40, 10)]
    poses = [None] * 4

    def ask(index):
        poses[index] = localizer.localize(desk[1][10 * index].image).pose

    threads = [threading.Thread(target=ask, args=(index,)) for index in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all((one == other).all() for one, other in zip(alone, poses))


def test_what_shows_nothing_has_no_pose(mapped):
    found = alidade.Localizer(mapped.map).localize(numpy.zeros((240, 320), numpy.uint8))
    assert not found.placed and found.pose is None and found.covariance is None and found.part is None
    assert found.reason == "blank" and "texture" in found.why


def test_maps_are_taken_by_path_and_mistakes_are_told(mapped, tmp_path):
    mapped.map.save(tmp_path / "desk.alidade")
    localizer = alidade.Localizer(tmp_path / "desk.alidade")
    image = numpy.zeros((240, 320), numpy.uint8)
    with pytest.raises(alidade.UsageError, match="not both"):
        localizer.localize(image, localizer.map.camera, fov=60)
    with pytest.raises(alidade.UsageError, match="min_probability"):
        localizer.localize(image, min_probability=2)
    with pytest.raises(alidade.InputError):
        localizer.localize(image[:100], localizer.map.camera)
    with pytest.raises(alidade.ArrayError, match="image"):
        localizer.localize([1, 2, 3], fov=60)
    with pytest.raises(alidade.InputError):
        alidade.Localizer(tmp_path / "missing.alidade")
