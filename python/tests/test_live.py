"""A Slam that is fed frames is seen in a browser and recorded: with the real server, sockets and program."""

import base64
import os
import re
import socket
import struct
import subprocess
import sys
import textwrap
import urllib.error
import urllib.request

import pytest

import alidade
from conftest import play, read

HELLO, FRAME, MAP_CHANGE, EVENT, PLAYBACK = range(1, 6)  # of the union Body in stream.fbs


class WebSocket:
    """Receives the messages of a viewer's stream as a browser does."""

    def __init__(self, address):
        host, port = re.match(r"http://([\d.]+):(\d+)/", address).groups()
        self.socket = socket.create_connection((host, int(port)), timeout=60)
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall((f"GET /stream HTTP/1.1\r\nHost: {host}:{port}\r\nUpgrade: websocket\r\n"
                             f"Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\n"
                             f"Origin: http://{host}:{port}\r\n\r\n").encode())
        self.file = self.socket.makefile("rb")
        assert b" 101 " in self.file.readline()
        while self.file.readline() not in (b"\r\n", b""):
            pass

    def message(self):
        """The next message of the stream; None when the server closes."""
        whole = b""
        while True:
            first, length = self.file.read(2) or (0x88, 0)
            if length == 126:
                length, = struct.unpack(">H", self.file.read(2))
            elif length == 127:
                length, = struct.unpack(">Q", self.file.read(8))
            payload = self.file.read(length)
            if first & 15 == 8:  # close
                return None
            if first & 15 in (0, 2):
                whole += payload
                if first & 0x80:
                    return whole

    def close(self):
        self.file.close()
        self.socket.close()


def field(data, table, number):
    """Position of a field of a FlatBuffers table; 0: it has its default value."""
    vtable = table - struct.unpack_from("<i", data, table)[0]
    if 4 + 2 * number + 2 > struct.unpack_from("<H", data, vtable)[0]:
        return 0
    offset, = struct.unpack_from("<H", data, vtable + 4 + 2 * number)
    return table + offset if offset else 0


def body(data):
    """Kind and table of a message."""
    assert data[4:8] == b"ALST"
    root, = struct.unpack_from("<I", data, 0)
    kind = data[field(data, root, 0)]
    at = field(data, root, 1)
    return kind, at + struct.unpack_from("<I", data, at)[0]


def number_of(data):
    """The frame number of a message of kind FRAME."""
    at = field(data, body(data)[1], 0)
    return struct.unpack_from("<i", data, at)[0] if at else 0


def finished(data):
    kind, table = body(data)
    at = field(data, table, 1)
    return kind == PLAYBACK and bool(at) and data[at] == 1


def stream_in(path):
    """The messages of a run.stream."""
    data = path.read_bytes()
    assert data[:8] == b"ALIDSTR1"
    messages, at = [], 8
    while at < len(data):
        length, zero = struct.unpack_from("<II", data, at)
        assert zero == 0
        messages.append(data[at + 8:at + 8 + length])
        at += 8 + (length + 7) // 8 * 8
    return messages


def frames_of(messages):
    return [number_of(message) for message in messages if body(message)[0] == FRAME]


def made(recording, **more):
    return alidade.Slam(recording.camera, sensor="rgbd", **more)


def test_a_browser_sees_each_frame_as_it_comes(desk):
    recording, frames = desk
    slam, alone = made(recording), made(recording)
    expected = play(alone, frames)
    address = slam.view()
    assert slam.view(port=1) == address  # it is served already
    page = urllib.request.urlopen(address, timeout=60)
    assert page.status == 200 and page.read(15).lower() == b"<!doctype html>"
    viewer = WebSocket(address)
    assert body(viewer.message())[0] == HELLO
    for frame, known in zip(frames, expected):
        result = slam.track(frame.time, frame.image, depth=frame.depth, stamp=frame.stamp)
        assert (result.pose == known.pose).all()  # being seen changes nothing
        message = viewer.message()
        while body(message)[0] != FRAME:
            message = viewer.message()
        assert number_of(message) == result.frame
    slam.finish()
    message = viewer.message()
    while not finished(message):
        message = viewer.message()
    # More frames may follow.
    later = frames[-1]
    slam.track(later.time + 1 / 30, later.image, depth=later.depth)
    message = viewer.message()
    while body(message)[0] != FRAME:
        message = viewer.message()
    assert number_of(message) == len(frames)
    # Who comes late sees the whole map.
    late = WebSocket(address)
    assert [body(late.message())[0] for _ in range(2)] == [HELLO, MAP_CHANGE]
    late.close()
    slam.close()
    while viewer.message() is not None:
        pass
    viewer.close()
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(address, timeout=60)
    with pytest.raises(alidade.UsageError, match="closed"):
        slam.view()


