"""Uses of Slam that would wait for ever: its own detector, and forked processes."""

import subprocess
import sys
import textwrap

import pytest


def run(code):
    """Runs a program with `slam(**options)` and `track(slam, i)`; it must end by itself."""
    begin = """
        import os, sys, threading, time, numpy, alidade
        camera = alidade.Camera(160, 120, 130, 130, 80, 60, depth_factor=1000)
        image = numpy.random.default_rng(1).integers(0, 255, (120, 160), dtype=numpy.uint8)
        depth = numpy.full((120, 160), 2000, numpy.uint16)
        def slam(**options):
            return alidade.Slam(camera, sensor="rgbd", **options)
        def track(one, i):
            return one.track(i / 30, image, depth=depth)
    """
    text = textwrap.dedent(begin) + textwrap.dedent(code)
    return subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=30, check=False)


@pytest.mark.parametrize("schedule", ["inline", "threaded"])
@pytest.mark.parametrize("call", ["track(one, 9)", "one.finish()", "one.reset()", "one.trajectory()", "one.close()",
                                  "one.load(alidade.Map.from_bytes(data))"])
def test_a_detector_cannot_drive_its_own_slam(schedule, call):
    done = run(f"""
        data = b""
        first = slam()
        track(first, 0)
        data = first.map().to_bytes()
        seen, called = [], threading.Event()
        def detect(picture):
            try:
                {call}
            except alidade.UsageError as error:
                seen.append(str(error))
            called.set()
            one.features(), one.counts(), one.frames
            return []
        one = slam(detector=detect, schedule="{schedule}")
        track(one, 0)
        assert called.wait(30)
        track(one, 1)
        one.finish()
        assert "detector" in seen[0], seen
        assert one.health()["detector"] is None, one.health()
        print("done")
    """)
    assert (done.returncode, done.stdout, done.stderr) == (0, "done\n", "")


def test_a_detector_may_drive_another_slam():
    done = run("""
        other = slam()
        one = slam(detector=lambda picture: [track(other, other.frames)] and [])
        for i in range(3):
            track(one, i)
        assert one.health()["detector"] is None and other.frames > 0
        print("done")
    """)
    assert (done.returncode, done.stdout, done.stderr) == (0, "done\n", "")


def test_the_detector_of_a_run_cannot_start_another():
    done = run("""
        desk = "synth:desk?frames=20&width=320&height=240&seed=3"
        seen = []
        def detect(picture):
            try:
                alidade.run(desk, sensor="rgbd")
            except alidade.UsageError as error:
                seen.append(str(error))
            return []
        alidade.run(desk, sensor="rgbd", detector=detect)
        assert "detector" in seen[0], seen
        print("done")
    """)
    assert (done.returncode, done.stdout, done.stderr) == (0, "done\n", "")


def test_a_threaded_slam_in_a_forked_process():
    done = run("""
        one = slam(schedule="threaded", detector=lambda picture: [])
        for i in range(5):
            track(one, i)
        child = os.fork()
        if child == 0:
            for use in (lambda: track(one, 5), one.finish, one.trajectory, one.map, lambda: one.settings):
                try:
                    use()
                    os._exit(1)
                except alidade.UsageError as error:
                    assert "fork" in str(error), error
            one.close()
            mine = slam(schedule="threaded")
            for i in range(5):
                track(mine, i)
            mine.finish()
            del one
            sys.exit(7)  # with the interpreter's usual end
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
        track(one, 5)
        one.finish()
        print("done")
    """)
    assert (done.returncode, done.stdout, done.stderr) == (0, "done\n", "")


def test_a_recording_in_a_forked_process():
    done = run("""
        recording = alidade.open("synth:desk?frames=40&width=160&height=120&seed=3", sensor="rgbd")
        next(recording)
        child = os.fork()
        if child == 0:
            try:
                next(recording)
                os._exit(1)
            except alidade.UsageError as error:
                assert "fork" in str(error), error
            recording.close()
            del recording
            sys.exit(7)
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
        assert len(list(recording)) == 39
        print("done")
    """)
    assert (done.returncode, done.stdout, done.stderr) == (0, "done\n", "")


def test_an_inline_slam_goes_on_in_a_forked_process():
    done = run("""
        one = slam()
        for i in range(5):
            track(one, i)
        child = os.fork()
        track(one, 5)
        one.finish()
        if child == 0:
            sys.exit(7)
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
        print("done")
    """)
    assert (done.returncode, done.stdout, done.stderr) == (0, "done\n", "")
