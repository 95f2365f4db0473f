// What the first messages of the chosen topics tell: the camera, the sensor, the inertial sensor.
#pragma once

#include <optional>
#include <string>

#include "alidade/io/calibration.h"
#include "alidade/io/files/open_source.h"
#include "alidade/io/ros/source/bag_file.h"
#include "alidade/io/ros/source/choose_topics.h"
#include "alidade/io/ros/source/imu_topics.h"

namespace alidade {

struct DescribedTopics {
  SourceInfo info;  // without name and kind
  ImagePreparation preparation;
  BagImu imu;  // unless options.imu says otherwise
};

// The calibration is that of the options, else CameraInfo, else camera.yaml in `beside`, if there
// is such a folder. Throws Error (input or usage).
DescribedTopics DescribeTopics(BagFile& bag, const BagQuery& query, const ChosenTopics& chosen,
                               const std::optional<std::string>& beside,
                               const SourceOptions& options);

}  // namespace alidade
