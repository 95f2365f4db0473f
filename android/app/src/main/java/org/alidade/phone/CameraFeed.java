package org.alidade.phone;

import android.content.Context;
import android.graphics.ImageFormat;
import android.hardware.camera2.CameraAccessException;
import android.hardware.camera2.CameraCaptureSession;
import android.hardware.camera2.CameraCharacteristics;
import android.hardware.camera2.CameraDevice;
import android.hardware.camera2.CameraManager;
import android.hardware.camera2.CaptureRequest;
import android.hardware.camera2.params.StreamConfigurationMap;
import android.media.Image;
import android.media.ImageReader;
import android.os.Handler;
import android.os.HandlerThread;
import android.util.Range;
import android.util.Size;
import java.util.Collections;

/** Delivers the main camera's images one after the other, in a separate thread. */
final class CameraFeed {
  /** Called in the feed's thread. */
  interface Listener {
    void onPicture(Image image);

    /** The camera stopped delivering images: another app uses it, or it failed. */
    void onCameraGone(String why);
  }

  private static final int MOST_FPS = 30, LEAST_FPS = 15;
  private static final int BUFFERS = 3; // one being filled, one waiting, one being copied
  // 2 m: with phones' lenses everything from 1 m on is in focus.
  private static final double FOCUS_DIOPTRES = 0.5;

  private final CameraManager manager;
  private final String id;
  private final CameraCharacteristics characteristics;
  private final Size size;
  private final Listener listener;
  private final HandlerThread thread = new HandlerThread("camera");
  private Handler handler;
  // Used by the feed's thread only.
  private CameraDevice device;
  private ImageReader reader;
  private boolean stopped;

  /** Throws when there is no rear camera. */
  CameraFeed(Context context, int wantedWidth, Listener listener) throws CameraAccessException {
    manager = (CameraManager) context.getSystemService(Context.CAMERA_SERVICE);
    id = backCamera(manager);
    characteristics = manager.getCameraCharacteristics(id);
    size = nearestSize(characteristics, wantedWidth);
    this.listener = listener;
  }

  CameraCharacteristics characteristics() {
    return characteristics;
  }

  Size size() {
    return size;
  }

  /**
   * Clockwise rotation in degrees that makes the images upright in the phone's natural orientation.
   */
  int orientation() {
    Integer degrees = characteristics.get(CameraCharacteristics.SENSOR_ORIENTATION);
    return degrees == null ? 0 : degrees;
  }

  void start() {
    thread.start();
    handler = new Handler(thread.getLooper());
    handler.post(this::open);
  }

  /** Returns once the camera is released, because the next activity may open it. */
  void stop() {
    if (handler == null) return;
    handler.post(
        () -> {
          stopped = true;
          release();
          thread.quitSafely();
        });
    try {
      thread.join();
    } catch (InterruptedException e) {
      Thread.currentThread().interrupt();
    }
  }

  private void open() {
    try {
      reader =
          ImageReader.newInstance(
              size.getWidth(), size.getHeight(), ImageFormat.YUV_420_888, BUFFERS);
      reader.setOnImageAvailableListener(this::take, handler);
      manager.openCamera(id, new DeviceListener(), handler);
    } catch (CameraAccessException | SecurityException | IllegalArgumentException e) {
      gone(e.getMessage());
    }
  }

  private void take(ImageReader from) {
    try (Image image = from.acquireLatestImage()) {
      if (image != null && !stopped) listener.onPicture(image);
    }
  }

  private void gone(String why) {
    release();
    if (!stopped) listener.onCameraGone(why);
  }

  private void release() {
    if (device != null) device.close();
    device = null;
    if (reader != null) reader.close();
    reader = null;
  }

  private final class DeviceListener extends CameraDevice.StateCallback {
    @Override
    public void onOpened(CameraDevice opened) {
      device = opened;
      if (stopped || reader == null) {
        release();
        return;
      }
      try {
        opened.createCaptureSession(
            Collections.singletonList(reader.getSurface()), new SessionListener(), handler);
      } catch (CameraAccessException | IllegalStateException e) {
        gone(e.getMessage());
      }
    }

    @Override
    public void onDisconnected(CameraDevice lost) {
      device = lost;
      gone("another app has the camera");
    }

    @Override
    public void onError(CameraDevice failed, int error) {
      device = failed;
      gone("the camera failed (" + error + ")");
    }
  }

  private final class SessionListener extends CameraCaptureSession.StateCallback {
    @Override
    public void onConfigured(CameraCaptureSession session) {
      if (device == null || reader == null) return;
      try {
        CaptureRequest.Builder request = device.createCaptureRequest(CameraDevice.TEMPLATE_PREVIEW);
        request.addTarget(reader.getSurface());
        holdLens(request);
        Range<Integer> fps = frameRates();
        if (fps != null) request.set(CaptureRequest.CONTROL_AE_TARGET_FPS_RANGE, fps);
        session.setRepeatingRequest(request.build(), null, handler);
      } catch (CameraAccessException | IllegalStateException e) {
        gone(e.getMessage());
      }
    }

