"""Shared fixtures: short rendered recordings that are mapped within a second."""

import os
import subprocess

import pytest

import alidade

DESK = "synth:desk?frames=40&width=320&height=240&seed=3"


@pytest.fixture(scope="session")
def desk():
    """RGB-D frames of a rendered desk."""
    with alidade.open(DESK, sensor="rgbd") as recording:
        frames = list(recording)
    return recording, frames


@pytest.fixture(scope="session")
def program():
    """A function that runs the program and returns its output."""
    binary = os.environ.get("ALIDADE_BINARY", "")
    if not os.path.isfile(binary):
        pytest.skip("the program is not built (ALIDADE_BINARY)")

    def call(*arguments):
        done = subprocess.run([binary, *map(str, arguments)], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return call


def read(folder, name):
    with open(os.path.join(os.fspath(folder), name), "rb") as file:
        return file.read()


def play(slam, frames, **more):
    """Tracks RGB-D frames."""
    return [slam.track(frame.time, frame.image, depth=frame.depth, stamp=frame.stamp, **more) for frame in frames]
