package org.alidade.phone;

import java.util.ArrayDeque;

/**
 * Readings of a gyroscope and an accelerometer, which come apart, as readings at the times of the
 * gyroscope: accelerations are interpolated. Where the nearest ones are more than 0.1 s apart,
 * there is no reading.
 */
final class OneClock {
  /** Receives 7 numbers: seconds, rad/s x y z, m/s² x y z. */
  interface Listener {
    void onReading(double[] reading);
  }

  private static final double FARTHEST = 0.1; // seconds between two accelerations
  private static final int MOST = 400; // turns kept while the accelerometer is silent

  private final Listener listener;
  private final ArrayDeque<double[]> turns = new ArrayDeque<>(); // later than the last acceleration
  private double[] last; // acceleration: seconds, x, y, z

  OneClock(Listener listener) {
    this.listener = listener;
  }

  void turned(double seconds, float x, float y, float z) {
    if (!turns.isEmpty() && seconds <= turns.peekLast()[0]) return;
    turns.add(new double[] {seconds, x, y, z});
    if (turns.size() > MOST) turns.remove();
  }

  void accelerated(double seconds, float x, float y, float z) {
    double[] next = {seconds, x, y, z};
    if (last != null && seconds <= last[0]) return;
    while (!turns.isEmpty() && turns.peek()[0] <= seconds) {
      double[] w = turns.remove();
      if (last == null || w[0] < last[0] || seconds - last[0] > FARTHEST) continue;
      double share = (w[0] - last[0]) / (seconds - last[0]);
      double[] reading = {w[0], w[1], w[2], w[3], 0, 0, 0};
      for (int k = 1; k < 4; ++k) reading[3 + k] = last[k] + share * (next[k] - last[k]);
      listener.onReading(reading);
    }
    last = next;
  }
}
