"""The package itself: warnings, types, documentation, the wheel."""

import ast
import inspect
import logging
import os
import pathlib
import pydoc
import re
import subprocess
import sys

import pytest

import alidade
from alidade import _core

ROOT = pathlib.Path(__file__).resolve().parents[2]
PACKAGE = pathlib.Path(alidade.__file__).parent


def test_help_teaches():
    text = pydoc.render_doc(alidade, renderer=pydoc.plaintext)
    for words in ("T_world_camera", "alidade.run", "meters", "slam.track(time, image, depth=depth)"):
        assert words in text
    for name in alidade.__all__:
        thing = getattr(alidade, name)
        assert inspect.getdoc(thing), name
    for name, thing in inspect.getmembers(alidade.Slam, inspect.isfunction):
        assert name.startswith("_") or inspect.getdoc(thing), name


def test_the_stubs_are_of_this_module():
    stubs = ast.parse((PACKAGE / "_core.pyi").read_text())
    told = {node.name: node for node in stubs.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    told_names = set(told) | {node.target.id for node in stubs.body if isinstance(node, ast.AnnAssign)}
    assert told_names == {name for name in dir(_core) if not name.startswith("__")}
    for name, node in told.items():
        if isinstance(node, ast.ClassDef):
            methods = {part.name for part in node.body if isinstance(part, ast.FunctionDef)} - {"__init__"}
            assert methods == {name for name in vars(getattr(_core, name)) if not name.startswith("_")}, name
    assert (PACKAGE / "py.typed").exists()
    # The whole public interface has types.
    for name in ("Slam", "Map", "MapPart", "Result", "Recording"):
        for method, function in inspect.getmembers(getattr(alidade, name), inspect.isfunction):
            assert method.startswith("_") or "return" in function.__annotations__, (name, method)
    for name in ("run", "localize", "open", "ate", "rpe", "depth_errors"):
        assert "return" in getattr(alidade, name).__annotations__


def test_the_types_agree():
    if subprocess.run([sys.executable, "-m", "mypy", "--version"], capture_output=True, check=False).returncode != 0:
        pytest.skip("mypy is not installed")
    done = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--ignore-missing-imports",
                           "--disable-error-code=type-arg", "--cache-dir", os.devnull, PACKAGE],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


def test_settings_have_the_names_of_the_program():
    assert alidade.settings()["tracker.extractor.features"] == "1000"
    assert re.fullmatch(r"\d+\.\d+\.\d+", alidade.__version__)
    with pytest.raises(ValueError):
        alidade.set_threads(-1)


def test_a_camera_goes_through_its_file(tmp_path):
    camera = alidade.Camera(640, 480, 525.5, 524, 319.5, 239.5, distortion=(0.1, -0.2, 0.001, 0.002, 0.05),
                            depth_factor=5000, readout=(0.0, 0.02))
    camera.to_yaml(tmp_path / "camera.yaml")
    assert alidade.Camera.from_yaml(tmp_path / "camera.yaml", sensor="rgbd") == camera
    assert alidade.Camera.from_fov(640, 480, 90).fx == pytest.approx(320)
    assert camera.matrix[0].tolist() == [525.5, 0, 319.5]
    (tmp_path / "fish.yaml").write_text("model: fisheye\nwidth: 320\nheight: 240\nfx: 100\nfy: 100\ncx: 160\ncy: 120\n"
                                        "distortion: [0.01, 0, 0, 0]\n")
    with pytest.raises(alidade.UsageError, match="Rectifier"):
        alidade.Camera.from_yaml(tmp_path / "fish.yaml")
    import numpy
    rectifier = alidade.Rectifier(tmp_path / "fish.yaml")
    image = rectifier.left(numpy.full((240, 320, 3), 9, numpy.uint8))
    assert image.shape == (rectifier.camera.height, rectifier.camera.width, 3) and image.max() == 9
    with pytest.raises(alidade.InputError, match="camera.yaml:1"):
        (tmp_path / "camera.yaml").write_text("width: wide\n")
        alidade.Camera.from_yaml(tmp_path / "camera.yaml")


def test_images_that_other_formats_hold_are_read_through_the_module(tmp_path):
    # BMP is read by libalidade_media, which must be found from Python.
    width, height = 64, 48
    rows = bytes(range(192)) * height
    head = b"BM" + (54 + len(rows)).to_bytes(4, "little") + bytes(4) + (54).to_bytes(4, "little")
    info = ((40).to_bytes(4, "little") + width.to_bytes(4, "little") + height.to_bytes(4, "little") +
            (1).to_bytes(2, "little") + (24).to_bytes(2, "little") + bytes(24))
    (tmp_path / "images").mkdir()
    for i in range(3):
        (tmp_path / "images" / f"{i:03}.bmp").write_bytes(head + info + rows)
    with alidade.open(tmp_path / "images", fov=60) as recording:
        frames = list(recording)
    assert len(frames) == 3 and frames[0].image.shape == (height, width) and frames[0].problem == ""


def test_the_examples_of_the_documentation_work(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "docs" / "guides" / "python.md").read_text()
    examples = re.findall(r"```python\n(.*?)```", text, re.S)
    assert len(examples) >= 8
    names = {}
    for example in examples:
        exec(compile(example, "docs/guides/python.md", "exec"), names)  # pylint: disable=exec-used


def test_a_wheel_is_made_without_a_network(tmp_path):
    if subprocess.run([sys.executable, "-m", "pip", "--version"], capture_output=True, check=False).returncode != 0:
        pytest.skip("pip is not installed")
    build = os.environ.get("ALIDADE_BUILD", "")
    if not os.path.isfile(os.path.join(build, "CMakeCache.txt")):
        pytest.skip("not told where the build is (ALIDADE_BUILD)")
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    environment.update(http_proxy="http://127.0.0.1:9", https_proxy="http://127.0.0.1:9")
    made = subprocess.run([sys.executable, "-m", "pip", "install", "--no-deps", "--target", tmp_path / "there", ROOT],
                          capture_output=True, text=True, env=environment, check=False)
    assert made.returncode == 0, made.stdout + made.stderr
    environment["PYTHONPATH"] = str(tmp_path / "there")
    code = ("import alidade; print(alidade.__file__); "
            "print(alidade.run('synth:desk?frames=3&width=320&height=240', sensor='rgbd').stats['tracked'])")
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment, check=False,
                         cwd=tmp_path)
    assert ran.stdout.splitlines() == [str(tmp_path / "there" / "alidade" / "__init__.py"), "3"], ran.stderr
    assert (tmp_path / "there" / "alidade" / "py.typed").exists()
    assert list((tmp_path / "there" / "alidade").glob("libalidade_media.so"))


def test_warnings_are_logged(tmp_path, caplog):
    with caplog.at_level(logging.WARNING, logger="alidade"):
        with pytest.raises(alidade.Error):
            alidade.run("synth:blank?frames=4&width=160&height=120&calibrated=0", sensor="mono", calibrate_first=False)
    assert caplog.records
