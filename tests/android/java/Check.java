package org.alidade.phone;

/** Tests by name, counted. */
final class Check {
  interface Body {
    void run() throws Exception;
  }

  private int passed, failed;

  void test(String name, Body body) {
    try {
      body.run();
      ++passed;
      System.out.println("ok   " + name);
    } catch (Throwable problem) {
      ++failed;
      System.out.println("FAIL " + name);
      problem.printStackTrace(System.out);
    }
  }

  static void that(boolean holds, String what) {
    if (!holds) throw new AssertionError(what);
  }

  /** That it throws this, saying something with `word` in it. */
  static void refuses(Class<? extends Exception> type, String word, Body body) throws Exception {
    try {
      body.run();
    } catch (Exception thrown) {
      that(type.isInstance(thrown), "not " + type.getSimpleName() + ": " + thrown);
      that(thrown.getMessage().contains(word), thrown.getMessage() + " does not say: " + word);
      return;
    }
    throw new AssertionError("nothing was refused: " + word);
  }

  int status() {
    System.out.println(passed + " passed, " + failed + " failed");
    return failed == 0 && passed > 0 ? 0 : 1;
  }
}
