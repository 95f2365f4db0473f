#include "alidade/run/export/image_names.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "alidade/base/print.h"

namespace alidade {
namespace {

std::string LowerCase(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::string EndingOf(const std::string& name) {
  const size_t dot = name.rfind('.');
  return dot == std::string::npos || dot == 0 ? "" : name.substr(dot);
}

bool IsUtf8(const std::string& text) {
  try {
    nlohmann::json(text).dump();
    return true;
  } catch (const nlohmann::json::exception&) {
    return false;
  }
}

std::string Sanitized(std::string name) {
  const bool utf8 = IsUtf8(name);
  for (char& c : name) {
    const auto byte = static_cast<unsigned char>(c);
    const bool bad = byte <= 0x20 || byte == 0x7f || c == '"' || c == '\'' || c == '\\';
    if (bad || (byte >= 0x80 && !utf8)) c = '_';
  }
  return name;
}

}  // namespace

bool ImageNames::IsJpeg(const std::string& name) {
  const std::string ending = LowerCase(EndingOf(name));
  return ending == ".jpg" || ending == ".jpeg";
}

std::string ImageNames::NameOf(const SourceFrame& frame) {
  std::string name;
  const auto number_of_file = static_cast<size_t>(frame.number);
  if (number_of_file >= files_.size()) {
    char number[40];
    PrintTo(number, sizeof(number), "frame_%06d", frame.number);
    name = number + std::string(video_ ? ".jpg" : ".png");
  } else {
    name = Sanitized(std::filesystem::path(files_[number_of_file]).filename().string());
    if (!IsJpeg(name) && LowerCase(EndingOf(name)) != ".png")
      name = name.substr(0, name.size() - EndingOf(name).size()) + ".png";
  }
  const std::string ending = EndingOf(name), stem = name.substr(0, name.size() - ending.size());
  for (int i = 2; !taken_.insert(name).second; ++i) name = stem + "-" + std::to_string(i) + ending;
  return name;
}

}  // namespace alidade
