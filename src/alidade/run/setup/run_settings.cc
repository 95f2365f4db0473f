#include "alidade/run/setup/run_settings.h"

#include "alidade/system/setting_names.h"

namespace alidade {

void RunSettings::Check() const {
  slam.Check();
  stream.Check();
  look.Check();
  lens.Check();
  calibrate.Check();
}

std::vector<SettingsPart> RunSettings::Parts() {
  std::vector<SettingsPart> parts = slam.Parts();
  CameraEstimateSettings& estimate = calibrate;
  for (const SettingsPart& part : {PartOf(stream), PartOf(stream.stream), PartOf(look),
                                   PartOf(lens), PartOf(calibrate), PartOf(estimate)})
    parts.push_back(part);
  return parts;
}

void RunSettings::Set(const std::string& name, const std::string& value) {
  SetByName(Parts(), name, value);
}

std::vector<std::pair<std::string, std::string>> RunSettings::All() const {
  RunSettings copy = *this;
  return AllByName(copy.Parts());
}

}  // namespace alidade
