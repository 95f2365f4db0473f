package org.alidade.phone;

import android.app.Activity;
import android.os.Bundle;
import android.text.InputType;
import android.widget.EditText;
import android.widget.LinearLayout;
import android.widget.ScrollView;
import android.widget.TextView;
import java.util.LinkedHashMap;
import java.util.Map;

/** One line per setting; saved when the activity is left. */
public final class SettingsActivity extends Activity {
  private final Map<String, EditText> fields = new LinkedHashMap<>();
  private Settings settings;

  @Override
  protected void onCreate(Bundle saved) {
    super.onCreate(saved);
    settings = new Settings(this);
    LinearLayout list = new LinearLayout(this);
    list.setOrientation(LinearLayout.VERTICAL);
    int margin = (int) (16 * getResources().getDisplayMetrics().density);
    list.setPadding(margin, margin, margin, margin);
    TextView advice = new TextView(this);
    advice.setText(R.string.settings_advice);
    list.addView(advice);
    int id = 1; // with stable ids the fields' contents survive a screen rotation
    for (String name : settings.names()) {
      TextView label = new TextView(this);
      label.setText(name);
      EditText field = new EditText(this);
      field.setId(id++);
      field.setInputType(InputType.TYPE_CLASS_TEXT | InputType.TYPE_TEXT_FLAG_NO_SUGGESTIONS);
      field.setText(settings.get(name));
      label.setLabelFor(field.getId());
      list.addView(label);
      list.addView(field);
      fields.put(name, field);
    }
    ScrollView page = new ScrollView(this);
    page.addView(list);
    setContentView(page);
  }

  @Override
  protected void onPause() {
    for (Map.Entry<String, EditText> each : fields.entrySet()) {
      settings.set(each.getKey(), each.getValue().getText().toString());
    }
    super.onPause();
  }
}
