package org.alidade.phone;

import java.nio.ByteBuffer;
import java.util.concurrent.locks.ReentrantReadWriteLock;

/**
 * Java interface of the core: images in, numbers and drawing out (android/jni). All methods may be
 * called from any thread at any time, except the drawing methods, which require the thread whose GL
 * context is current. Invalid arguments throw IllegalArgumentException; calls after {@link #close},
 * and images between {@link #cameraGone} and {@link #cameraBack}, throw IllegalStateException.
 */
public final class SlamConnector implements AutoCloseable {
  static {
    System.loadLibrary("alidade_jni");
  }

  public static final int INITIALIZING = 0, TRACKING = 1, LOST = 2;

  /** Status after the last processed image. */
  public static final class Numbers {
    static final int COUNT = 17;
    public final int state; // INITIALIZING, TRACKING, LOST
    public final boolean predicted; // lost recently; the pose is extrapolated from the motion
    public final int keyframes, landmarks, matches, features, maps;
    public final double milliseconds; // processing time of the last image
    public final double fov; // horizontal field of view, degrees
    public final double fovSigma; // its standard deviation, degrees; 0: the field of view was given
    public final int cameraChanges; // number of times the map was rebuilt with a new lens estimate
    public final int frames; // processed images
    public final int skipped; // images replaced by a newer one before they were processed
    public final int failed; // images rejected by the core; words() returns the reason
    public final int readings; // of the inertial sensor
    public final boolean metric; // lengths are meters because of them
    public final double scaleSigma; // relative standard deviation of lengths; 0: unknown

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
      readings = (int) list[14];
      metric = list[15] != 0;
      scaleSigma = list[16];
    }
  }

  // Calls hold the read lock and close() the write lock, so that no call is inside the session when
  // it is deleted.
  private final ReentrantReadWriteLock lock = new ReentrantReadWriteLock();
  private long handle;

  /**
   * @param lens null or empty (unknown); the horizontal field of view in degrees; or fx fy cx cy k1
   * k2 p1 p2 k3 in pixels of images of this size
   * @param settings lines of name=value, as after --set
   * @param detector ONNX file of a network that detects people, or null
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

  /** Ends the session; may be called repeatedly. */
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
   * Passes the luma plane of one image in a direct buffer, which is copied. Replaces an image that
   * is still waiting.
   */
  public void offer(double seconds, ByteBuffer plane, int rowStride) {
    run(session -> nativeOffer(session, seconds, plane, rowStride));
  }

  /**
   * Passes readings of the inertial sensor since the last call, in order of time.
   *
   * @param readings 7 numbers each: seconds on the clock of the images, rad/s about x y z, m/s²
   * along x y z (at rest it points up), in axes that are fixed to the camera
   */
  public void moved(double[] readings) {
    run(session -> nativeMoved(session, readings));
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

  /** Deletes the objects in the GL context, which continues to exist. */
  public void surfaceGone() {
    run(SlamConnector::nativeSurfaceGone);
  }

  public void surfaceChanged(int width, int height) {
    run(session -> nativeSurfaceChanged(session, width, height));
  }

  /** A drag by this many pixels over the map. */
  public void turn(double right, double down) {
    run(session -> nativeTurn(session, right, down));
  }

  /** A pinch: above 1 when the fingers moved apart. */
  public void zoom(double factor) {
    run(session -> nativeZoom(session, factor));
  }

  /**
   * @param rotation clockwise degrees that make the image upright
   * @return whether there was an image
   */
  public boolean draw(int rotation) {
    return call(session -> nativeDraw(session, rotation));
  }

  public Numbers numbers() {
    double[] list = new double[Numbers.COUNT];
    run(session -> nativeNumbers(session, list));
    return new Numbers(list);
  }

  /** Why there is no pose; "" if there is one. */
  public String reason() {
    return call(SlamConnector::nativeReason);
  }

  /** The last problem; "" if none. */
  public String words() {
    return call(SlamConnector::nativeWords);
  }

  /** The bytes of map.alidade. */
  public byte[] map() {
    return call(SlamConnector::nativeMap);
  }

  /** Text in TUM format. */
  public byte[] trajectory() {
    return call(SlamConnector::nativeTrajectory);
  }

  /** Waits until no image is waiting or being processed. */
  public void waitUntilIdle() {
    run(SlamConnector::nativeWaitUntilIdle);
  }

  private static native long nativeOpen(
      int width, int height, double[] lens, String settings, String detector);

  private static native void nativeClose(long handle);

  private static native void nativeOffer(
      long handle, double seconds, ByteBuffer plane, int rowStride);

  private static native void nativeMoved(long handle, double[] readings);

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
