// Compares several runs in one HTML file without scripts or external resources.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "alidade/view/plots.h"

namespace alidade {

struct ComparedRun {
  std::string name;
  std::vector<std::string> values;  // one per measure of the comparison
  DrawnPath path;                   // in the world of its place; empty: nothing was mapped
  std::vector<FateSpan> fates;
  Curve error;                          // meters over seconds; empty: no ground truth
  std::vector<MedianBar> milliseconds;  // one per stage of the comparison
};

// Runs that are drawn in one world.
struct ComparedPlace {
  std::vector<size_t> runs;  // indices
  DrawnPath truth;           // may be empty
  std::string unit;          // of the paths
};

struct RunComparison {
  std::vector<std::string> measures;
  std::vector<std::string> stages;  // the first is the whole frame
  std::vector<ComparedRun> runs;
  std::vector<ComparedPlace> places;  // drawn side by side
  double seconds = 0;                 // duration of the longest recording
  std::vector<std::string> notes;     // what could not be compared, and how the paths were aligned
};

std::string RenderComparison(const RunComparison& comparison);

}  // namespace alidade
