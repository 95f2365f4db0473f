// Readers of untrusted bytes. The fuzzer (scripts/check/fuzz) runs each with millions of inputs,
// corpus_test.cc with a selection.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace alidade::fuzz {

// Passes `bytes` to the functions with which the program reads such a file. Throws Error when they
// reject it. Any other exception, including std::logic_error from Expect(), is a bug.
using TargetFunction = void(std::string_view bytes);

TargetFunction Map;               // map.alidade: reading
TargetFunction MapAgain;          // reading, using, writing and reading again
TargetFunction CameraFile;        // camera.yaml, and preparing frames with it
TargetFunction EurocCamera;       // EuRoC's sensor.yaml
TargetFunction KittiCalibration;  // KITTI's calib.txt
TargetFunction Config;            // --config
TargetFunction Png;
TargetFunction Jpeg;
TargetFunction List;        // rgb.txt, data.csv, times.txt
TargetFunction Trajectory;  // groundtruth.txt and other formats
TargetFunction Onnx;        // the checks of a detector's file before OpenCV reads it
TargetFunction ClassNames;  // class names in a detector's metadata
TargetFunction Stream;      // a message of run.stream
TargetFunction Bag;         // ROS bag 2.0, with its messages
TargetFunction Mcap;        // the same for MCAP
TargetFunction Database;    // the same for rosbag2's databases
TargetFunction RosMessage;  // images and calibrations as messages

struct Target {
  std::string name;  // name of its folder in tests/fuzz/corpus
  TargetFunction* run;
};
const std::vector<Target>& Targets();

// Runs the target on a copy of `bytes` in exactly sized memory, so that sanitizers detect reads
// past the end. Returns false when the target threw Error; other exceptions pass through.
bool Accepts(const Target& target, std::string_view bytes);

// Throws std::logic_error with the text `what`: a bug.
void Expect(bool holds, const std::string& what);

}  // namespace alidade::fuzz
