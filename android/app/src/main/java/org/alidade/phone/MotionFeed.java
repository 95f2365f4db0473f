package org.alidade.phone;

import android.content.Context;
import android.hardware.Sensor;
import android.hardware.SensorEvent;
import android.hardware.SensorEventListener;
import android.hardware.SensorManager;
import android.hardware.camera2.CameraCharacteristics;
import android.hardware.camera2.CameraMetadata;
import android.os.Handler;
import android.os.HandlerThread;
import android.os.SystemClock;

/**
 * The phone's gyroscope and accelerometer at 200 Hz, on the clock of the camera's images, in a
 * thread of its own. A phone that lacks one of them gives no readings.
 */
final class MotionFeed implements SensorEventListener {
  private static final int PERIOD_US = 5000; // more would need a permission from Android 12 on
  private static final double NANO = 1e-9;

  private final SensorManager sensors;
  private final OneClock clock;
  private final HandlerThread thread = new HandlerThread("motion");
  // Sensors are stamped by SystemClock.elapsedRealtimeNanos(), and so are images of cameras with
  // the source REALTIME. Other cameras use System.nanoTime(), which stops while the phone sleeps.
  private final long behind; // nanoseconds

  MotionFeed(Context context, CameraCharacteristics camera, OneClock.Listener listener) {
    sensors = (SensorManager) context.getSystemService(Context.SENSOR_SERVICE);
    clock = new OneClock(listener);
    Integer source = camera.get(CameraCharacteristics.SENSOR_INFO_TIMESTAMP_SOURCE);
    boolean same =
        source != null && source == CameraMetadata.SENSOR_INFO_TIMESTAMP_SOURCE_REALTIME;
    behind = same ? 0 : SystemClock.elapsedRealtimeNanos() - System.nanoTime();
  }

  void start() {
    Sensor gyroscope = sensors.getDefaultSensor(Sensor.TYPE_GYROSCOPE);
    Sensor accelerometer = sensors.getDefaultSensor(Sensor.TYPE_ACCELEROMETER);
    if (gyroscope == null || accelerometer == null) return;
    thread.start();
    Handler handler = new Handler(thread.getLooper());
    sensors.registerListener(this, gyroscope, PERIOD_US, handler);
    sensors.registerListener(this, accelerometer, PERIOD_US, handler);
  }

  void stop() {
    sensors.unregisterListener(this);
    thread.quitSafely();
  }

  @Override
  public void onSensorChanged(SensorEvent event) {
    double seconds = (event.timestamp - behind) * NANO;
    float x = event.values[0], y = event.values[1], z = event.values[2];
    if (event.sensor.getType() == Sensor.TYPE_GYROSCOPE) clock.turned(seconds, x, y, z);
    else clock.accelerated(seconds, x, y, z);
  }

  @Override
  public void onAccuracyChanged(Sensor sensor, int accuracy) {}
}
