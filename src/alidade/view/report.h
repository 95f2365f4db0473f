// A run as one HTML file: no script, nothing loaded from elsewhere, fit to be mailed.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "alidade/view/drawings.h"

namespace alidade {

// An image file's bytes, to be shown within the page.
struct ReportPicture {
  std::string caption;
  std::string type;  // "image/png", "image/jpeg"
  std::string bytes;
};

struct RunReport {
  std::string title;                                       // of the recording
  std::vector<std::pair<std::string, std::string>> facts;  // name and value, in the order shown
  PlaceDrawing place;
  std::vector<ReportPicture> shape;  // views of the semi-dense cloud; empty: there is none
  std::vector<FrameFate> frames;
  std::vector<std::pair<std::string, std::vector<double>>> milliseconds;  // of each stage; first:
                                                                          // of whole frames
  std::vector<std::string> lost_spans;                                    // in words
  std::vector<std::string> warnings;
  std::vector<std::pair<std::string, std::string>> settings;
};

std::string RenderReport(const RunReport& report);

std::string Base64(const std::string& bytes);  // RFC 4648, §4

}  // namespace alidade
