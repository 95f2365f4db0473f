"""Paths that are not UTF-8, as str with surrogate escapes or as bytes."""

import os

import numpy
import pytest

import alidade
from conftest import DESK, play

RAW = b"caf\xe9 \xff"  # Latin-1


@pytest.fixture(params=["bytes", "str"])
def folder(request, tmp_path):
    """A folder with such a name, in the form that the test is about, and a function to name files in it."""
    raw = os.path.join(os.fsencode(tmp_path), RAW)
    os.mkdir(raw)

    def named(name=""):
        path = os.path.join(raw, os.fsencode(name)) if name else raw
        return path if request.param == "bytes" else os.fsdecode(path)

    return named


@pytest.fixture(scope="module")
def result():
    return alidade.run(DESK, sensor="rgbd", last=19)


def test_maps(folder, result):
    result.map.save(folder("map.alidade"))
    assert alidade.Map.load(folder("map.alidade")).to_bytes() == result.map.to_bytes()
    assert "points" in result.map.export(folder("cloud.ply"))
    result.export(folder("run.mcap"))
    assert os.path.getsize(folder("cloud.ply")) > 0 and os.path.getsize(folder("run.mcap")) > 0
    with pytest.raises(alidade.InputError):
        alidade.Map.load(folder("none"))


def test_cameras_and_trajectories(folder, result):
    camera = alidade.Camera.from_fov(320, 240, 70)
    camera.to_yaml(folder("camera.yaml"))
    assert alidade.Camera.from_yaml(folder("camera.yaml")).fx == camera.fx
    alidade.Rectifier(folder("camera.yaml"))
    alidade.write_trajectory(folder("path.txt"), result.trajectory)
    numpy.testing.assert_allclose(alidade.read_trajectory(folder("path.txt")), result.trajectory, atol=1e-6)


def test_runs(folder, result):
    made = alidade.run(DESK, sensor="rgbd", last=19, out=folder("out"))
    assert made.map.to_bytes() == result.map.to_bytes()
    assert os.path.isfile(made.file("stats.json")) and "alidade.Result" in repr(made)
    opened = alidade.Result(folder("out"))
    opened.save(folder("copy"))
    assert os.path.isfile(folder("copy/stats.json"))
    again = alidade.localize(DESK, folder("out"), sensor="rgbd", last=9)
    assert len(again.trajectory) > 0


def test_recordings(folder, desk):
    recording, frames = desk
    os.mkdir(folder("rgb"))
    names = []
    for i, frame in enumerate(frames[:5]):
        name = f"rgb/{i}.pgm"
        with open(folder(name), "wb") as file:
            file.write(b"P5 320 240 255\n" + frame.image.tobytes())
        names.append(f"{frame.time:.6f} {name}\n")
    with open(folder("rgb.txt"), "w", encoding="ascii") as file:
        file.writelines(names)
    with alidade.open(folder(), fov=70) as opened:
        assert os.fsencode(opened.name) == RAW
        images = [frame.image for frame in opened]
    assert len(images) == 5 and all(image is not None for image in images)
    assert alidade.run(folder(), fov=70, calibrate_first=False).stats["frames"] == 5
    os.remove(folder("rgb/2.pgm"))
    with alidade.open(folder(), fov=70) as opened:
        problems = [frame.problem for frame in opened if frame.problem]
    assert all(RAW in os.fsencode(problem) for problem in problems)


def test_slam(folder, desk):
    recording, frames = desk
    recording.camera.to_yaml(folder("camera.yaml"))
    slam = alidade.Slam(folder("camera.yaml"), sensor="rgbd")
    play(slam, frames[:10])
    slam.save(folder("map.alidade"))
    slam.save_trajectory(folder("path.txt"))
    more = alidade.Slam(recording.camera, sensor="rgbd")
    more.load(folder("map.alidade"))
    with pytest.raises(alidade.Error):
        alidade.Slam(recording.camera, sensor="rgbd", config=folder("none.yaml"))
    with pytest.raises(alidade.Error):
        alidade.Slam(recording.camera, sensor="rgbd", detector=folder("none.onnx"))


@pytest.mark.parametrize("path", ["map\0.alidade", b"map\0.alidade", "\ud800.alidade"])
def test_names_that_no_file_can_have(path, result):
    for use in (result.map.save, alidade.Map.load, alidade.open, alidade.Camera.from_yaml, alidade.Result):
        with pytest.raises(alidade.Error):
            use(path)
