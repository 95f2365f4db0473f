"""Arrays of any layout give the results of a contiguous copy, or a TypeError that says what they are."""

import ctypes

import numpy
import pytest

import alidade
from conftest import play


def tensor(array, protocol):
    """What NumPy sees as an array by one protocol only, as tensors of PyTorch and others."""
    members = {
        "array": {"__array__": lambda self, dtype=None, copy=None: array},
        "interface": {"__array_interface__": array.__array_interface__, "kept": array},
        "dlpack": {"__dlpack__": lambda self, **more: array.__dlpack__(**more),
                   "__dlpack_device__": lambda self: array.__dlpack_device__()}}[protocol]
    return type("Tensor", (), members)()


def misaligned(array):
    """At an odd address."""
    memory = numpy.empty(array.nbytes + 1, numpy.uint8)
    there = memory[1:].view(array.dtype).reshape(array.shape)
    there[:] = array
    assert array.itemsize == 1 or not there.flags.aligned
    return there


def read_only(array):
    array = array.copy()
    array.flags.writeable = False
    return array


def wide(array):
    """A part of a larger array."""
    whole = numpy.full((array.shape[0] + 7, array.shape[1] + 9, *array.shape[2:]), 3, array.dtype)
    part = whole[3:3 + array.shape[0], 5:5 + array.shape[1]]
    part[:] = array
    return part


def record(array):
    """A field of an array of records."""
    records = numpy.zeros(array.shape, [("other", numpy.uint8), ("this", array.dtype), ("last", numpy.float32)])
    records["this"] = array
    return records["this"]


VIEWS = {
    "upside down": lambda array: array[::-1].copy()[::-1],
    "mirrored": lambda array: array[:, ::-1].copy()[:, ::-1],
    "turned": lambda array: array[::-1, ::-1].copy()[::-1, ::-1],
    "every second": lambda array: numpy.repeat(numpy.repeat(array, 2, 0), 2, 1)[::2, ::2],
    "part": wide,
    "transposed": lambda array: numpy.ascontiguousarray(array.swapaxes(0, 1)).swapaxes(0, 1),
    "Fortran": numpy.asfortranarray,
    "read-only": read_only,
    "record": record,
    "misaligned": misaligned,
    "__array__": lambda array: tensor(array, "array"),
    "__array_interface__": lambda array: tensor(array, "interface"),
    "__dlpack__": lambda array: tensor(array, "dlpack"),
    "memoryview": memoryview,
    "ctypes": lambda array: numpy.ctypeslib.as_array(
        (ctypes.c_uint8 * array.nbytes).from_buffer_copy(array.tobytes())).view(array.dtype).reshape(array.shape),
}


@pytest.fixture(scope="module")
def expected(desk):
    recording, frames = desk
    slam = alidade.Slam(recording.camera, sensor="rgbd", semidense=True)
    play(slam, frames[:8])
    slam.finish()
    return slam.map().to_bytes()


def mapped(desk, view_image, view_depth):
    recording, frames = desk
    slam = alidade.Slam(recording.camera, sensor="rgbd", semidense=True)
    for frame in frames[:8]:
        slam.track(frame.time, view_image(frame.image), depth=view_depth(frame.depth), stamp=frame.stamp)
    slam.finish()
    return slam.map().to_bytes()


@pytest.mark.parametrize("view", VIEWS.values(), ids=VIEWS.keys())
def test_any_layout_is_as_good_as_a_copy(desk, expected, view):
    assert mapped(desk, view, view) == expected


def test_depth_of_any_byte_order_and_precision(desk, expected):
    recording, frames = desk

    def same(array):
        return array

    assert frames[0].depth.dtype == numpy.uint16
    assert mapped(desk, same, lambda depth: depth.astype(">u2")) == expected
    assert mapped(desk, same, lambda depth: depth.astype("<u2")) == expected
    meters = [lambda depth, kind=kind: (depth / numpy.float32(recording.camera.depth_factor)).astype(kind)
              for kind in ("<f4", ">f4", "<f8", ">f8", "longdouble")]
    known = mapped(desk, same, meters[0])
    assert all(mapped(desk, same, one) == known for one in meters[1:])
    assert known != mapped(desk, same, lambda depth: (depth / 4000).astype("f4"))


