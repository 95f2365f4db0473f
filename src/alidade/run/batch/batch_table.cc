#include "alidade/run/batch/batch_table.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "alidade/base/error.h"
#include "alidade/base/print.h"
#include "alidade/run/folder/result_folder.h"
#include "alidade/run/play/loop.h"
#include "alidade/run/sources/truth.h"

namespace alidade {
namespace {

using nlohmann::ordered_json;

constexpr int kBatchVersion = 1;
constexpr char kAligned[] =
    "Errors after alignment by Sim(3) with one camera (mono), else by SE(3).";

std::string TextOf(const char* format, const std::optional<double>& value, double factor = 1) {
  if (!value) return "–";
  char text[64];
  PrintTo(text, sizeof(text), format, factor * *value);
  return text;
}

constexpr std::array kColumns = {"recording", "sensor",  "frames", "tracked %", "maps",  "ATE m",
                                 "RPE m/s",   "RPE °/s", "ms",     "p95 ms",    "CPU s", "MB"};

std::vector<std::string> CellsOf(const BatchRow& row) {
  return {row.name,
          row.sensor.empty() ? "–" : row.sensor,
          TextOf("%.0f", row.frames),
          TextOf("%.1f", row.coverage, 100),
          TextOf("%.0f", row.maps),
          TextOf("%.4f", row.ate),
          TextOf("%.4f", row.rpe),
          TextOf("%.3f", row.rpe_deg),
          TextOf("%.1f", row.ms),
          TextOf("%.1f", row.ms_p95),
          TextOf("%.1f", row.cpu_s),
          TextOf("%.0f", row.peak_mb)};
}

// Text of a row without figures.
std::string FateOf(const BatchRow& row) {
  return row.state + (row.message.empty() ? "" : ": " + row.message);
}

// Number of characters in UTF-8.
size_t WidthOf(const std::string& text) {
  return static_cast<size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xc0) != 0x80;
  }));
}

std::string Padded(const std::string& text, size_t width, bool left) {
  const std::string blanks(width > WidthOf(text) ? width - WidthOf(text) : 0, ' ');
  return left ? text + blanks : blanks + text;
}

struct Field {
  const char* name;
  std::optional<double> BatchRow::*value;
};
constexpr std::array kFields = {
    Field{"frames", &BatchRow::frames},   Field{"coverage", &BatchRow::coverage},
    Field{"maps", &BatchRow::maps},       Field{"keyframes", &BatchRow::keyframes},
    Field{"ate", &BatchRow::ate},         Field{"rpe", &BatchRow::rpe},
    Field{"rpe_deg", &BatchRow::rpe_deg}, Field{"ms", &BatchRow::ms},
    Field{"ms_p95", &BatchRow::ms_p95},   Field{"cpu_s", &BatchRow::cpu_s},
    Field{"wall_s", &BatchRow::wall_s},   Field{"peak_mb", &BatchRow::peak_mb}};

// As a cell of a Markdown table, which may hold HTML.
std::string Escaped(const std::string& text) {
  std::string cell;
  for (const char c : text) {
    if (c == '|') {
      cell += "\\|";
    } else if (c == '<') {
      cell += "&lt;";
    } else if (c == '&') {
      cell += "&amp;";
    } else {
      cell += c >= 0 && c < ' ' ? ' ' : c;
    }
  }
  return cell;
}

}  // namespace

BatchRow RowOf(const BatchFolder& folder, const BatchItem& item) {
  BatchRow row;
  row.name = item.name;
  row.source = SourceOf(item);
  const std::optional<BatchDone> done = folder.DoneOf(item);
  if (!done) return row;
  row.wall_s = done->wall_s;
  if (done->status != 0) {
    row.state = done->status == kInterruptedStatus ? "interrupted" : "failed";
    row.message = done->message;
    return row;
  }
  row.state = "ok";
  try {
    const ResultFolder result = ReadResultFolder(folder.ResultOf(item));
    row.sensor = result.sensor;
    row.frames = result.frames;
    row.coverage = result.coverage;
    row.maps = result.maps;
    row.keyframes = result.keyframes;
    row.cpu_s = result.cpu_s;
    row.peak_mb = result.peak_mb;
    const MedianBar& frame = result.milliseconds.front();
    if (frame.median >= 0) {
      row.ms = frame.median;
      row.ms_p95 = frame.p95;
    }
    if (result.truth.empty() || result.trajectory.empty()) return row;
    std::string problem;
    const auto errors =
        ErrorsAgainst(result.truth, result.trajectory, result.mono(), result.span, &problem);
    row.message = problem;
    if (!errors) return row;
    row.ate = errors->ate.error.rmse;
    if (!errors->rpe) return row;
    row.rpe = errors->rpe->trans.rmse;
    row.rpe_deg = errors->rpe->rot.rmse;
  } catch (const Error& error) {
    row.state = "failed";
    row.message = error.what();
  }
  return row;
}

