// A run as one HTML file: nothing loaded from elsewhere, all that matters readable without scripts,
// fit to be mailed.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "alidade/view/cloud_picture.h"
#include "alidade/view/drawings.h"
#include "alidade/view/plots.h"

namespace alidade {

// An image file's bytes, to be shown within the page.
struct ReportPicture {
  std::string caption;
  std::string type;  // "image/png", "image/jpeg"
  std::string bytes;
};

// A keyframe: its picture with the features found in it, and the depth known there (no bytes:
// none).
struct ReportKeyframe {
  std::string caption;
  ReportPicture features, depth;
};

// One map of a run: a world of its own.
struct ReportMap {
  std::string caption;
  PlaceDrawing place;
};

struct RunReport {
  std::string title;                                       // of the recording
  std::vector<std::pair<std::string, std::string>> facts;  // name and value, in the order shown
  std::vector<ReportMap> maps;
  CloudScene cloud;                  // to be turned; empty: there is none
  ReportPicture cloud_picture;       // of it, where it cannot be
  std::vector<ReportPicture> shape;  // further views of the semi-dense cloud; empty: there are none
  std::vector<ReportKeyframe> keyframes;
  std::vector<FrameFate> frames;
  std::vector<std::pair<std::string, std::vector<double>>> milliseconds;  // of each stage; first:
                                                                          // of whole frames
  std::vector<std::string> lost_spans;  // in words, with what helps
  Curve error;         // distance to the truth, metres over seconds; empty: not known
  double seconds = 0;  // how long the recording is
  std::vector<std::string> warnings;
  std::vector<std::pair<std::string, std::string>> settings;
};

std::string RenderReport(const RunReport& report);

std::string Base64(const std::string& bytes);  // RFC 4648, §4

}  // namespace alidade
