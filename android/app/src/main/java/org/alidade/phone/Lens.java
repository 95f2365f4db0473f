package org.alidade.phone;

import android.graphics.Rect;
import android.hardware.camera2.CameraCharacteristics;
import android.util.SizeF;

/**
 * Lens parameters that the camera reports, in the format of {@link SlamConnector}: a calibration,
 * else the horizontal field of view θ from f = W / (2 tan(θ/2)), else empty, in which case the core
 * calibrates the camera itself.
 */
final class Lens {
  private Lens() {}

  static double[] of(CameraCharacteristics camera, int width, int height) {
    Rect array = camera.get(CameraCharacteristics.SENSOR_INFO_PRE_CORRECTION_ACTIVE_ARRAY_SIZE);
    if (array == null || array.width() <= 0 || array.height() <= 0) return new double[0];
    float[] intrinsics = camera.get(CameraCharacteristics.LENS_INTRINSIC_CALIBRATION);
    float[] distortion = camera.get(CameraCharacteristics.LENS_DISTORTION);
    if (intrinsics != null && intrinsics.length >= 4 && intrinsics[0] > 0 && intrinsics[1] > 0) {
      return calibrated(intrinsics, distortion, array.width(), array.height(), width, height);
    }
    float[] focal = camera.get(CameraCharacteristics.LENS_INFO_AVAILABLE_FOCAL_LENGTHS);
    SizeF sensor = camera.get(CameraCharacteristics.SENSOR_INFO_PHYSICAL_SIZE);
    android.util.Size pixels = camera.get(CameraCharacteristics.SENSOR_INFO_PIXEL_ARRAY_SIZE);
    if (focal == null || focal.length == 0 || sensor == null || pixels == null) {
      return new double[0];
    }
    // The physical size is that of the full pixel array; images are cropped from its active part.
    double across = sensor.getWidth() * array.width() / (double) pixels.getWidth();
    return fieldOfView(focal[0], across, array.width(), array.height(), width, height);
  }

  /** Converts fx fy cx cy [s] of the pixel array to images cropped and scaled from it. */
  static double[] calibrated(
      float[] of, float[] distortion, int arrayWidth, int arrayHeight, int width, int height) {
    double scale = 1 / pixelsPerPixel(arrayWidth, arrayHeight, width, height);
    double left = (arrayWidth - width / scale) / 2, top = (arrayHeight - height / scale) / 2;
    double[] lens = new double[9];
    lens[0] = of[0] * scale;
    lens[1] = of[1] * scale;
    // Android's origin is the corner of the first pixel, the core's is its center.
    lens[2] = (of[2] - left) * scale - 0.5;
    lens[3] = (of[3] - top) * scale - 0.5;
    // Android's order is k1 k2 k3 and then the tangential coefficients, which multiply (2xy, r² +
    // 2x²) in x, as Brown's p1 and p2 do.
    if (distortion != null && distortion.length >= 5) {
      lens[4] = distortion[0];
      lens[5] = distortion[1];
      lens[6] = distortion[3];
      lens[7] = distortion[4];
      lens[8] = distortion[2];
    }
    return lens;
  }

  /** The horizontal field of view in degrees; lengths in millimeters. */
  static double[] fieldOfView(
      double focal, double across, int arrayWidth, int arrayHeight, int width, int height) {
    if (!(focal > 0) || !(across > 0)) return new double[0];
    double share = width * pixelsPerPixel(arrayWidth, arrayHeight, width, height) / arrayWidth;
    double used = across * share;
    return new double[] {Math.toDegrees(2 * Math.atan(used / (2 * focal)))};
  }

  // Sensor pixels per image pixel. An image with another aspect ratio is the largest central crop.
  private static double pixelsPerPixel(int arrayWidth, int arrayHeight, int width, int height) {
    return Math.min(arrayWidth / (double) width, arrayHeight / (double) height);
  }
}