std::string BatchJson(const std::vector<BatchRow>& rows) {
  ordered_json list = ordered_json::array();
  for (const BatchRow& row : rows) {
    ordered_json item = {{"name", row.name},
                         {"source", row.source},
                         {"state", row.state},
                         {"message", row.message},
                         {"sensor", row.sensor}};
    for (const Field& field : kFields) {
      const auto& value = row.*field.value;
      item[field.name] = value ? ordered_json(*value) : ordered_json(nullptr);
    }
    list.push_back(std::move(item));
  }
  const ordered_json all = {{"version", kBatchVersion}, {"recordings", list}};
  return all.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::vector<BatchRow> ParseBatchJson(const std::string& text, const std::string& name) {
  const auto all = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!all.is_object() || !all.contains("recordings") || !all["recordings"].is_array())
    ThrowInput(name + " was not written by `alidade batch`");
  std::vector<BatchRow> rows;
  for (const auto& item : all["recordings"]) {
    if (!item.is_object()) continue;
    const auto word = [&](const char* key) {
      return item.contains(key) && item[key].is_string() ? item[key].get<std::string>() : "";
    };
    BatchRow row;
    row.name = word("name");
    row.source = word("source");
    row.state = word("state");
    row.message = word("message");
    row.sensor = word("sensor");
    for (const Field& field : kFields) {
      if (item.contains(field.name) && item[field.name].is_number())
        row.*field.value = item[field.name].get<double>();
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

std::string BatchMarkdown(const std::vector<BatchRow>& rows) {
  std::string text = "|", line = "|";
  for (const char* column : kColumns) {
    text += std::string(" ") + column + " |";
    line += "---|";
  }
  text += "\n" + line + "\n";
  for (const BatchRow& row : rows) {
    std::vector<std::string> cells = CellsOf(row);
    if (!row.ok()) cells[1] = FateOf(row);
    text += "|";
    for (const std::string& cell : cells) text += " " + Escaped(cell) + " |";
    text += "\n";
  }
  return text + "\n" + kAligned + "\n";
}

std::string BatchText(const std::vector<BatchRow>& rows) {
  std::vector<std::vector<std::string>> lines = {{kColumns.begin(), kColumns.end()}};
  for (const BatchRow& row : rows) lines.push_back(CellsOf(row));
  std::vector<size_t> widths(kColumns.size(), 0);
  for (size_t i = 0; i < lines.size(); ++i) {
    const bool figures = i == 0 || rows[i - 1].ok();
    for (size_t k = 0; k < widths.size() && (figures || k == 0); ++k)
      widths[k] = std::max(widths[k], WidthOf(lines[i][k]));
  }
  std::string text;
  for (size_t i = 0; i < lines.size(); ++i) {
    std::string line = Padded(lines[i][0], widths[0], true);
    if (i > 0 && !rows[i - 1].ok()) {
      line += "  " + FateOf(rows[i - 1]);
    } else {
      for (size_t k = 1; k < widths.size(); ++k)
        line += "  " + Padded(lines[i][k], widths[k], k == 1);
    }
    text += line + "\n";
  }
  return text + kAligned + "\n";
}

WorseBy ParseWorseBy(const std::string& option, const std::string& text,
                     const std::vector<std::pair<std::string, double>>& units) {
  if (text == "off") return {};
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  std::string unit = end;
  unit.erase(0, unit.find_first_not_of(' ') == std::string::npos ? 0 : unit.find_first_not_of(' '));
  const bool good = end != text.c_str() && number > 0 && number < 1e9;
  if (good && unit == "%") return {number / 100, 0};
  std::string known = "%";
  for (const auto& [name, size] : units) {
    if (good && unit == name) return {0, number * size};
    known += ", " + name;
  }
  ThrowUsage(option + " must be a tolerance with a unit (" + known + "), or off; not '" + text +
             "'");
}

std::vector<std::string> WorseThan(const std::vector<BatchRow>& earlier,
                                   const std::vector<BatchRow>& now,
                                   const WorseSettings& settings) {
  struct Figure {
    const char* name;
    const char* format;  // with that format
    double factor;
    std::optional<double> BatchRow::*value;
    WorseBy by;
    double sign;  // +1: more is worse
  };
  const std::array figures = {
      Figure{"ATE", "%.4f m", 1, &BatchRow::ate, settings.ate, 1},
      Figure{"RPE", "%.4f m/s", 1, &BatchRow::rpe, settings.rpe, 1},
      Figure{"tracked", "%.1f %%", 100, &BatchRow::coverage, settings.coverage, -1},
      Figure{"median", "%.1f ms", 1, &BatchRow::ms, settings.ms, 1},
      Figure{"CPU", "%.1f s", 1, &BatchRow::cpu_s, settings.cpu, 1},
      Figure{"memory", "%.0f MB", 1, &BatchRow::peak_mb, settings.memory, 1}};
  std::map<std::string, const BatchRow*> before;
  for (const BatchRow& row : earlier) before[row.name] = &row;
  std::vector<std::string> worse;
  for (const BatchRow& row : now) {
    const auto found = before.find(row.name);
    if (found == before.end() || !found->second->ok()) continue;
    const BatchRow& old = *found->second;
    if (!row.ok()) {
      worse.push_back(row.name + ": " + FateOf(row) + ", and was ok before");
      continue;
    }
    for (const Figure& figure : figures) {
      const auto &then = old.*figure.value, &here = row.*figure.value;
      if (!figure.by.on() || !then) continue;
      if (!here) {
        worse.push_back(row.name + ": " + figure.name + " is unknown, but was " +
                        TextOf(figure.format, then, figure.factor));
        continue;
      }
      const double more = figure.sign * (*here - *then);
      const double most = figure.by.share > 0 ? figure.by.share * *then : figure.by.amount;
      if (more <= most) continue;
      worse.push_back(row.name + ": " + figure.name + " " +
                      TextOf(figure.format, here, figure.factor) + ", was " +
                      TextOf(figure.format, then, figure.factor));
    }
  }
  return worse;
}

}  // namespace alidade
