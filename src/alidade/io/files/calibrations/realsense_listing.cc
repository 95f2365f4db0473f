// The text that `rs-enumerate-devices -c` prints: for each stream and size
//   Intrinsic of "Color" / 640x480 / {YUYV/RGB8}
//     Width:        640
//     …
//     Coeffs:       0  0  0  0  0
// Older versions separate by tabs instead of slashes.
#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/io/files/calibrations/formats.h"
#include "alidade/io/files/depth_size.h"
#include "alidade/io/text.h"

namespace alidade {
namespace {

constexpr std::string_view kStart = "Intrinsic of \"";

std::string_view Trimmed(std::string_view text) {
  const size_t begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

struct Stream {
  std::string name, size;  // "Infrared 1", "640x480"
  size_t line = 0;         // of its first value, from 0
};

// The stream that a line begins.
std::optional<Stream> StreamOf(std::string_view line) {
  line = Trimmed(line);
  if (line.substr(0, kStart.size()) != kStart) return std::nullopt;
  line.remove_prefix(kStart.size());
  const size_t end = line.find('"');
  if (end == std::string_view::npos) return std::nullopt;
  Stream stream;
  stream.name = line.substr(0, std::min<size_t>(end, 40));
  line = line.substr(end + 1);
  line.remove_prefix(std::min(line.find_first_not_of(" \t/"), line.size()));
  const auto in_size = [](char c) {
    return std::isdigit(static_cast<unsigned char>(c)) || c == 'x';
  };
  const auto size_end = std::find_if_not(line.begin(), line.end(), in_size);
  stream.size.assign(line.begin(), size_end);
  return stream;
}

std::vector<std::string_view> LinesOf(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const size_t end = std::min(text.find('\n'), text.size());
    lines.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

// The streams with intrinsics; those with the size of one before, but another format, are left out:
// they are of images that are not rectified (Y16).
std::vector<Stream> StreamsIn(const std::vector<std::string_view>& lines, const std::string& file) {
  std::vector<Stream> streams;
  int devices = 0;
  for (size_t i = 0; i < lines.size(); ++i) {
    if (Trimmed(lines[i]).substr(0, 13) == "Serial Number" && ++devices > 1)
      ThrowInput(file + ": lists several RealSense devices: keep the text of one");
    auto stream = StreamOf(lines[i]);
    if (!stream || i + 1 == lines.size() || Trimmed(lines[i + 1]).substr(0, 5) != "Width") continue;
    stream->line = i + 1;
    const bool known = std::any_of(streams.begin(), streams.end(), [&](const Stream& other) {
      return other.name == stream->name && other.size == stream->size;
    });
    if (!known) streams.push_back(*stream);
  }
  return streams;
}

// "Color, Infrared 1": each once.
template <typename Name>
std::string Listed(const std::vector<Stream>& streams, const Name& name) {
  std::vector<std::string> names;
  for (const Stream& stream : streams) {
    if (std::find(names.begin(), names.end(), name(stream)) == names.end() && names.size() < 40)
      names.push_back(name(stream));
  }
  std::string text;
  for (const std::string& one : names) text += (text.empty() ? "" : ", ") + one;
  return text;
}

Stream Choose(const std::vector<Stream>& all, const std::string& file, const std::string& which,
              cv::Size images) {
  const auto name = [](const Stream& stream) { return stream.name; };
  const auto size = [](const Stream& stream) { return stream.size; };
  if (all.empty()) ThrowInput(file + ": the RealSense listing has no intrinsics of a stream");
  std::vector<Stream> chosen;
  for (const Stream& stream : all) {
    if (which == stream.name + "/" + stream.size) return stream;
    if (which.empty() || which == stream.name) chosen.push_back(stream);
  }
  const std::string names = Listed(all, name);
  if (chosen.empty()) ThrowInput(file + ": there is no stream `" + which + "`, only " + names);
  if (names != chosen.front().name && which.empty()) {
    ThrowInput(file + ": has the streams " + names + ": choose one, for instance --camera " + file +
               "#" + (names.find("Color") != std::string::npos ? "Color" : chosen.front().name));
  }
  if (chosen.size() == 1) return chosen.front();
  const std::string sizes = Listed(chosen, size);
  for (const Stream& stream : chosen) {
    if (stream.size == SizeText(images)) return stream;
  }
  ThrowInput(file + ": " + chosen.front().name + " has the sizes " + sizes +
             (images.area() > 0 ? ", none for images of " + SizeText(images) : "") +
             ": choose one, for instance --camera " + file + "#" + chosen.front().name + "/" +
             chosen.front().size);
}

// "  PPX:  319.5" as "ppx: 319.5"; empty for a line that is not a value.
std::string YamlLine(std::string_view line) {
  struct Key {
    std::string_view listed, yaml;
  };
  static constexpr std::array<Key, 8> kKeys = {{{"Width", "width"},
                                                {"Height", "height"},
                                                {"PPX", "ppx"},
                                                {"PPY", "ppy"},
                                                {"Fx", "fx"},
                                                {"Fy", "fy"},
                                                {"Distortion", "model"},
                                                {"Coeffs", "coeffs"}}};
  const size_t colon = line.find(':');
  if (colon == std::string_view::npos) return {};
  const std::string_view listed = Trimmed(line.substr(0, colon));
  const auto* key = std::find_if(kKeys.begin(), kKeys.end(),
                                 [&](const Key& known) { return known.listed == listed; });
  if (key == kKeys.end()) return {};
  std::string value;
  for (const std::string_view field : Fields(line.substr(colon + 1)))
    value += (value.empty() ? "" : listed == "Coeffs" ? ", " : " ") + std::string(field);
  if (listed == "Coeffs") value = "[" + value + "]";
  return std::string(key->yaml) + ": " + value;
}

}  // namespace

bool IsRealSenseListing(std::string_view text) {
  const size_t at = text.find(kStart);
  return at != std::string_view::npos && text.find("PPX:", at) != std::string_view::npos &&
         text.find("Coeffs:", at) != std::string_view::npos;
}

std::string YamlOfListing(const std::string& text, const std::string& name,
                          const std::string& which, cv::Size images) {
  const auto lines = LinesOf(text);
  const Stream stream = Choose(StreamsIn(lines, name), name, which, images);
  std::string yaml(stream.line, '\n');  // errors name the line of the file
  for (size_t i = stream.line; i < lines.size() && !Trimmed(lines[i]).empty(); ++i) {
    if (StreamOf(lines[i])) break;
    yaml += YamlLine(lines[i]) + "\n";
  }
  return yaml;
}

}  // namespace alidade
