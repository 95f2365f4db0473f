"""Whole runs: the same results as the program, and interrupted runs."""

import inspect
import os
import re
import signal
import subprocess
import sys
import textwrap
import urllib.request

import numpy
import pytest

import alidade
from conftest import DESK, read


@pytest.mark.parametrize("sensor", ["mono", "rgbd"])
def test_all_levels_give_the_bytes_of_the_program(tmp_path, program, sensor):
    features = {"tracker.extractor.features": 700}
    program("run", DESK, "--sensor", sensor, "--semidense", "--set", "tracker.extractor.features=700", "--seed", 5,
            "--out", tmp_path / "program", "--quiet")
    result = alidade.run(DESK, sensor=sensor, semidense=True, settings=features, seed=5, out=tmp_path / "python")
    for name in ("trajectory.txt", "trajectory_live.txt", "keyframes.txt", "map.alidade", "semidense.ply"):
        assert read(tmp_path / "program", name) == read(tmp_path / "python", name), name

    with alidade.open(DESK, sensor=sensor, color=True) as recording:
        with alidade.Slam(recording.camera, sensor=sensor, semidense=True, settings=features, seed=5,
                          mounting=recording.mounting) as slam:
            for frame in recording:
                slam.track(frame.time, frame.image, depth=frame.depth, color=frame.color, stamp=frame.stamp)
    slam.save_trajectory(tmp_path / "slam.txt")
    assert read(tmp_path, "slam.txt") == read(tmp_path / "program", "trajectory.txt")
    slam.save(tmp_path / "slam.alidade")
    assert read(tmp_path, "slam.alidade") == read(tmp_path / "program", "map.alidade")
    numpy.testing.assert_allclose(slam.trajectory(), result.trajectory, rtol=0, atol=1e-6)  # files have rounded numbers

    saved = alidade.Map.load(tmp_path / "program")
    assert saved.to_bytes() == read(tmp_path / "program", "map.alidade")
    numpy.testing.assert_array_equal(saved.keyframes.poses, slam.map().keyframes.poses)
    found = alidade.localize(DESK, slam.map(), sensor=sensor, out=tmp_path / "found")
    program("localize", DESK, "--sensor", sensor, "--map", tmp_path / "program", "--out", tmp_path / "found_program",
            "--quiet")
    assert read(found.folder, "trajectory.txt") == read(tmp_path / "found_program", "trajectory.txt")


def test_a_result_has_what_the_run_left(tmp_path):
    told = []
    result = alidade.run(DESK, sensor="rgbd", progress=told.append)
    assert result.trajectory.shape == (40, 8) and result.trajectory_live.shape == (40, 8)
    assert result.stats["tracked"] == 40 and result.stats["sensor"] == "rgbd"
    assert result.groundtruth.shape == (40, 8)
    error = alidade.ate(result.groundtruth, result)
    assert error.rmse < 0.02 and (error.align, error.align_why) == ("se3", "depth or stereo")
    assert result.keyframes.shape[0] == len(result.map.keyframes.ids)
    assert told[-1].frames == 40 and told[-1].total == 40 and told[-1].stage == "finishing"
    assert "40 of 40 frames" in repr(result)
    folder = result.folder
    result.save(tmp_path / "kept")
    numpy.testing.assert_array_equal(alidade.Result(tmp_path / "kept").trajectory, result.trajectory)
    del result
    assert not os.path.exists(folder)


def test_a_run_goes_to_mcap_as_it_happens_and_afterwards(tmp_path, program):
    result = alidade.run(DESK, sensor="rgbd", semidense=True, record_to=tmp_path / "live.mcap", out=tmp_path / "run")
    assert read(tmp_path, "live.mcap")[:8] == b"\x89MCAP0\r\n" == read(tmp_path, "live.mcap")[-8:]
    said = result.export(tmp_path / "result.mcap")
    assert said.startswith("40 frames, ") and "semi-dense points" in said
    program("export", result.folder, tmp_path / "program.mcap", "--to", "mcap")
    assert read(tmp_path, "result.mcap") == read(tmp_path, "program.mcap")
    assert result.export(tmp_path / "points.ply") == f"{len(result.map.points.ids)} points, in meters"

    recorded = alidade.run(DESK, sensor="rgbd", semidense=True, record=True)
    recorded.export(tmp_path / "stream.mcap")
    assert len(read(tmp_path, "stream.mcap")) > 1.5 * len(read(tmp_path, "result.mcap"))  # images, frames
    with pytest.raises(alidade.UsageError, match="to="):
        result.export(tmp_path / "model")
    with pytest.raises(alidade.UsageError, match="min-observations"):
        result.export(tmp_path / "other.mcap", min_observations=3)
    with pytest.raises(alidade.InputError):
        result.export(tmp_path / "nowhere" / "run.mcap")


