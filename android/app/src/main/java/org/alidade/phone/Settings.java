package org.alidade.phone;

import android.content.Context;
import android.content.SharedPreferences;
import java.io.IOException;
import java.io.InputStream;
import java.util.Properties;
import java.util.TreeMap;

/**
 * User settings, stored in SharedPreferences with defaults from assets/defaults.properties. Names
 * with a dot are settings of the core, as after --set.
 */
final class Settings {
  private static final String FILE = "settings";
  private final SharedPreferences kept;
  private final TreeMap<String, String> defaults = new TreeMap<>();

  Settings(Context context) {
    kept = context.getSharedPreferences(FILE, Context.MODE_PRIVATE);
    Properties properties = new Properties();
    try (InputStream in = context.getAssets().open("defaults.properties")) {
      properties.load(in);
    } catch (IOException e) {
      throw new IllegalStateException("assets/defaults.properties is part of the app", e);
    }
    for (String name : properties.stringPropertyNames()) {
      defaults.put(name, properties.getProperty(name));
    }
  }

  Iterable<String> names() {
    return defaults.keySet();
  }

  String get(String name) {
    return kept.getString(name, defaults.get(name));
  }

  /** An empty value restores the default. */
  void set(String name, String value) {
    String text = value.trim();
    if (text.isEmpty() || text.equals(defaults.get(name))) {
      kept.edit().remove(name).apply();
    } else {
      kept.edit().putString(name, text).apply();
    }
  }

  int width() {
    return (int) number("camera_width", 640);
  }

  /** Degrees; 0: use the phone's calibration. */
  double fov() {
    return number("field_of_view", 0);
  }

  /** Path of the user's detector network, or null. */
  String detector() {
    String path = get("detector");
    return path == null || path.isEmpty() ? null : path;
  }

  /** Settings of the core as lines of name=value. */
  String forCore() {
    StringBuilder lines = new StringBuilder();
    for (String name : defaults.keySet()) {
      if (name.indexOf('.') >= 0) lines.append(name).append('=').append(get(name)).append('\n');
    }
    return lines.toString();
  }

  private double number(String name, double otherwise) {
    try {
      return Double.parseDouble(get(name));
    } catch (NumberFormatException | NullPointerException e) {
      return otherwise;
    }
  }
}
