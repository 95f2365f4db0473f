"""Inertial readings: into Slam, out of recordings."""

import numpy
import pytest

import alidade

CAMERA = alidade.Camera(64, 48, 60.0, 60.0, 31.5, 23.5)


@pytest.fixture
def folder(tmp_path):
    """Five images at 20 Hz, with readings at 100 Hz."""
    for i in range(5):
        image = numpy.full((48, 64), 40 * i, numpy.uint8)
        (tmp_path / f"{i}.pgm").write_bytes(b"P5 64 48 255\n" + image.tobytes())
    CAMERA.to_yaml(tmp_path / "camera.yaml")
    with open(tmp_path / "camera.yaml", "a", encoding="ascii") as file:
        file.write("imu:\n  gyro_noise: 2e-4\n  time_offset: 0.01\n")
    rows = [(i / 100, 0.01 * (i % 7), 0.02, 0.03, 0.1 * (i % 5), 9.8, 0.2) for i in range(-50, 100)]
    lines = [",".join(map(repr, row)) for row in rows]
    (tmp_path / "imu.csv").write_text("t [s],wx [rad/s],wy,wz,ax [m/s^2],ay,az\n" + "\n".join(lines))
    return tmp_path, numpy.array(rows)


def test_recordings_bring_their_readings(folder):
    path, rows = folder
    with alidade.open(path) as recording:
        assert recording.imu.T_camera_imu is None and recording.imu.time_offset == 0.01
        assert recording.imu.gyro_noise == 2e-4 and recording.imu.accel_noise == alidade.Imu().accel_noise
        assert recording.imu.rate == pytest.approx(100, 1e-6)
        readings = [frame.imu for frame in recording]
    given = numpy.concatenate(readings)
    at = numpy.searchsorted(rows[:, 0], given[0, 0] - 1e-6)
    assert len(given) > 30 and numpy.allclose(given, rows[at:at + len(given)])
    with alidade.open(path, imu="off") as recording:
        assert recording.imu is None and next(iter(recording)).imu is None


def test_slam_takes_them(folder):
    path, _ = folder
    with alidade.open(path) as recording:
        slam = alidade.Slam(recording.camera, imu=recording.imu)
        for frame in recording:
            slam.track(frame.time, frame.image, imu=frame.imu)
    told = slam.inertial
    assert not told.metric and told.gravity is None and told.scale_sigma is None
    assert told.imu.gyro_noise == 2e-4 and told.gyro_bias.shape == (3,)
    assert alidade.Slam(CAMERA).inertial is None
    pose = numpy.eye(4)
    pose[:3, 3] = 0.1, 0.2, 0.3
    known = alidade.Slam(CAMERA, imu={"T_camera_imu": pose, "rate": 200}).inertial.imu
    assert (known.T_camera_imu == pose).all() and known.rate == 200 and known.time_offset is None


def test_frames_tell_the_orientation(folder):
    path, _ = folder
    with alidade.open(path) as recording:
        slam = alidade.Slam(recording.camera, imu={"T_camera_imu": numpy.eye(4), "time_offset": 0.01})
        told = [slam.track(frame.time, frame.image, imu=frame.imu).orientation for frame in recording]
    last = told[-1].rotation
    assert last.shape == (3, 3) and numpy.allclose(last @ last.T, numpy.eye(3))
    up = last[2]  # in the camera: the accelerations of the folder are along its y axis
    assert up[1] > 0.99 and 0 < told[-1].tilt_sigma < 0.5 and 0 < told[-1].heading_sigma < 1
    with alidade.open(path) as recording:  # where nothing is known of the sensor, a camera that sees nothing tells nothing
        slam = alidade.Slam(recording.camera, imu=recording.imu)
        assert all(slam.track(f.time, f.image, imu=f.imu).orientation is None for f in recording)


def test_slips_are_named():
    image = numpy.zeros((48, 64), numpy.uint8)
    slam = alidade.Slam(CAMERA, imu={})
    for wrong in (numpy.zeros((3, 6)), numpy.zeros(7), "readings", [["a"] * 7]):
        with pytest.raises(alidade.ArrayError, match="imu"):
            slam.track(0, image, imu=wrong)
    assert slam.frames == 0
    slam.track(0, image, imu=numpy.zeros((0, 7)))
    slam.track(1, image, imu=[[0.5, 0, 0, 0, 0, 9.81, 0]])
    with pytest.raises(alidade.UsageError, match="alidade.Imu"):
        alidade.Slam(CAMERA).track(0, image, imu=numpy.zeros((1, 7)))
    with pytest.raises(alidade.UsageError, match="not a rotation"):
        alidade.Imu(T_camera_imu=numpy.zeros((4, 4)))
    with pytest.raises(alidade.ArrayError, match="T_camera_imu"):
        alidade.Imu(T_camera_imu=[1, 2, 3])
    with pytest.raises(alidade.UsageError, match="above 0"):
        alidade.Imu(gyro_noise=0)
    with pytest.raises(TypeError, match="alidade.Imu"):
        alidade.Slam(CAMERA, imu=7)
