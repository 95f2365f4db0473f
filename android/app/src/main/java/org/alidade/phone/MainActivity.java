package org.alidade.phone;

import android.Manifest;
import android.app.Activity;
import android.content.Intent;
import android.content.pm.PackageManager;
import android.hardware.camera2.CameraAccessException;
import android.media.Image;
import android.opengl.GLSurfaceView;
import android.os.Bundle;
import android.os.Handler;
import android.os.Looper;
import android.util.Size;
import android.view.Surface;
import android.view.View;
import android.view.WindowManager;
import android.widget.TextView;

/**
 * Connects camera, core and screen. The session lives as long as the activity, including pauses and
 * screen rotations (the manifest prevents a restart on rotation). The camera is open only while the
 * activity is in the foreground.
 */
public final class MainActivity extends Activity implements CameraFeed.Listener {
  private static final int ASK_CAMERA = 1;
  private static final long NUMBERS_EVERY_MS = 200;
  private static final double NANO = 1e-9;

  private final Handler ui = new Handler(Looper.getMainLooper());
  private final MapRenderer renderer = new MapRenderer();
  private GLSurfaceView surface;
  private TextView numbers, words;
  private Settings settings;
  private CameraFeed feed; // only in the foreground
  private MotionFeed motion; // the same
  private SlamConnector connector;
  private String madeWith = ""; // settings and image size of the session
  private String trouble = ""; // camera error

  @Override
  protected void onCreate(Bundle saved) {
    super.onCreate(saved);
    setContentView(R.layout.main);
    getWindow().addFlags(WindowManager.LayoutParams.FLAG_KEEP_SCREEN_ON);
    numbers = findViewById(R.id.numbers);
    words = findViewById(R.id.words);
    surface = findViewById(R.id.surface);
    surface.setEGLContextClientVersion(3);
    surface.setPreserveEGLContextOnPause(true);
    surface.setRenderer(renderer);
    new Fingers(surface, renderer);
    findViewById(R.id.settings).setOnClickListener(this::openSettings);
    findViewById(R.id.again).setOnClickListener(view -> beginAgain());
  }

  @Override
  protected void onResume() {
    super.onResume();
    settings = new Settings(this);
    surface.onResume();
    if (checkSelfPermission(Manifest.permission.CAMERA) == PackageManager.PERMISSION_GRANTED) {
      startCamera();
    } else if (trouble.isEmpty()) {
      requestPermissions(new String[] {Manifest.permission.CAMERA}, ASK_CAMERA);
    }
    ui.post(showNumbers);
  }

  @Override
  protected void onPause() {
    ui.removeCallbacks(showNumbers);
    stopCamera();
    surface.onPause();
    super.onPause();
  }

  @Override
  protected void onDestroy() {
    // The surface and its GL thread are already gone.
    if (connector != null) connector.close();
    connector = null;
    super.onDestroy();
  }

  @Override
  public void onRequestPermissionsResult(int code, String[] asked, int[] answers) {
    super.onRequestPermissionsResult(code, asked, answers);
    boolean granted = answers.length > 0 && answers[0] == PackageManager.PERMISSION_GRANTED;
    // onResume, which follows, checks the permission.
    trouble = granted ? "" : getString(R.string.no_permission);
  }

  @Override
  public void onConfigurationChanged(android.content.res.Configuration now) {
    super.onConfigurationChanged(now);
    turn();
  }

  private void startCamera() {
    trouble = "";
    try {
      feed = new CameraFeed(this, settings.width(), this);
      Size size = feed.size();
      double[] lens =
          settings.fov() > 0
              ? new double[] {settings.fov()}
              : Lens.of(feed.characteristics(), size.getWidth(), size.getHeight());
      String core = settings.forCore(), detector = settings.detector();
      String wanted = size + " " + settings.fov() + " " + detector + "\n" + core;
      if (connector == null || !wanted.equals(madeWith)) {
        show(new SlamConnector(size.getWidth(), size.getHeight(), lens, core, detector));
        madeWith = wanted;
      }
      connector.cameraBack();
      turn();
      SlamConnector session = connector;
      motion = new MotionFeed(this, feed.characteristics(), reading -> moved(session, reading));
      motion.start();
      feed.start();
    } catch (CameraAccessException | IllegalArgumentException e) {
      trouble = e.getMessage();
      feed = null;
    }
  }

  private static void moved(SlamConnector session, double[] reading) {
    try {
      session.moved(reading);
    } catch (IllegalStateException e) {
      // the session was closed meanwhile
    }
  }

  private void stopCamera() {
    if (motion != null) motion.stop();
    motion = null;
    if (feed != null) feed.stop();
    feed = null;
    if (connector != null) connector.cameraGone();
  }

  // Closes the old session after the GL thread has released it.
  private void show(SlamConnector next) {
    SlamConnector old = connector;
    connector = next;
    surface.queueEvent(
        () -> {
          renderer.show(next);
          if (old != null) old.close();
        });
  }

  private void beginAgain() {
    stopCamera();
    madeWith = "";
    startCamera();
  }

  private void openSettings(View button) {
    startActivity(new Intent(this, SettingsActivity.class));
  }

  // Image rotation from the sensor's orientation and the screen's rotation.
  private void turn() {
    if (feed == null) return;
    int screen;
    switch (getWindowManager().getDefaultDisplay().getRotation()) {
      case Surface.ROTATION_90:
        screen = 90;
        break;
      case Surface.ROTATION_180:
        screen = 180;
        break;
      case Surface.ROTATION_270:
        screen = 270;
        break;
      default:
        screen = 0;
    }
    renderer.turn((feed.orientation() - screen + 360) % 360);
  }

  @Override
  public void onPicture(Image image) {
    Image.Plane luma = image.getPlanes()[0];
    connector.offer(image.getTimestamp() * NANO, luma.getBuffer(), luma.getRowStride());
  }

  @Override
  public void onCameraGone(String why) {
    ui.post(
        () -> {
          trouble = why;
          if (connector != null) connector.cameraGone();
        });
  }

  private final Runnable showNumbers =
      new Runnable() {
        @Override
        public void run() {
          if (connector != null) {
            SlamConnector.Numbers now = connector.numbers();
            numbers.setText(
                getString(
                    R.string.numbers,
                    now.keyframes, now.landmarks, now.matches, now.milliseconds, now.fov,
                    now.metric
                        ? getString(R.string.meters, 100 * now.scaleSigma)
                        : getString(R.string.no_meters)));
            words.setText(firstOf(trouble, connector.words(), renderer.problem(), advice(now)));
          } else {
            words.setText(trouble);
          }
          ui.postDelayed(this, NUMBERS_EVERY_MS);
        }
      };

  private static String firstOf(String... texts) {
    for (String text : texts) {
      if (!text.isEmpty()) return text;
    }
    return "";
  }

  private String advice(SlamConnector.Numbers now) {
    switch (now.state) {
      case SlamConnector.TRACKING:
        return "";
      case SlamConnector.LOST:
        return getString(R.string.lost);
      default:
        return getString(R.string.initializing);
    }
  }
}