def test_one_cameras_result_is_scaled_unless_it_is_said_otherwise(tmp_path):
    result = alidade.run(DESK, sensor="mono")
    error, drift = alidade.ate(result.groundtruth, result), alidade.rpe(result.groundtruth, result)
    assert (error.align, error.align_why) == (drift.align, drift.align_why) == ("sim3", "one camera")
    assert error.rmse == alidade.ate(result.groundtruth, result, align="sim3").rmse
    assert error.rmse < alidade.ate(result.groundtruth, result, align="se3").rmse
    assert alidade.ate(result.groundtruth, result.trajectory).align == "se3"  # numbers alone do not say


def test_a_result_is_not_replaced_by_less(tmp_path):
    out = tmp_path / "out"
    whole = alidade.run(DESK, sensor="rgbd", out=out).map.to_bytes()
    with pytest.raises(alidade.InputError, match="last-attempt") as less:
        alidade.run(DESK, sensor="rgbd", last=9, out=out)
    assert less.value.result.folder == str(out / "last-attempt")
    assert less.value.result.stats["frames"] == 10
    with pytest.raises(alidade.InputError, match="overwrite"):
        alidade.run(DESK + "&light=0.9", sensor="rgbd", out=out)
    assert read(out, "map.alidade") == whole
    assert alidade.run(DESK, sensor="rgbd", last=9, out=out, overwrite=True).stats["frames"] == 10


def test_errors_are_pythons(tmp_path):
    with pytest.raises(alidade.UsageError, match="tracker.extractor.features") as wrong:
        alidade.run(DESK, settings={"tracker.extractor.feature": 1})
    assert isinstance(wrong.value, ValueError) and wrong.value.kind == "usage" and wrong.value.status == 2
    with pytest.raises(alidade.InputError) as missing:
        alidade.run(tmp_path / "nothing")
    assert missing.value.kind == "input" and missing.value.status == 3
    with pytest.raises(alidade.NothingMapped) as nothing:
        alidade.run("synth:blank?frames=5&width=160&height=120", sensor="mono", out=tmp_path / "blank")
    assert nothing.value.result.stats["tracked"] == 0
    with pytest.raises(TypeError):
        alidade.run(DESK, semi_dense=True)
    with pytest.raises(alidade.UsageError, match="sensor"):
        alidade.run(DESK, sensor="lidar")


@pytest.mark.parametrize("command, function", [("run", alidade.run), ("localize", alidade.localize)])
def test_every_option_of_the_program_is_here(program, command, function):
    names = set(re.findall(r"--([a-z][a-z-]+)", program(command, "--help").split("Examples:")[0]))
    names -= {"help", "quiet", "no-calibrate-first"}
    names -= {"poses"}  # for other processes; Slam.track() returns them
    ours = set(inspect.signature(function).parameters)
    known = {name.replace("-", "_") for name in names} - {"set"}
    assert len(known) > 15 and not known - ours
    assert "settings" in ours and "progress" in ours


def test_what_progress_raises_ends_the_run():
    class Enough(Exception):
        pass

    def stop(progress):
        if progress.frames > 5:
            raise Enough

    with pytest.raises(Enough) as stopped:
        alidade.run("synth:desk?frames=100000&width=320&height=240", sensor="rgbd", progress=stop)
    assert 5 < stopped.value.result.stats["frames"] < 100000
    assert alidade.run(DESK, sensor="rgbd", last=4).stats["frames"] == 5  # the next run is not interrupted


def test_ctrl_c_leaves_the_results(tmp_path):
    code = textwrap.dedent("""
        import signal, sys, alidade
        signal.signal(signal.SIGINT, signal.default_int_handler)  # may be ignored by who started us
        told = lambda p: (p.frames > 5 and print("running", flush=True))
        try:
            alidade.run("synth:desk?frames=100000&width=320&height=240", sensor="rgbd", out=sys.argv[1], progress=told)
        except KeyboardInterrupt as stopped:
            print("stopped", stopped.result.stats["frames"])
    """)
    child = subprocess.Popen([sys.executable, "-c", code, tmp_path / "out"], stdout=subprocess.PIPE, text=True)
    assert child.stdout.readline() == "running\n"
    child.send_signal(signal.SIGINT)
    rest = child.communicate(timeout=120)[0].splitlines()
    assert child.returncode == 0 and rest[-1].startswith("stopped ")
    assert alidade.Result(tmp_path / "out").trajectory.shape[1] == 8


