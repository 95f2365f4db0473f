"""What helps at the prompt and in notebooks: help, suggestions, pictures, pickles."""

import base64
import copy
import dataclasses
import inspect
import pickle
import pydoc
import re

import pytest

import alidade
from conftest import DESK, play


@pytest.fixture(scope="module")
def result():
    return alidade.run(DESK, sensor="rgbd", last=19)


def test_help_has_every_field_with_shape_and_unit():
    text = pydoc.render_doc(alidade, renderer=pydoc.plaintext)
    for words in (r"covariance: Optional\[numpy.ndarray\]\s+\|\s+\(6, 6\) of the pose error.*m², m rad, rad²",
                  r"expected: int\s+\|\s+number of landmarks expected in view", r"matches: int\s+\|\s+number of landmarks",
                  r"depth: Optional\[numpy.ndarray\]\s+\|\s+RGB-D: \(h, w\) uint16 with camera.depth_factor per meter",
                  r"poses: numpy.ndarray\s+\|\s+\(n, 4, 4\) T_world_camera", r"folder\s*:\s+.*temporary folder"):
        assert re.search(words, text), words
    for name in alidade.__all__:
        item = getattr(alidade, name)
        if dataclasses.is_dataclass(item):
            for field in dataclasses.fields(item):
                told = re.search(rf"^{field.name}: .*\n    (\S.*)$", inspect.getdoc(item), re.M)
                assert told, (name, field.name)
        for attribute, value in vars(item).items() if isinstance(item, type) else ():
            if isinstance(value, property) and not attribute.startswith("_"):
                assert inspect.getdoc(value), (name, attribute)


def test_an_unknown_argument_suggests_the_one_that_was_meant(desk):
    camera = desk[0].camera
    with pytest.raises(alidade.UsageError, match="'semi_dense'; did you mean 'semidense'"):
        alidade.Slam(camera, semi_dense=True)
    with pytest.raises(alidade.UsageError, match="'recordd'; did you mean 'record'"):
        alidade.Slam(camera, recordd="x")
    with pytest.raises(alidade.UsageError, match="did you mean 'tracker.extractor.features'"):
        alidade.Slam(camera, **{"tracker.extractor.feature": 1})
    for call, name in [(alidade.run, "run"), (lambda *a, **b: alidade.localize(*a, "map", **b), "localize")]:
        with pytest.raises(TypeError, match=rf"{name}\(\) has no argument 'overwritten'; did you mean 'overwrite'\?"):
            call(DESK, overwritten=True)
    with pytest.raises(TypeError, match=r"open\(\) has no argument 'colour'; did you mean 'color'\?"):
        alidade.open(DESK, colour=True)
    with pytest.raises(TypeError, match="run.. has no argument 'zzzzzzzz'$"):
        alidade.run(DESK, zzzzzzzz=True)
    assert "semidense" in inspect.signature(alidade.run).parameters


def test_maps_are_pickled_and_copied(desk):
    recording, frames = desk
    slam = alidade.Slam(recording.camera, sensor="rgbd", semidense=True)
    play(slam, frames[:10])
    slam.finish()
    made = slam.map()
    again = pickle.loads(pickle.dumps(made))
    assert again.to_bytes() == made.to_bytes() and (again.points.positions == made.points.positions).all()
    assert copy.copy(made) is made and copy.deepcopy({"map": made})["map"] is made  # immutable, with its cloud
    assert pickle.loads(pickle.dumps(made.keyframes)).poses.shape == made.keyframes.poses.shape
    empty = alidade.Slam(recording.camera).map()
    assert pickle.loads(pickle.dumps(empty)).to_bytes() == empty.to_bytes()


def test_a_notebook_shows_the_picture_of_a_result(result, tmp_path):
    def picture_of(html):
        kind, data = re.search(r'src="data:image/(png|jpeg);base64,([^"]+)"', html).groups()
        return kind, base64.b64decode(data)

    html = result._repr_html_()
    kind, picture = picture_of(html)
    assert kind == "jpeg" and picture[:2] == b"\xff\xd8" and len(picture) > 5000
    assert "20 of 20 frames tracked" in html
    shape = alidade.run(DESK, sensor="rgbd", semidense=True, out=tmp_path / "a <b> & c")
    kind, picture = picture_of(shape._repr_html_())
    with open(shape.file("semidense.png"), "rb") as file:
        assert kind == "png" and picture == file.read()
    assert "a &lt;b&gt; &amp; c" in shape._repr_html_() and "<b>" not in shape._repr_html_()
