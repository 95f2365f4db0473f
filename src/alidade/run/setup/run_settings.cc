#include "alidade/run/setup/run_settings.h"

#include <algorithm>

namespace alidade {

void RunSettings::Check() const {
  slam.Check();
  stream.Check();
  look.Check();
  lens.Check();
  calibrate.Check();
}

void RunSettings::Set(const std::string& name, const std::string& value) {
  if (name.rfind("stream.", 0) == 0) {
    stream.Set(name, value);
  } else if (name.rfind("look.", 0) == 0) {
    look.Set(name, value);
  } else if (name.rfind("lens.", 0) == 0) {
    lens.Set(name, value);
  } else if (name.rfind("calibrate.", 0) == 0) {
    calibrate.Set(name, value);
  } else {
    slam.Set(name, value);
  }
}

std::vector<std::pair<std::string, std::string>> RunSettings::All() const {
  auto all = slam.All();
  for (auto& setting : stream.All()) all.push_back(std::move(setting));
  for (auto& setting : look.All()) all.push_back(std::move(setting));
  for (auto& setting : calibrate.All()) all.push_back(std::move(setting));
  for (auto& setting : lens.All()) all.push_back(std::move(setting));
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace alidade
