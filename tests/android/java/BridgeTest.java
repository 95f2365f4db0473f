package org.alidade.phone;

import java.nio.ByteBuffer;
import java.nio.charset.StandardCharsets;
import java.nio.file.Files;
import java.nio.file.Path;
import java.util.concurrent.atomic.AtomicInteger;
import java.util.concurrent.atomic.AtomicReference;

/** The bridge on the JVM: BridgeTest FRAMES CYCLES [DETECTOR.onnx]. */
public final class BridgeTest {
  private static final int STRIDE_GAP = 13; // odd, as no camera's is
  private static final long MOST_GROWTH_KB = 8 << 10;
  // Fewer sessions grow by what the JVM, and qemu, still translate: told, but no sign of anything.
  private static final int LEAST_CYCLES_TO_JUDGE = 200;

  private final Frames frames;
  private final int cycles;

  private BridgeTest(Frames frames, int cycles) {
    this.frames = frames;
    this.cycles = cycles;
  }

  public static void main(String[] arguments) throws Exception {
    BridgeTest bridge = new BridgeTest(new Frames(arguments[0]), Integer.parseInt(arguments[1]));
    Check check = new Check();
    check.test("pictures of one thread are mapped while another draws", bridge::mapsWhileDrawing);
    check.test("rows may have gaps", bridge::rowsMayHaveGaps);
    check.test("pictures that cannot be are refused", bridge::refusesPictures);
    check.test("sessions that cannot be are refused", bridge::refusesSessions);
    check.test("calls out of turn are refused", bridge::refusesCallsOutOfTurn);
    check.test("the map outlives a camera that was gone", bridge::outlivesTheCamera);
    check.test("readings of two sensors become those of one clock", BridgeTest::putsOnOneClock);
    check.test("inertial readings are counted, and others refused", bridge::takesReadings);
    check.test("a detector that cannot be opened is told, and done without", bridge::tellsOfDetector);
    if (arguments.length > 2) {
      check.test("a detector works beside", () -> bridge.worksWithDetector(arguments[2]));
    }
    check.test("a session may be closed while others use it", bridge::closesUnderUse);
    boolean judged = bridge.cycles >= LEAST_CYCLES_TO_JUDGE;
    check.test(judged ? "sessions come and go without growth" : "sessions come and go", bridge::doesNotGrow);
    System.exit(check.status());
  }

  // Accelerations grow by 1 m/s² in 10 ms; the gyroscope is read 4 ms after each.
  private static void putsOnOneClock() {
    java.util.List<double[]> readings = new java.util.ArrayList<>();
    OneClock clock = new OneClock(readings::add);
    for (int i = 0; i < 5; ++i) {
      clock.accelerated(i * 0.01, i, 2 * i, -i);
      clock.turned(i * 0.01 + 0.004, i, 0, 0);
    }
    Check.that(readings.size() == 4, readings.size() + " readings"); // the last one waits
    double[] third = readings.get(2);
    Check.that(Math.abs(third[0] - 0.024) < 1e-9 && third[1] == 2, "time " + third[0]);
    Check.that(Math.abs(third[4] - 2.4) < 1e-6 && Math.abs(third[5] - 4.8) < 1e-6
        && Math.abs(third[6] + 2.4) < 1e-6, "acceleration " + third[4] + " " + third[5]);
    clock.accelerated(1, 0, 0, 0); // a gap: the reading that waits is dropped
    Check.that(readings.size() == 4, readings.size() + " readings after the gap");
  }

  private void takesReadings() throws Exception {
    try (SlamConnector slam = open()) {
      for (int i = 0; i < 3; ++i) {
        slam.moved(new double[] {frames.time(i) - 0.01, 0, 0, 0, 0, 9.8, 0.1 * i, frames.time(i), 0, 0, 0, 0, 9.8, 0});
        offer(slam, i);
        slam.waitUntilIdle();
      }
      SlamConnector.Numbers now = slam.numbers();
      Check.that(now.readings == 6, now.readings + " readings");
      Check.that(!now.metric && now.scaleSigma == 0, "meters after three images");
      Check.refuses(IllegalArgumentException.class, "7 numbers", () -> slam.moved(new double[6]));
      Check.refuses(IllegalArgumentException.class, "missing", () -> slam.moved(null));
    }
  }

  private SlamConnector open() {
    return new SlamConnector(frames.width, frames.height, frames.lens, "", null);
  }

  private void offer(SlamConnector slam, int i) {
    slam.offer(frames.time(i), frames.plane(i, frames.width), frames.width);
  }

