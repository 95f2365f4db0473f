// A run as one HTML file: no script, nothing loaded from elsewhere, fit to be mailed.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "alidade/view/drawings.h"

namespace alidade {

struct RunReport {
  std::string title;                                       // of the recording
  std::vector<std::pair<std::string, std::string>> facts;  // name and value, in the order shown
  PlaceDrawing place;
  std::vector<FrameFate> frames;
  std::vector<std::pair<std::string, std::vector<double>>> milliseconds;  // of each stage; first:
                                                                          // of whole frames
  std::vector<std::string> lost_spans;                                    // in words
  std::vector<std::string> warnings;
  std::vector<std::pair<std::string, std::string>> settings;
};

std::string RenderReport(const RunReport& report);

}  // namespace alidade
