"""SLAM frame by frame: arrays in, poses out, threads, memory."""

import gc
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time

import numpy
import pytest

import alidade
from conftest import play


def made(recording, **more):
    return alidade.Slam(recording.camera, sensor="rgbd", **more)


def test_poses_are_those_of_the_truth(desk):
    recording, frames = desk
    with made(recording) as slam:
        results = play(slam, frames)
    assert all(result.state == "tracking" and result.reason == "" for result in results)
    first = numpy.linalg.inv(frames[0].true_pose)
    for frame, result in zip(frames, results):
        assert numpy.abs(result.pose - first @ frame.true_pose)[:3, 3].max() < 0.03
        assert result.pose.dtype == numpy.float64 and result.pose.shape == (4, 4)
    assert results[0].keyframe and results[0].covariance is None
    sigma = numpy.sqrt(numpy.diag(results[20].covariance))
    assert 1e-5 < sigma[:3].max() < 0.05 and results[20].matches > 50
    assert slam.trajectory().shape == (len(frames), 8)
    assert [pose.frame for pose in slam.frame_poses(35)] == list(range(35, 40))
    features = slam.features()
    assert features.pixels.shape == (len(features.matched), 2) and features.matched.any()
    assert slam.times()["frame"].shape == (len(frames),)
    assert slam.settings["seed"] == "1"


def test_a_guessed_camera_is_found(desk):
    with alidade.open("synth:desk?frames=150&width=400&height=300&speed=2", sensor="mono") as recording:
        guess = alidade.Camera.from_fov(400, 300, 85)
        slam = alidade.Slam(guess, calibrate=True, profile="phone")
        assert slam.focal_sigma is None and slam.camera.fx == guess.fx
        for frame in recording:
            slam.track(frame.time, frame.image)
        slam.finish()
        assert slam.focal_sigma < 0.03
        assert abs(slam.camera.fx / recording.camera.fx - 1) < 0.03
    with pytest.raises(alidade.UsageError, match="one camera"):
        alidade.Slam(desk[0].camera, sensor="rgbd", calibrate=True)


def test_finish_returns_the_trajectory(desk):
    recording, frames = desk
    slam = made(recording)
    assert slam.finish().shape == (0, 8)
    play(slam, frames[:10])
    finished = slam.finish()
    assert finished.shape == (10, 8) and (finished == slam.trajectory()).all()


def test_the_order_of_arguments_is_that_of_other_languages(desk):
    recording, frames = desk
    expected = play(made(recording), frames[:3])
    slam, old = made(recording), made(recording)
    for frame, result in zip(frames[:3], expected):
        assert (slam.track(frame.time, frame.image, None, frame.depth).pose == result.pose).all()
        with pytest.warns(DeprecationWarning, match="image, right, depth"):
            assert (old.track(frame.time, frame.image, frame.depth).pose == result.pose).all()
    stereo = alidade.Slam(alidade.Camera(320, 240, 262, 262, 160, 120, baseline=0.1), sensor="stereo")
    assert stereo.track(0.0, frames[0].image, frames[0].image).reason
    with pytest.warns(DeprecationWarning, match="image, right, depth"):
        stereo.track(0.1, frames[0].image, None, frames[0].image)
    with pytest.raises(alidade.InputError, match="float32"):
        slam.track(1.0, frames[0].image, depth=frames[0].image)


def test_what_a_mask_marks_is_left_out(desk):
    recording, frames = desk
    mask = numpy.zeros((24, 32), numpy.uint8)
    mask[:, 16:] = 1
    slam = made(recording)
    slam.leave_out(mask)
    play(slam, frames[:3])
    assert slam.counts()["left_out"] == 0.5
    assert slam.features().pixels[:, 0].max() < 160
    with pytest.raises(alidade.UsageError, match="before the first frame"):
        slam.leave_out(mask)
    with pytest.raises(alidade.Error, match="gray"):
        made(recording).leave_out(numpy.zeros((24, 32, 3), numpy.uint8))


def test_names_of_version_0_1_are_accepted_with_a_warning(desk):
    recording, frames = desk
    with pytest.warns(DeprecationWarning, match="localize="):
        slam = made(recording, localise=True)
    assert slam.counts()["relocalizations"] == 0
    with pytest.warns(DeprecationWarning, match="relocalizations"):
        assert slam.counts()["relocalisations"] == 0
    with pytest.raises(KeyError):
        slam.counts()["nothing"]


