package org.alidade.phone;

import java.nio.ByteBuffer;

/** An OpenGL ES 3 context of this thread, without a screen (tests/android/screen.cc). */
final class Screen implements AutoCloseable {
  private static final boolean LOADED = load();
  final int width, height;
  final boolean there; // false: no EGL here, nothing can be drawn
  private boolean closed;

  Screen(int width, int height) {
    this.width = width;
    this.height = height;
    there = LOADED && nativeOpen(width, height) != 0;
  }

  private static boolean load() {
    try {
      System.loadLibrary("alidade_test_screen");
      return true;
    } catch (UnsatisfiedLinkError none) {
      return false;
    }
  }

  /** How much of the rows from one share of the height to another, from the top, is brighter than the background. */
  double lit(double from, double to) {
    ByteBuffer pixels = ByteBuffer.allocateDirect(4 * width * height);
    nativeRead(width, height, pixels);
    int lit = 0, all = 0;
    for (int row = (int) ((1 - to) * height); row < (int) ((1 - from) * height); ++row) {
      for (int x = 0; x < width; ++x, ++all) {
        int green = pixels.get(4 * (row * width + x) + 1) & 0xff;
        if (green > 40) ++lit;
      }
    }
    return lit / (double) all;
  }

  @Override
  public void close() {
    if (there && !closed) nativeClose();
    closed = true;
  }

  private static native long nativeOpen(int width, int height);

  private static native void nativeClose();

  private static native void nativeRead(int width, int height, ByteBuffer into);
}
