#include "alidade/io/files/calibrations/calibration_text.h"

#include <nlohmann/json.hpp>
#include <string_view>

#include "alidade/base/error.h"
#include "alidade/io/files/calibrations/opencv_xml.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/yaml_check.h"

namespace alidade {
namespace {

constexpr int kMostNodesOfImages = 200000;  // names and values of a list of images, without poses

// The first of several CameraInfo messages, which `---` follows.
std::string_view FirstMessage(std::string_view text) {
  for (size_t end = text.find("\n---"); end != std::string_view::npos;
       end = text.find("\n---", end + 1)) {
    const std::string_view first = text.substr(0, end + 1);
    if (first.find("distortion_model:") != std::string_view::npos) return first;
  }
  return text;
}

// A list of images is much longer than a calibration: their poses are dropped while parsing.
std::string WithoutPoses(const std::string& text, const std::string& name) {
  const nlohmann::json::parser_callback_t keep = [&](int depth, nlohmann::json::parse_event_t event,
                                                     nlohmann::json& parsed) {
    if (depth > kMostYamlDepth)
      ThrowInput(name + ": lists or maps are nested more than " + std::to_string(kMostYamlDepth) +
                 " deep: this is not a camera file");
    return event != nlohmann::json::parse_event_t::key || parsed != "transform_matrix";
  };
  const auto json = nlohmann::json::parse(text, keep, /*allow_exceptions=*/false);
  // Damaged text is reported by the YAML reader, with its line.
  if (json.is_discarded()) return text;
  return json.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}

}  // namespace

YamlFile YamlOfCalibration(const std::string& text, const std::string& name) {
  const std::string_view start = std::string_view(text).substr(0, 2);
  if (start == "\xff\xfe" || start == "\xfe\xff" || text.find('\0') != std::string::npos) {
    ThrowInput(
        name +
        " is not a text file: calibrations are YAML, JSON, XML or text (COLMAP's cameras.bin "
        "becomes text by colmap model_converter --output_type TXT)");
  }
  const size_t begin = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  const bool json = begin != std::string::npos && text[begin] == '{';
  if (json && text.find("\"transform_matrix\"") != std::string::npos)
    return YamlFile(WithoutPoses(text, name), name, kMostNodesOfImages);
  if (text.size() > kMostConfigBytes)
    ThrowInput(name + " is longer than 1 MB: this is not a camera file");
  if (begin != std::string::npos && text[begin] == '<')
    return YamlFile(YamlOfOpenCvXml(text, name), name);
  return YamlFile(std::string(FirstMessage(text)), name);
}

}  // namespace alidade