  private void mapsWhileDrawing() throws Exception {
    try (SlamConnector slam = open()) {
      AtomicReference<Throwable> problem = new AtomicReference<>();
      AtomicInteger drawn = new AtomicInteger();
      Thread screen = new Thread(() -> drawUntilInterrupted(slam, drawn, problem));
      screen.start();
      Thread camera =
          new Thread(
              () -> {
                for (int i = 0; i < frames.count; ++i) {
                  offer(slam, i);
                  slam.waitUntilIdle();
                }
              });
      camera.start();
      camera.join();
      screen.interrupt();
      screen.join();
      if (problem.get() != null) throw new AssertionError(problem.get());
      SlamConnector.Numbers now = slam.numbers();
      System.out.println(
          "     " + now.keyframes + " keyframes, " + now.landmarks + " landmarks, " + now.matches
              + " matches, " + now.milliseconds + " ms");
      Check.that(now.frames == frames.count, now.frames + " pictures were worked on");
      Check.that(now.skipped == 0 && now.failed == 0, now.skipped + " skipped, " + now.failed + " failed");
      Check.that(now.state == SlamConnector.TRACKING, "not tracking: " + slam.reason());
      Check.that(now.keyframes >= 2 && now.landmarks > 100 && now.matches > 30, "hardly a map");
      Check.that(now.fovSigma == 0, "the lens was told");
      Check.that(slam.words().isEmpty(), slam.words());
      if (drawn.get() == 0) System.out.println("     nothing drawn: no EGL");
      String trajectory = new String(slam.trajectory(), StandardCharsets.US_ASCII);
      Check.that(trajectory.lines().count() > frames.count / 3, "a short trajectory");
      Check.that(slam.map().length > 10000, "a small map");
    }
  }

  private static void drawUntilInterrupted(
      SlamConnector slam, AtomicInteger drawn, AtomicReference<Throwable> problem) {
    try (Screen screen = new Screen(300, 400)) {
      if (!screen.there) return;
      slam.surfaceCreated();
      slam.surfaceChanged(screen.width, screen.height);
      for (int turn = 0; !Thread.currentThread().isInterrupted(); turn = (turn + 90) % 360) {
        if (slam.draw(turn)) drawn.incrementAndGet();
        Thread.yield();
      }
      // On a busy machine hardly anything was drawn meanwhile: the view gets time to arrive at the map.
      for (int i = 0; i < 30; ++i) slam.draw(0);
      double picture = screen.lit(0, 0.5), map = screen.lit(0.5, 1);
      System.out.printf(
          "     drawn %d times: %.0f %% of the picture's half are lit, %.2f %% of the map's%n",
          drawn.get(), 100 * picture, 100 * map);
      Check.that(drawn.get() > 0, "nothing was drawn");
      Check.that(picture > 0.3, "no picture is seen");
      Check.that(map > 0.002, "no map is seen");
      Check.that(map < 0.9, "the map is all lit");
      // The phone was put away: the context is lost, and everything is drawn again in the next one.
      screen.lose();
      try (Screen next = new Screen(300, 400)) {
        slam.surfaceCreated();
        slam.draw(0);
        Check.that(Math.abs(next.lit(0, 1) - (picture + map) / 2) < 0.02, "not drawn again");
        slam.surfaceGone();
      }
    } catch (Throwable e) {
      problem.set(e);
    }
  }

  private void rowsMayHaveGaps() {
    int[] found = new int[2];
    for (int gap = 0; gap < 2; ++gap) {
      try (SlamConnector slam = open()) {
        int stride = frames.width + gap * STRIDE_GAP;
        slam.offer(0, frames.plane(0, stride), stride);
        slam.waitUntilIdle();
        found[gap] = slam.numbers().features;
      }
    }
    Check.that(found[0] > 50, "hardly a feature: " + found[0]);
    Check.that(found[0] == found[1], found[0] + " features, with gaps " + found[1]);
  }

  private void refusesPictures() throws Exception {
    Class<IllegalArgumentException> bad = IllegalArgumentException.class;
    try (SlamConnector slam = open()) {
      ByteBuffer plane = frames.plane(0, frames.width);
      Check.refuses(bad, "pixels", () -> slam.offer(0, plane, frames.width - 1));
      Check.refuses(bad, "pixels", () -> slam.offer(0, plane, frames.width + 1));
      Check.refuses(bad, "pixels", () -> slam.offer(0, plane, -1));
      Check.refuses(bad, "pixels", () -> slam.offer(0, ByteBuffer.allocateDirect(7), frames.width));
      Check.refuses(bad, "direct", () -> slam.offer(0, ByteBuffer.allocate(plane.capacity()), frames.width));
      Check.refuses(bad, "direct", () -> slam.offer(0, null, frames.width));
      Check.refuses(bad, "time", () -> slam.offer(Double.NaN, plane, frames.width));
      Check.refuses(bad, "degrees", () -> slam.draw(45));
      offer(slam, 0); // and nothing is lost by it
      slam.waitUntilIdle();
      Check.that(slam.numbers().frames == 1, "not worked on");
    }
  }

  private void refusesSessions() throws Exception {
    Class<IllegalArgumentException> bad = IllegalArgumentException.class;
    Check.refuses(bad, "pixels", () -> new SlamConnector(0, 240, null, "", null));
    Check.refuses(bad, "pixels", () -> new SlamConnector(320, 100000, null, "", null));
    Check.refuses(bad, "numbers", () -> new SlamConnector(320, 240, new double[3], "", null));
    Check.refuses(bad, "field of view", () -> new SlamConnector(320, 240, new double[] {200}, "", null));
    Check.refuses(bad, "tracker", () -> new SlamConnector(320, 240, null, "tracker.no_such=1", null));
  }