def pictures_of(messages):
    """The JPEG files in messages of kind FRAME."""
    found = []
    for message in messages:
        kind, table = body(message)
        at = field(message, table, 19) if kind == FRAME else 0
        if at:
            picture = at + struct.unpack_from("<I", message, at)[0]
            at = field(message, picture, 3)
            at += struct.unpack_from("<I", message, at)[0]
            found.append(message[at + 4:at + 4 + struct.unpack_from("<I", message, at)[0]])
    return found


def test_images_may_be_used_again(desk, tmp_path):
    recording, frames = desk
    buffer = frames[0].image.copy()
    with made(recording, record=tmp_path / "kept.stream") as kept, made(recording, record=tmp_path / "a.stream") as again:
        for frame in frames[:20]:
            kept.track(frame.time, frame.image, depth=frame.depth)
            buffer[:] = frame.image
            again.track(frame.time, buffer, depth=frame.depth)
            buffer[:] = 0
    expected = pictures_of(stream_in(tmp_path / "kept.stream"))
    assert len(expected) > 3 and expected[0][:2] == b"\xff\xd8"
    assert expected == pictures_of(stream_in(tmp_path / "a.stream"))


def test_a_recording_is_what_a_run_records(desk, tmp_path, program):
    recording, frames = desk
    with made(recording, record=tmp_path / "live") as slam:
        play(slam, frames)
        assert not (tmp_path / "live" / "run.stream").exists()  # not complete yet
    recorded = stream_in(tmp_path / "live" / "run.stream")
    assert frames_of(recorded) == list(range(len(frames)))
    assert finished(recorded[-1])
    assert f"{len(frames)} frames" in program("export", tmp_path / "live", "--to", "mcap", tmp_path / "live.mcap")
    # All kinds of messages, in the order of `run --record`.
    program("run", "synth:desk?frames=40&width=320&height=240&seed=3", "--sensor", "rgbd", "--record", "--quiet", "--out",
            tmp_path / "run")
    assert frames_of(stream_in(tmp_path / "run" / "run.stream")) == frames_of(recorded)


def test_a_recording_begins_and_ends_when_told(desk, tmp_path):
    recording, frames = desk
    slam = made(recording)
    play(slam, frames[:10])
    slam.record(tmp_path / "part.stream")
    with pytest.raises(alidade.UsageError, match="going on"):
        slam.record(tmp_path / "other.stream")
    play(slam, frames[10:20])
    slam.finish()
    play(slam, frames[20:25])
    assert frames_of(stream_in(tmp_path / "part.stream")) == list(range(10, 20))
    slam.record(tmp_path / "rest.mcap")
    play(slam, frames[25:])
    slam.close()
    assert read(tmp_path, "rest.mcap").endswith(b"\x89MCAP0\r\n")
    with pytest.raises(RuntimeError, match="stop here"):
        with made(recording, record=tmp_path / "failed.stream") as slam:
            play(slam, frames[:5])
            raise RuntimeError("stop here")
    assert frames_of(stream_in(tmp_path / "failed.stream")) == list(range(5))


def test_places_that_cannot_be_recorded_to(desk, tmp_path):
    recording, _ = desk
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "stats.json").write_text("{}")
    (tmp_path / "file").write_text("mine")
    slam = made(recording)
    for place, words in [(tmp_path / "run", "results of a run"), (tmp_path / "file", "is a file"),
                         (tmp_path / "none" / "a.stream", "cannot be written"), (tmp_path / "file" / "x", "file")]:
        with pytest.raises(alidade.Error, match=words):
            slam.record(place)
    assert (tmp_path / "file").read_text() == "mine"
    with pytest.raises(TypeError, match="port must be a whole number"):
        slam.view(port="any")
    taken = socket.create_server(("127.0.0.1", 0))
    with taken, pytest.raises(alidade.UsageError, match=str(taken.getsockname()[1])):
        slam.view(port=taken.getsockname()[1])
    assert slam.view().startswith("http://127.0.0.1:")  # failing changed nothing
    slam.close()


def test_a_forked_process_has_no_viewer():
    code = textwrap.dedent("""
        import os, sys, numpy, alidade
        camera = alidade.Camera(160, 120, 130, 130, 80, 60)
        slam = alidade.Slam(camera)
        slam.view()
        child = os.fork()
        if child == 0:
            try:
                slam.track(0.0, numpy.zeros((120, 160), numpy.uint8))
                os._exit(1)
            except alidade.UsageError:
                sys.exit(7)
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
        slam.track(0.0, numpy.zeros((120, 160), numpy.uint8))
        print("done")
    """)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "done\n", "")


def test_the_interpreter_ends_with_a_viewer_and_a_recording(tmp_path):
    code = textwrap.dedent(f"""
        import numpy, alidade
        slam = alidade.Slam(alidade.Camera(160, 120, 130, 130, 80, 60), record={str(tmp_path / "a.stream")!r})
        slam.view()
        slam.track(0.0, numpy.zeros((120, 160), numpy.uint8))
        print("done")
    """)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "done\n", "")
    assert frames_of(stream_in(tmp_path / "a.stream")) == [0]
