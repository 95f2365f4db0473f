package org.alidade.phone;

import java.nio.ByteBuffer;
import java.util.concurrent.locks.ReentrantReadWriteLock;

/**
 * The core: pictures in, numbers and drawing out (android/jni). Any thread may call anything at any
 * time, but for the drawing calls, which belong to the thread whose GL context is current. Bad
 * arguments throw IllegalArgumentException, a call after {@link #close} or a picture between {@link
 * #cameraGone} and {@link #cameraBack} IllegalStateException.
 */
public final class SlamConnector implements AutoCloseable {
  static {
    System.loadLibrary("alidade_jni");
  }

  public static final int INITIALISING = 0, TRACKING = 1, LOST = 2;

  /** What is known after the last picture that was worked on. */
  public static final class Numbers {
    static final int COUNT = 14;
    public final int state; // INITIALISING, TRACKING, LOST
    public final boolean predicted; // lost for so short that the motion is taken to go on
    public final int keyframes, landmarks, matches, features, maps;
    public final double milliseconds; // the last picture took
    public final double fov; // horizontal field of view, degrees
    public final double fovSigma; // its standard deviation, degrees; 0: it was given
    public final int cameraChanges; // how often the map was changed to a lens that was found from it
    public final int frames; // worked on
    public final int skipped; // pictures that a newer one replaced before their turn came
    public final int failed; // pictures that the core refused: words() says why

    Numbers(double[] list) {
      state = (int) list[0];
      predicted = list[1] != 0;
      keyframes = (int) list[2];
      landmarks = (int) list[3];
      matches = (int) list[4];
      features = (int) list[5];
      maps = (int) list[6];
      milliseconds = list[7];
      fov = list[8];
      fovSigma = list[9];
      cameraChanges = (int) list[10];
      frames = (int) list[11];
      skipped = (int) list[12];
      failed = (int) list[13];
    }
  }

  // Calls read the handle, close() writes it: nobody is inside the session when it goes.
  private final ReentrantReadWriteLock lock = new ReentrantReadWriteLock();
  private long handle;

  /**
   * @param lens nothing (null or empty), the horizontal field of view in degrees, or fx fy cx cy k1
   *     k2 p1 p2 k3 in pixels of pictures of this size
   * @param settings lines of name=value, as after --set
   * @param detector an ONNX file that finds people, or null
   */
  public SlamConnector(int width, int height, double[] lens, String settings, String detector) {
    handle = nativeOpen(width, height, lens, settings, detector);
  }

  private interface Call<T> {
    T with(long handle);
  }

  private <T> T call(Call<T> call) {
    lock.readLock().lock();
    try {
      if (handle == 0) throw new IllegalStateException("the session is closed");
      return call.with(handle);
    } finally {
      lock.readLock().unlock();
    }
  }

  private void run(java.util.function.LongConsumer body) {
    call(
        session -> {
          body.accept(session);
          return null;
        });
  }

  /** Ends the session; once is enough. */
  @Override
  public void close() {
    lock.writeLock().lock();
    try {
      if (handle != 0) nativeClose(handle);
      handle = 0;
    } finally {
      lock.writeLock().unlock();
    }
  }

  /**
   * One picture's luma plane, in a direct buffer; it is copied before this returns. Where another
   * one still waits for its turn, this one takes its place.
   */
  public void offer(ByteBuffer plane, int rowStride, double seconds) {
    run(session -> nativeOffer(session, plane, rowStride, seconds));
  }

  public void cameraGone() {
    run(SlamConnector::nativeCameraGone);
  }

  public void cameraBack() {
    run(SlamConnector::nativeCameraBack);
  }

  public void surfaceCreated() {
    run(SlamConnector::nativeSurfaceCreated);
  }

  /** Frees what was made in the GL context, which lives on. */
  public void surfaceGone() {
    run(SlamConnector::nativeSurfaceGone);
  }

  public void surfaceChanged(int width, int height) {
    run(session -> nativeSurfaceChanged(session, width, height));
  }

  /** A finger moved so many pixels over the map. */
  public void turn(double right, double down) {
    run(session -> nativeTurn(session, right, down));
  }

  /** Two fingers went apart (above 1) or together. */
  public void zoom(double factor) {
    run(session -> nativeZoom(session, factor));
  }

  /**
   * @param rotation degrees clockwise by which the picture is turned to stand upright
   * @return whether there was a picture
   */
  public boolean draw(int rotation) {
    return call(session -> nativeDraw(session, rotation));
  }

  public Numbers numbers() {
    double[] list = new double[Numbers.COUNT];
    run(session -> nativeNumbers(session, list));
    return new Numbers(list);
  }

  /** Why there is no pose; "" while there is one. */
  public String reason() {
    return call(SlamConnector::nativeReason);
  }

  /** What went wrong last; "" when all is well. */
  public String words() {
    return call(SlamConnector::nativeWords);
  }

  /** map.alidade, as the program loads it. */
  public byte[] map() {
    return call(SlamConnector::nativeMap);
  }

  /** Text in TUM format. */
  public byte[] trajectory() {
    return call(SlamConnector::nativeTrajectory);
  }

  /** Until no picture waits or is in work. */
  public void waitUntilIdle() {
    run(SlamConnector::nativeWaitUntilIdle);
  }

  private static native long nativeOpen(
      int width, int height, double[] lens, String settings, String detector);

  private static native void nativeClose(long handle);

  private static native void nativeOffer(
      long handle, ByteBuffer plane, int rowStride, double seconds);

  private static native void nativeCameraGone(long handle);

  private static native void nativeCameraBack(long handle);

  private static native void nativeSurfaceCreated(long handle);

  private static native void nativeSurfaceGone(long handle);

  private static native void nativeSurfaceChanged(long handle, int width, int height);

  private static native void nativeTurn(long handle, double right, double down);

  private static native void nativeZoom(long handle, double factor);

  private static native boolean nativeDraw(long handle, int rotation);

  private static native void nativeNumbers(long handle, double[] into);

  private static native String nativeReason(long handle);

  private static native String nativeWords(long handle);

  private static native byte[] nativeMap(long handle);

  private static native byte[] nativeTrajectory(long handle);

  private static native void nativeWaitUntilIdle(long handle);
}