def test_no_pose_says_why(desk):
    recording, frames = desk
    slam = alidade.Slam(recording.camera, sensor="mono")
    result = slam.track(0.0, frames[0].image)
    assert result.pose is None and result.state == "initializing"
    assert result.failure and result.reason
    assert result.covariance is None and not result.keyframe


@pytest.mark.parametrize("more", [dict(), dict(semidense=True, dynamics="geometry")])
def test_arrays_of_any_layout_are_taken_and_none_is_kept(desk, more):
    recording, frames = desk
    plain, odd = made(recording, **more), made(recording, **more)
    for frame in frames[:15]:
        image = numpy.stack([frame.image, 255 - frame.image, frame.image // 2], axis=-1)
        wide = numpy.zeros((240, 400, 3), numpy.uint8)
        wide[:, 40:360] = image
        depth, flipped = frame.depth.copy(), image[..., ::-1].copy()[..., ::-1]
        expected = plain.track(frame.time, image, depth=depth)
        part = wide[:, 40:360] if frame.number % 2 else flipped
        result = odd.track(frame.time, part, depth=numpy.asfortranarray(depth))
        for array in (image, wide, flipped, depth):  # would change results if an array were kept
            array[:] = 7
        assert not part.flags.c_contiguous
        numpy.testing.assert_array_equal(result.pose, expected.pose)
    plain.finish()
    odd.finish()
    assert plain.map().to_bytes() == odd.map().to_bytes()


def test_images_that_cannot_be_are_refused(desk):
    recording, frames = desk
    slam = made(recording)
    frame = frames[0]
    for image, words in [(frame.image.astype(float), "uint8"), (frame.image[:100], "320x240"),
                         (frame.image[0], "height, width"), (None, "image"), ("picture", "image"),
                         (frame.image[:0], "empty")]:
        with pytest.raises(alidade.InputError, match=words):
            slam.track(0.0, image, depth=frame.depth)
    with pytest.raises(alidade.InputError, match="float32"):
        slam.track(0.0, frame.image, depth=frame.depth.astype(int))
    with pytest.raises(alidade.InputError, match="time"):
        slam.track(float("nan"), frame.image)
    assert slam.frames == 0
    assert slam.track(0.0, frame.image, depth=frame.depth).state == "tracking"
    with pytest.raises(alidade.InputError):
        slam.track(0.0, frame.image, depth=frame.depth)
    with pytest.raises(alidade.UsageError):
        alidade.Slam(recording.camera, sensor="rgbd", settings={"no.such": 1})
    with pytest.raises(alidade.InputError):
        alidade.Camera(640, 480, -1, 1, 0, 0)
    with pytest.raises(alidade.UsageError):
        alidade.Camera(640, 480, 500, 500, 320, 240, distortion=[0] * 6)
    slam.close()
    with pytest.raises(alidade.UsageError, match="closed"):
        slam.track(1.0, frame.image)


def test_track_from_two_threads_takes_turns(desk):
    recording, frames = desk
    slam = made(recording, schedule="threaded")
    refused, tracked, failed = [], [], []

    def drive(some):
        for frame in some:
            try:
                tracked.append(slam.track(frame.time, frame.image, depth=frame.depth).frame)
            except alidade.InputError as error:  # the other thread's frame was later
                refused.append(str(error))
            except BaseException as error:  # pylint: disable=broad-except
                failed.append(error)

    def ask():
        while any(thread.is_alive() for thread in threads[:2]):
            slam.trajectory(), slam.map(), slam.features(), slam.health()

    threads = [threading.Thread(target=drive, args=(frames[i::2],)) for i in range(2)]
    threads.append(threading.Thread(target=ask))
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failed and len(tracked) + len(refused) == len(frames)
    assert sorted(tracked) == list(range(slam.frames))


def test_other_threads_run_while_it_works(desk):
    recording, frames = desk
    slam = made(recording)
    counted, stop = [0], threading.Event()

    def count():
        while not stop.is_set():
            counted[0] += 1
            time.sleep(0)  # releases the GIL if another thread waits for it

    thread = threading.Thread(target=count)
    before = sys.getswitchinterval()
    thread.start()
    try:
        sys.setswitchinterval(1000)  # disables forced switches
        ran = 0
        for frame in frames[:10]:
            start = counted[0]
            slam.track(frame.time, frame.image, depth=frame.depth)
            ran += counted[0] > start
    finally:
        sys.setswitchinterval(before)
        stop.set()
        thread.join()
    assert ran > 0


@pytest.mark.parametrize("schedule", ["inline", "threaded"])
def test_a_detector_that_raises_is_done_without(desk, schedule, caplog):
    recording, frames = desk
    called = threading.Event()

    def broken(image):
        called.set()
        raise ValueError("no idea")

    with made(recording, detector=broken, schedule=schedule) as slam:
        results = play(slam, frames[:15])
        assert called.wait(60)
        while slam.health()["detector"] is None:
            pass
        later = slam.track(frames[15].time, frames[15].image, depth=frames[15].depth)
    assert "ValueError: no idea" in slam.health()["detector"] and slam.health()["mapping"] is None
    assert all(result.pose is not None for result in [*results, later])
    assert "detector stopped" in later.warning
    assert any("the detector failed" in record.getMessage() for record in caplog.records)


@pytest.mark.parametrize("answer", [[("person", 0.9, 1, 2)], [("person", "high", 1, 2, 3, 4)], 7, None])
def test_a_detector_that_answers_nonsense_is_done_without(desk, answer, caplog):
    recording, frames = desk
    slam = made(recording, detector=lambda image: answer)
    assert play(slam, frames[:3])[-1].pose is not None
    assert slam.health()["detector"]


def test_a_detector_is_heard(desk):
    recording, frames = desk
    kept = []

    def detect(image):
        kept.append(image)
        return [(0, 0.5, -10.0, 100, 60, 50), ("teapot", 0.9, 0, 0, 9, 9)]

    slam = made(recording, detector=detect, settings={"dynamics.detector_every_frames": 1,
                                                      "dynamics.detector_latency_frames": 0})
    play(slam, [frames[0]])
    assert slam.detections()[1] == ("person", 0.5, 0.0, 100.0, 50.0, 50.0)  # clipped to the image
    assert slam.detections()[0][:1] == (-1,)
    numpy.testing.assert_array_equal(kept[0], frames[0].image)
    color = numpy.dstack([frames[1].image] * 3)
    slam.track(frames[1].time, frames[1].image, depth=frames[1].depth, color=color)
    numpy.testing.assert_array_equal(kept[1], color)
    assert slam.mover_mask().shape == (240, 320)


def test_ctrl_c_in_a_detector_is_not_the_detectors(desk):
    recording, frames = desk

    def interrupted(image):
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    slam = made(recording, detector=interrupted)
    try:
        with pytest.raises(KeyboardInterrupt):
            play(slam, frames[:3])
    finally:
        signal.signal(signal.SIGINT, before)
    assert slam.health()["detector"] is None


def test_a_thousand_come_and_go():
    camera = alidade.Camera(160, 120, 130, 130, 80, 60, depth_factor=1000)
    rng = numpy.random.default_rng(1)
    image = rng.integers(0, 255, (120, 160), dtype=numpy.uint8)
    depth = numpy.full((120, 160), 2000, numpy.uint16)

    def come_and_go(times):
        for i in range(times):
            schedule = "threaded" if i % 4 == 0 else "inline"
            slam = alidade.Slam(camera, sensor="rgbd", schedule=schedule, detector=lambda seen: [])
            slam.track(0.0, image, depth=depth)
            _ = slam.map().points
        del slam
        gc.collect()

    def megabytes():
        with open("/proc/self/statm", encoding="ascii") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGESIZE") / 1e6

    come_and_go(300)
    before = megabytes()
    come_and_go(1000)
    assert megabytes() - before < 8  # 8 kB per session
    assert len(os.listdir("/proc/self/task")) < 32


def test_the_interpreter_ends_with_a_detector_at_work():
    code = textwrap.dedent("""
        import numpy, time, alidade
        camera = alidade.Camera(160, 120, 130, 130, 80, 60, depth_factor=1000)
        slam = alidade.Slam(camera, sensor="rgbd", schedule="threaded", detector=lambda image: time.sleep(0.5) or [])
        image = numpy.random.default_rng(1).integers(0, 255, (120, 160), dtype=numpy.uint8)
        slam.track(0.0, image, depth=numpy.full((120, 160), 2000, numpy.uint16))
        print("done")
    """)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "done\n", "")