def test_color_images_and_rectifiers(desk, tmp_path):
    _, frames = desk
    color = numpy.stack([frames[0].image, 255 - frames[0].image, frames[0].image // 2], axis=-1)
    (tmp_path / "fish.yaml").write_text("model: fisheye\nwidth: 320\nheight: 240\nfx: 100\nfy: 100\ncx: 160\ncy: 120\n"
                                        "distortion: [0.01, 0, 0, 0]\n")
    rectifier = alidade.Rectifier(tmp_path / "fish.yaml")
    known = rectifier.left(color)
    for name, view in VIEWS.items():
        numpy.testing.assert_array_equal(rectifier.left(view(color)), known, err_msg=name)
    numpy.testing.assert_array_equal(rectifier.left(numpy.moveaxis(color, -1, 0).copy().transpose(1, 2, 0)), known)
    depth = rectifier.depth(frames[0].depth)
    numpy.testing.assert_array_equal(rectifier.depth(frames[0].depth[::-1].copy()[::-1]), depth)
    numpy.testing.assert_array_equal(rectifier.depth(frames[0].depth.astype(">u2")), depth)


def test_other_types_and_shapes_are_type_errors_that_say_what_came(desk):
    recording, frames = desk
    image, depth = frames[0].image, frames[0].depth
    slam = alidade.Slam(recording.camera, sensor="rgbd")

    class OnAnotherDevice:
        def __array__(self, dtype=None, copy=None):
            raise TypeError("can't convert cuda:0 device type tensor to numpy")

    for given, words in [
            (dict(image=image.astype(float)), r"image must be .* not \(240, 320\) of float64"),
            (dict(image=image.astype(numpy.int8)), r"image must be .* not \(240, 320\) of int8"),
            (dict(image=image.astype(numpy.uint16)), r"image must be .* of uint16"),
            (dict(image=image > 3), r"of bool"),
            (dict(image=numpy.stack([image] * 3)), r"\(3, 240, 320\) of uint8; numpy.moveaxis\(image, 0, -1\)"),
            (dict(image=OnAnotherDevice()), r"image cannot be read as an array: can't convert cuda:0"),
            (dict(image=None), "image"), (dict(image=3), "image must be an array, not a int"),
            (dict(image=object()), "image must be an array, not a object"),
            (dict(image=image, depth=depth.astype(numpy.int32)), r"depth must be .* not \(240, 320\) of int32"),
            (dict(image=image, depth=depth.astype(complex)), r"depth must be .* of complex128"),
            (dict(image=image, depth=depth[..., None]), r"depth must be .* not \(240, 320, 1\) of uint16"),
            (dict(image=image, depth=depth, color=image.astype(float)), r"color must be .* of float64"),
            (dict(image=image, depth=depth, stamp=image), r"stamp must be a str, not an array \(240, 320\) of uint8"),
            (dict(t=image, image=image, depth=depth), r"t must be a number, not an array \(240, 320\) of uint8"),
            (dict(t="1", image=image, depth=depth), "t must be a number, not '1'")]:
        with pytest.raises((TypeError, alidade.InputError), match=words) as caught:
            slam.track(**{"t": 0.0, **given})
        assert isinstance(caught.value, TypeError) or given.get("image", 0) is None
        assert len(str(caught.value)) < 300 and "\n" not in str(caught.value)  # not the array itself
    assert slam.frames == 0
    for call, words in [
            (lambda: alidade.ate(image, numpy.zeros((3, 8))), r"truth must be \(n, 8\).* \(240, 320\) of uint8"),
            (lambda: alidade.ate(numpy.tile([0, 0, 0, 0, 0, 0, 0, 1], (3, 1)), "path"), "estimate must be an array, not a str"),
            (lambda: alidade.write_trajectory("x", numpy.zeros((3, 7))), r"trajectory must be \(n, 8\)"),
            (lambda: alidade.Slam(image), r"camera must be .* not an array \(240, 320\) of uint8"),
            (lambda: slam.load(image), r"map must be a path"), (lambda: slam.trajectory(image), "part must be"),
            (lambda: alidade.run(image), r"source must be a path .* not an array \(240, 320\) of uint8"),
            (lambda: slam.finish(limit=image), "limit must be a number"),
            (lambda: alidade.Map.from_bytes(image), "data must be bytes, not an array"),
            (lambda: slam.leave_out(image.astype(float)), "mask must be")]:
        with pytest.raises(TypeError, match=words) as caught:
            call()
        assert "\n" not in str(caught.value)
    with pytest.raises(alidade.UsageError, match=r"sensor cannot be an array \(240, 320\) of uint8"):
        alidade.Slam(recording.camera, sensor=image)
    assert slam.track(numpy.float32(0), image, depth=depth).state == "tracking"  # a number of NumPy is one


def test_images_that_the_sensor_does_not_have_are_refused(desk):
    recording, frames = desk
    image, depth = frames[0].image, frames[0].depth
    for sensor, given, name in [("mono", dict(depth=depth), "depth"), ("mono", dict(right=image), "right"),
                                ("mono", dict(right=depth), "right"), ("rgbd", dict(depth=depth, right=image), "right"),
                                ("stereo", dict(right=image, depth=depth), "depth")]:
        camera = alidade.Camera(320, 240, 262, 262, 160, 120, baseline=0.1, depth_factor=5000)
        slam = alidade.Slam(camera, sensor=sensor)
        with pytest.raises(ValueError, match=f'^{name}= is given, but this Slam has sensor="{sensor}"'):
            slam.track(0.0, image, **given)
        assert slam.frames == 0
