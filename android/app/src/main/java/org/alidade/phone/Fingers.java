package org.alidade.phone;

import android.annotation.SuppressLint;
import android.opengl.GLSurfaceView;
import android.view.GestureDetector;
import android.view.MotionEvent;
import android.view.ScaleGestureDetector;
import android.view.View;

/** Touch gestures: a drag rotates the map, a pinch zooms. */
final class Fingers implements View.OnTouchListener {
  private final GestureDetector drags;
  private final ScaleGestureDetector pinches;

  Fingers(GLSurfaceView surface, MapRenderer renderer) {
    drags =
        new GestureDetector(
            surface.getContext(),
            new GestureDetector.SimpleOnGestureListener() {
              @Override
              public boolean onDown(MotionEvent e) {
                return true;
              }

              @Override
              public boolean onScroll(MotionEvent from, MotionEvent to, float left, float up) {
                surface.queueEvent(() -> renderer.drag(-left, -up));
                return true;
              }
            });
    pinches =
        new ScaleGestureDetector(
            surface.getContext(),
            new ScaleGestureDetector.SimpleOnScaleGestureListener() {
              @Override
              public boolean onScale(ScaleGestureDetector detector) {
                float factor = detector.getScaleFactor();
                surface.queueEvent(() -> renderer.pinch(factor));
                return true;
              }
            });
    surface.setOnTouchListener(this);
  }

  @Override
  @SuppressLint("ClickableViewAccessibility") // not clickable
  public boolean onTouch(View view, MotionEvent event) {
    pinches.onTouchEvent(event);
    if (!pinches.isInProgress()) drags.onTouchEvent(event);
    return true;
  }
}
