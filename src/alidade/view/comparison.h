// Several runs beside each other as one HTML file: no script, nothing loaded from elsewhere.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "alidade/view/plots.h"

namespace alidade {

struct ComparedRun {
  std::string name;
  std::vector<std::string> values;  // one for each of the comparison's measures
  DrawnPath path;                   // in the comparison's world; empty: cannot be laid there
  std::vector<FateSpan> fates;
  Curve error;                          // metres over seconds; empty: no truth
  std::vector<MedianBar> milliseconds;  // one for each of the comparison's stages
};

struct RunComparison {
  std::vector<std::string> measures;
  std::vector<std::string> stages;  // the first: whole frames
  std::vector<ComparedRun> runs;
  DrawnPath truth;
  std::string unit;                // of the paths
  double seconds = 0;              // the longest recording
  std::vector<std::string> notes;  // on what could not be compared, and how paths were laid
};

std::string RenderComparison(const RunComparison& comparison);

}  // namespace alidade
