#include "alidade/run/setup/settings_file.h"

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/yaml.h"

namespace alidade {
namespace {

std::string At(const std::string& path, const YAML::Node& node) {
  return path + ":" + std::to_string(node.Mark().line + 1) + ": ";
}

void Apply(const std::string& path, const YAML::Node& map, const std::string& prefix,
           RunSettings& settings) {
  for (const auto& entry : map) {
    const std::string where = At(path, entry.first);
    if (!entry.first.IsScalar()) ThrowUsage(where + "expected `name: value`");
    const std::string name = prefix + entry.first.Scalar();
    if (entry.second.IsMap()) {
      Apply(path, entry.second, name + ".", settings);
    } else if (entry.second.IsScalar()) {
      try {
        settings.Set(name, entry.second.Scalar());
      } catch (const Error& error) {
        throw Error(error.kind(), where + error.what());
      }
    } else {
      ThrowUsage(where + "setting " + name + " needs one value");
    }
  }
}

}  // namespace

void ApplySettingsFile(const std::string& path, RunSettings& settings) {
  ApplySettingsText(ReadFile(path, kMostConfigBytes), path, settings);
}

void ApplySettingsText(const std::string& text, const std::string& name, RunSettings& settings) {
  Apply(name, YamlFile(text, name).root(), "", settings);
}

}  // namespace alidade
