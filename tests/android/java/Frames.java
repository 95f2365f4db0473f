package org.alidade.phone;

import java.io.IOException;
import java.nio.ByteBuffer;
import java.nio.ByteOrder;
import java.nio.charset.StandardCharsets;
import java.nio.file.Files;
import java.nio.file.Path;

/** Pictures of a file of alidade_frames (tests/android/frames_file.h). */
final class Frames {
  final int width, height, count;
  final double[] lens = new double[9];
  private final byte[] bytes;
  private final int begin;

  Frames(String path) throws IOException {
    bytes = Files.readAllBytes(Path.of(path));
    int end = 0;
    while (bytes[end] != '\n') ++end;
    String[] head = new String(bytes, 0, end, StandardCharsets.US_ASCII).split(" ");
    width = Integer.parseInt(head[1]);
    height = Integer.parseInt(head[2]);
    count = Integer.parseInt(head[3]);
    for (int i = 0; i < 4; ++i) lens[i] = Double.parseDouble(head[4 + i]);
    begin = end + 1;
  }

  double time(int i) {
    return ByteBuffer.wrap(bytes).order(ByteOrder.LITTLE_ENDIAN).getDouble(begin + i * (8 + width * height));
  }

  /** A direct buffer, as a camera gives: nothing behind the last pixel. */
  ByteBuffer plane(int i, int rowStride) {
    ByteBuffer plane = ByteBuffer.allocateDirect(rowStride * (height - 1) + width);
    int at = begin + i * (8 + width * height) + 8;
    for (int row = 0; row < height; ++row) {
      plane.position(row * rowStride);
      plane.put(bytes, at + row * width, width);
    }
    plane.rewind();
    return plane;
  }
}
