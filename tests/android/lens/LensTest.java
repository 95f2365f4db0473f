package org.alidade.phone;

/** Lens: numbers of cameras brought to pictures of another size, by hand. */
public final class LensTest {
  private LensTest() {}

  private static void near(double is, double should) {
    Check.that(Math.abs(is - should) < 1e-6, is + " should be " + should);
  }

  public static void main(String[] arguments) {
    Check check = new Check();
    check.test(
        "all of a sensor is seen under 2 atan(W / 2f)",
        () -> near(Lens.fieldOfView(4, 8, 4000, 3000, 640, 480)[0], 90));
    check.test(
        "a wide picture has all of its width",
        () -> near(Lens.fieldOfView(4, 8, 4000, 3000, 1280, 720)[0], 90));
    check.test(
        "a narrower one is cut: three quarters of the width",
        () ->
            near(
                Lens.fieldOfView(4, 8, 4000, 3000, 480, 480)[0],
                Math.toDegrees(2 * Math.atan(0.75))));
    check.test(
        "no focal length is no field of view",
        () -> Check.that(Lens.fieldOfView(0, 8, 4000, 3000, 640, 480).length == 0, "one was told"));
    check.test(
        "intrinsics are scaled, their centre from the edge of a pixel to its middle",
        () -> {
          double[] lens =
              Lens.calibrated(
                  new float[] {3000, 3010, 2000, 1500, 0},
                  new float[] {0.1f, 0.2f, 0.3f, 0.4f, 0.5f},
                  4000,
                  3000,
                  1000,
                  750);
          double[] should = {750, 752.5, 499.5, 374.5, 0.1f, 0.2f, 0.4f, 0.5f, 0.3f};
          for (int i = 0; i < 9; ++i) near(lens[i], should[i]);
        });
    check.test(
        "and cut for 16:9",
        () -> {
          double[] lens =
              Lens.calibrated(new float[] {3000, 3000, 2000, 1500}, null, 4000, 3000, 1600, 900);
          near(lens[0], 1200);
          near(lens[3], 449.5); // the middle stays the middle
          near(lens[4], 0);
        });
    System.exit(check.status());
  }
}