def test_a_detector_that_is_a_function(tmp_path):
    shapes = []

    def detect(image):
        shapes.append(image.shape)
        return [("person", 0.9, 10, 20, 30, 40)]

    result = alidade.run(DESK, sensor="rgbd", detector=detect, last=9)
    assert result.stats["settings"]["dynamics.mode"] == "full" and result.stats["tracked"] == 10
    assert set(shapes) == {(240, 320)}  # rendered recordings are gray


def test_the_stream_is_recorded(tmp_path):
    result = alidade.run(DESK, sensor="rgbd", last=9, record=True, out=tmp_path / "out")
    assert read(result.folder, "run.stream").startswith(b"ALIDSTR1")


def test_the_viewer_serves_while_it_runs():
    if not os.path.isfile(os.path.join(os.path.dirname(alidade.__file__), "libalidade_serve.so")):
        pytest.skip("built without the viewer")
    answers = []

    def look(progress):
        if progress.viewer and not answers:
            with urllib.request.urlopen(progress.viewer, timeout=60) as page:
                answers.append(page.status)

    alidade.run(DESK, sensor="rgbd", last=9, viewer=True, port=0, progress=look)
    assert answers == [200]


def test_the_port_and_the_file_as_version_0_1_had_them_are_accepted_with_a_warning(tmp_path):
    with pytest.warns(DeprecationWarning, match="record_to=PATH"):
        alidade.run(DESK, sensor="rgbd", last=3, record=tmp_path / "old.stream")
    assert read(tmp_path, "old.stream").startswith(b"ALIDSTR1")
    with pytest.warns(DeprecationWarning, match="port=PORT"), pytest.raises(alidade.Error, match="65535"):
        alidade.run(DESK, sensor="rgbd", last=3, viewer=70000)


def test_keys_of_stats_have_their_new_name_and_are_found_under_the_old_one(tmp_path):
    result = alidade.run(DESK, sensor="rgbd", last=3, out=tmp_path / "new")
    assert result.stats["initialized_at"] == 0 and "initialised_at" not in result.stats
    with pytest.warns(DeprecationWarning, match="initialized_at"):
        assert result.stats["initialised_at"] == 0
    old = tmp_path / "old"
    old.mkdir()
    (old / "stats.json").write_text('{"initialised_at": 7, "relocalisations": 2}')
    assert alidade.Result(old).stats["initialized_at"] == 7 and alidade.Result(old).stats["relocalizations"] == 2


def test_a_port_without_a_viewer_is_refused():
    with pytest.raises(alidade.Error, match="--port"):
        alidade.run(DESK, sensor="rgbd", last=3, port=8090)


@pytest.mark.skipif("ALIDADE_DATA" not in os.environ, reason="ALIDADE_DATA names no real recordings")
@pytest.mark.parametrize("name", ["kitchen", "euroc_micro"])  # RGB-D; an unrectified stereo pair
def test_a_real_recording_gives_the_bytes_of_the_program(tmp_path, program, name):
    source = os.path.join(os.environ["ALIDADE_DATA"], name)
    if not os.path.isdir(source):
        pytest.skip(f"no recording '{name}'")
    program("run", source, "--last", 39, "--out", tmp_path / "program", "--quiet")
    result = alidade.run(source, last=39)
    with alidade.open(source, last=39) as recording:
        with alidade.Slam(recording.camera, sensor=recording.sensor, mounting=recording.mounting) as slam:
            for frame in recording:
                slam.track(frame.time, frame.image, depth=frame.depth, right=frame.right, stamp=frame.stamp)
    slam.save_trajectory(tmp_path / "slam.txt")
    theirs = read(tmp_path / "program", "trajectory.txt")
    assert read(result.folder, "trajectory.txt") == theirs == read(tmp_path, "slam.txt")
    assert slam.map().to_bytes() == read(tmp_path / "program", "map.alidade")
    numpy.testing.assert_array_equal(result.trajectory, numpy.loadtxt(tmp_path / "program" / "trajectory.txt"))