    @Override
    public void onConfigureFailed(CameraCaptureSession session) {
      gone("the camera provides no images of " + size);
    }
  }

  // Focusing changes the focal length, and stabilization moves the principal point. Disables both
  // where the device permits.
  private void holdLens(CaptureRequest.Builder request) {
    request.set(
        CaptureRequest.CONTROL_VIDEO_STABILIZATION_MODE,
        CaptureRequest.CONTROL_VIDEO_STABILIZATION_MODE_OFF);
    if (has(
        CameraCharacteristics.LENS_INFO_AVAILABLE_OPTICAL_STABILIZATION,
        CaptureRequest.LENS_OPTICAL_STABILIZATION_MODE_OFF)) {
      request.set(
          CaptureRequest.LENS_OPTICAL_STABILIZATION_MODE,
          CaptureRequest.LENS_OPTICAL_STABILIZATION_MODE_OFF);
    }
    // LENS_DISTORTION refers to images without distortion correction.
    if (has(
        CameraCharacteristics.DISTORTION_CORRECTION_AVAILABLE_MODES,
        CaptureRequest.DISTORTION_CORRECTION_MODE_OFF)) {
      request.set(
          CaptureRequest.DISTORTION_CORRECTION_MODE, CaptureRequest.DISTORTION_CORRECTION_MODE_OFF);
    }
    Float nearest = characteristics.get(CameraCharacteristics.LENS_INFO_MINIMUM_FOCUS_DISTANCE);
    boolean movable = nearest != null && nearest > 0;
    if (movable
        && has(CameraCharacteristics.CONTROL_AF_AVAILABLE_MODES, CaptureRequest.CONTROL_AF_MODE_OFF)) {
      request.set(CaptureRequest.CONTROL_AF_MODE, CaptureRequest.CONTROL_AF_MODE_OFF);
      request.set(CaptureRequest.LENS_FOCUS_DISTANCE, (float) Math.min(FOCUS_DIOPTRES, nearest));
    }
  }

  private boolean has(CameraCharacteristics.Key<int[]> key, int mode) {
    int[] modes = characteristics.get(key);
    if (modes == null) return false;
    for (int each : modes) {
      if (each == mode) return true;
    }
    return false;
  }

  // Of the ranges with the highest upper limit up to 30, the one whose lower limit is 15 or the
  // next value above.
  private Range<Integer> frameRates() {
    Range<Integer>[] ranges =
        characteristics.get(CameraCharacteristics.CONTROL_AE_AVAILABLE_TARGET_FPS_RANGES);
    Range<Integer> best = null;
    if (ranges == null) return null;
    for (Range<Integer> range : ranges) {
      if (range.getUpper() > MOST_FPS) continue;
      if (best == null || worth(range) > worth(best)) best = range;
    }
    return best;
  }

  private static int worth(Range<Integer> range) {
    // At 15 or more a lower limit is better, because it permits longer exposures in the dark; below
    // 15 a higher one is.
    int lower = range.getLower();
    return 100 * range.getUpper() + (lower >= LEAST_FPS ? MOST_FPS - lower : lower - MOST_FPS);
  }

  private static String backCamera(CameraManager manager) throws CameraAccessException {
    for (String each : manager.getCameraIdList()) {
      Integer facing =
          manager.getCameraCharacteristics(each).get(CameraCharacteristics.LENS_FACING);
      if (facing != null && facing == CameraCharacteristics.LENS_FACING_BACK) return each;
    }
    throw new CameraAccessException(
        CameraAccessException.CAMERA_ERROR, "no camera looks away from the user");
  }

  // Prefers 4:3, which uses the full sensor, and among these the width nearest to the requested
  // one.
  private static Size nearestSize(CameraCharacteristics camera, int wantedWidth)
      throws CameraAccessException {
    StreamConfigurationMap map = camera.get(CameraCharacteristics.SCALER_STREAM_CONFIGURATION_MAP);
    Size[] sizes = map == null ? null : map.getOutputSizes(ImageFormat.YUV_420_888);
    if (sizes == null || sizes.length == 0) {
      throw new CameraAccessException(CameraAccessException.CAMERA_ERROR, "no pictures in YUV");
    }
    Size best = sizes[0];
    for (Size each : sizes) {
      if (distance(each, wantedWidth) < distance(best, wantedWidth)) best = each;
    }
    return best;
  }

  private static int distance(Size size, int wantedWidth) {
    int shape = Math.abs(size.getWidth() * 3 - size.getHeight() * 4) > 4 ? 10000 : 0;
    return shape + Math.abs(size.getWidth() - wantedWidth);
  }
}