  private void refusesCallsOutOfTurn() throws Exception {
    Class<IllegalStateException> state = IllegalStateException.class;
    SlamConnector slam = open();
    Check.refuses(state, "surface", () -> slam.draw(0));
    slam.cameraGone();
    Check.refuses(state, "camera", () -> offer(slam, 0));
    slam.close();
    slam.close(); // once more does no harm
    Check.refuses(state, "closed", () -> offer(slam, 0));
    Check.refuses(state, "closed", slam::numbers);
    Check.refuses(state, "closed", () -> slam.draw(0));
    Check.refuses(state, "closed", slam::map);
  }

  private void outlivesTheCamera() {
    try (SlamConnector slam = open()) {
      for (int i = 0; i < frames.count; ++i) {
        offer(slam, i);
        slam.waitUntilIdle();
      }
      int before = slam.numbers().landmarks;
      slam.cameraGone();
      slam.cameraBack();
      // The clock may begin anew, and the camera looks at what it saw last.
      for (int i = 0; i < 5; ++i) {
        slam.offer(i / 30.0, frames.plane(frames.count - 1, frames.width), frames.width);
        slam.waitUntilIdle();
      }
      SlamConnector.Numbers now = slam.numbers();
      Check.that(now.failed == 0, slam.words());
      Check.that(now.maps == 1 && now.landmarks > before / 2, "the map is gone");
      Check.that(now.state == SlamConnector.TRACKING, "the place was not recognised: " + slam.reason());
    }
  }

  private void tellsOfDetector() {
    try (SlamConnector slam =
        new SlamConnector(frames.width, frames.height, frames.lens, "", "/no/such.onnx")) {
      offer(slam, 0);
      slam.waitUntilIdle();
      Check.that(slam.words().contains("there is no such file"), slam.words());
      Check.that(slam.numbers().frames == 1, "not worked on");
    }
  }

  private void worksWithDetector(String file) {
    try (SlamConnector slam =
        new SlamConnector(frames.width, frames.height, frames.lens, "", file)) {
      for (int i = 0; i < frames.count; ++i) {
        offer(slam, i);
        slam.waitUntilIdle();
      }
      SlamConnector.Numbers now = slam.numbers();
      Check.that(slam.words().isEmpty(), slam.words());
      Check.that(now.frames == frames.count && now.failed == 0, now.failed + " failed");
      Check.that(now.state == SlamConnector.TRACKING, "not tracking: " + slam.reason());
    }
  }

  private void closesUnderUse() throws Exception {
    for (int round = 0; round < 20; ++round) {
      SlamConnector slam = open();
      AtomicReference<Throwable> problem = new AtomicReference<>();
      Check.Body[] uses = {() -> offer(slam, 0), slam::numbers, slam::trajectory, slam::words};
      Thread[] users = new Thread[uses.length];
      for (int i = 0; i < uses.length; ++i) {
        Check.Body use = uses[i];
        users[i] =
            new Thread(
                () -> {
                  try {
                    while (true) use.run();
                  } catch (IllegalStateException closed) {
                    // as it should be
                  } catch (Throwable e) {
                    problem.set(e);
                  }
                });
        users[i].start();
      }
      Thread.sleep(5);
      slam.close();
      for (Thread user : users) user.join();
      if (problem.get() != null) throw new AssertionError(problem.get());
    }
  }

  private void doesNotGrow() throws Exception {
    for (int i = 0; i < cycles / 4; ++i) cycle(); // until allocator and JVM have what they need
    // A leak is there each time; what the JVM takes for itself late is not.
    long growth = Long.MAX_VALUE;
    for (int round = 0; round < 3 && growth >= MOST_GROWTH_KB; ++round) {
      long before = residentKb();
      for (int i = cycles / 4; i < cycles; ++i) cycle();
      growth = residentKb() - before;
      System.out.println("     " + (cycles - cycles / 4) + " sessions: " + growth + " kB more, of " + before);
    }
    Check.that(growth < MOST_GROWTH_KB || cycles < LEAST_CYCLES_TO_JUDGE, "grown by " + growth + " kB");
  }

  // Without drawing: in one context of Mesa's software renderer some 15 kB more are held after each frame,
  // whether or not anything is made anew (Mesa's or the renderer's: not found out).
  private void cycle() {
    try (SlamConnector slam = open()) {
      offer(slam, 0);
      offer(slam, 1);
      slam.numbers();
    }
  }

  private static long residentKb() throws Exception {
    for (String line : Files.readAllLines(Path.of("/proc/self/status"))) {
      if (line.startsWith("VmRSS:")) return Long.parseLong(line.replaceAll("[^0-9]", ""));
    }
    throw new AssertionError("no VmRSS");
  }
}
