#!/usr/bin/python3
"""write_bag.py FOLDER OUT.bag none|bz2|lz4: converts a TUM RGB-D folder to a ROS 1 bag with rosbag.

Images are CompressedImage messages with the unchanged bytes of the files; CameraInfo is from camera.yaml. Depth is Image
(16UC1); large images, which plain Python decodes slowly, are compressedDepth.
"""
import struct
import sys
import zlib

import genpy
import rosbag
from sensor_msgs.msg import CameraInfo, CompressedImage, Image


def camera_of(folder):
    camera = {}
    for line in open(folder + "/camera.yaml"):
        name, _, value = line.split("#")[0].partition(":")
        if value.strip() and not value.strip().startswith("["):
            camera[name.strip()] = value.strip()
    return {name: float(camera[name]) for name in ("width", "height", "fx", "fy", "cx", "cy")}


def stamped(folder, name):
    for line in open(folder + "/" + name):
        if line.strip() and not line.startswith("#"):
            stamp, path = line.split()
            seconds, _, digits = stamp.partition(".")
            yield genpy.Time(int(seconds), int(digits.ljust(9, "0"))), folder + "/" + path


def depth_of(data):
    """Width, height and the 16-bit little-endian samples of a PNG."""
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, bits, color = struct.unpack(">IIBB", body[:10])
            assert bits == 16 and color == 0
        packed += body if kind == b"IDAT" else b""
        at += 12 + length
    raw, stride = zlib.decompress(packed), 2 * width
    above, rows = bytearray(stride), []
    for y in range(height):
        kind = raw[y * (stride + 1)]
        row = bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        if kind:
            for x in range(stride):
                a = row[x - 2] if x >= 2 else 0
                b = above[x]
                c = above[x - 2] if x >= 2 else 0
                p = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
                row[x] = (row[x] + (0, a, b, (a + b) // 2, p)[kind]) & 255
        rows.append(bytes(row))
        above = row
    samples = bytearray(b"".join(rows))
    samples[0::2], samples[1::2] = samples[1::2], samples[0::2]
    return width, height, bytes(samples)


def main(folder, out, compression):
    camera = camera_of(folder)
    items = [(time, 0, path) for time, path in stamped(folder, "rgb.txt")]
    items += [(time, 1, path) for time, path in stamped(folder, "depth.txt")]
    with rosbag.Bag(out, "w", compression=compression, chunk_threshold=200000) as bag:
        for time, is_depth, path in sorted(items):
            data = open(path, "rb").read()
            raw = is_depth and camera["width"] < 200
            message = Image() if raw else CompressedImage()
            message.header.stamp = time
            message.header.frame_id = "camera"
            if raw:
                message.width, message.height, message.data = depth_of(data)
                message.encoding, message.step = "16UC1", 2 * message.width
                bag.write("/camera/depth/image_raw", message, time)
                continue
            if is_depth:
                message.format = "16UC1; compressedDepth png"
                message.data = b"\0" * 12 + data
                bag.write("/camera/depth/image_raw/compressedDepth", message, time)
                continue
            message.format = "jpeg" if path.endswith("jpg") else "png"
            message.data = data
            bag.write("/camera/rgb/image_raw/compressed", message, time)
            info = CameraInfo()
            info.header = message.header
            info.width, info.height = int(camera["width"]), int(camera["height"])
            info.distortion_model, info.D = "plumb_bob", [0.0] * 5
            info.K = [camera["fx"], 0, camera["cx"], 0, camera["fy"], camera["cy"], 0, 0, 1]
            info.R = [1, 0, 0, 0, 1, 0, 0, 0, 1]
            info.P = [camera["fx"], 0, camera["cx"], 0, 0, camera["fy"], camera["cy"], 0, 0, 0, 1, 0]
            bag.write("/camera/rgb/camera_info", info, time)


if __name__ == "__main__":
    main(*sys.argv[1:])
