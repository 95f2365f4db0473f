// What reads bytes that somebody else wrote. The fuzzer (scripts/check/fuzz) feeds each of these
// with millions of inputs; corpus_test.cc with those worth keeping.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace alidade::fuzz {

// Hands `bytes` to the functions the program reads such a file with. Throws Error when they refuse
// it. Whatever else is thrown is a bug, std::logic_error by Expect() among it.
using TargetFunction = void(std::string_view bytes);

TargetFunction Map;               // map.alidade: read
TargetFunction MapAgain;          // read, used, written and read again
TargetFunction CameraFile;        // camera.yaml, and frames prepared by it
TargetFunction EurocCamera;       // EuRoC's sensor.yaml
TargetFunction KittiCalibration;  // KITTI's calib.txt
TargetFunction Config;            // --config
TargetFunction Png;
TargetFunction Jpeg;
TargetFunction List;        // rgb.txt, data.csv, times.txt
TargetFunction Trajectory;  // groundtruth.txt and its kin
TargetFunction Onnx;        // what is read of a detector's file before OpenCV sees it
TargetFunction ClassNames;  // of a detector's metadata
TargetFunction Stream;      // a message of run.stream
TargetFunction Bag;         // ROS bag 2.0, and the messages in it
TargetFunction Mcap;        // the same of MCAP
TargetFunction Database;    // and of rosbag2's databases
TargetFunction RosMessage;  // pictures and calibrations as messages

struct Target {
  std::string name;  // its folder in tests/fuzz/corpus
  TargetFunction* run;
};
const std::vector<Target>& Targets();

// Runs it on a copy of `bytes` that ends where its memory does, as sanitizers want it. False when
// they were refused (Error); lets everything else through.
bool Accepts(const Target& target, std::string_view bytes);

// Throws std::logic_error saying `what`: a bug.
void Expect(bool holds, const std::string& what);

}  // namespace alidade::fuzz
