package org.alidade.phone;

import android.opengl.GLSurfaceView;
import javax.microedition.khronos.egl.EGLConfig;
import javax.microedition.khronos.opengles.GL10;

/** Draws the core's state. All methods run in the GL thread unless noted. */
final class MapRenderer implements GLSurfaceView.Renderer {
  private SlamConnector connector;
  private boolean created;
  private int width = 1, height = 1;
  private volatile int rotation; // degrees clockwise
  private volatile String problem = "";

  /** Sets the rotation that makes the image upright; any thread. */
  void turn(int degrees) {
    rotation = degrees;
  }

  /** Why nothing is drawn; any thread. */
  String problem() {
    return problem;
  }

  /** Switches to another session (null: none); the surface may already exist. */
  void show(SlamConnector next) {
    if (connector != null && created) connector.surfaceGone();
    connector = next;
    if (next == null || !created) return;
    next.surfaceCreated();
    next.surfaceChanged(width, height);
  }

  void drag(float right, float down) {
    if (connector != null) connector.turn(right, down);
  }

  void pinch(float factor) {
    if (connector != null) connector.zoom(factor);
  }

  @Override
  public void onSurfaceCreated(GL10 gl, EGLConfig config) {
    created = true;
    if (connector != null) connector.surfaceCreated();
  }

  @Override
  public void onSurfaceChanged(GL10 gl, int newWidth, int newHeight) {
    width = newWidth;
    height = newHeight;
    if (connector != null) connector.surfaceChanged(width, height);
  }

  @Override
  public void onDrawFrame(GL10 gl) {
    if (connector == null) return;
    try {
      connector.draw(rotation);
      problem = "";
    } catch (IllegalArgumentException | IllegalStateException e) {
      problem = e.getMessage(); // SLAM continues without drawing
    }
  }
}
