// Report of a run as one HTML file without external resources. All essential content is readable
// without scripts; the size is suitable for mail.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "alidade/view/cloud_picture.h"
#include "alidade/view/drawings.h"
#include "alidade/view/plots.h"

namespace alidade {

// An image file's bytes, embedded in the page.
struct ReportPicture {
  std::string caption;
  std::string type;  // "image/png", "image/jpeg"
  std::string bytes;
};

// A keyframe's image with its features, and its depth (no bytes: none).
struct ReportKeyframe {
  std::string caption;
  ReportPicture features, depth;
};

// One map of a run, in its own world frame.
struct ReportMap {
  std::string caption;
  PlaceDrawing place;
};

// A command that continues with the result.
struct ReportStep {
  std::string purpose, command;
};

struct RunReport {
  std::string title;  // of the recording
  std::vector<std::string>
      failure;  // why the run as a whole failed, with advice; empty: it did not
  std::vector<std::string> lost_spans;  // as sentences, with advice
  std::vector<std::string> warnings;
  std::string unit;                                        // of lengths, for example "m"
  std::string on_units;                                    // a sentence about the unit; empty: none
  std::vector<std::pair<std::string, std::string>> facts;  // name and value, in order of display
  std::vector<ReportStep> next;
  std::vector<ReportMap> maps;
  CloudScene cloud;                  // shown interactively; empty: none
  ReportPicture cloud_picture;       // the cloud as a still image, for pages without scripts
  std::vector<ReportPicture> shape;  // further views of the semi-dense cloud; empty: none
  std::vector<ReportKeyframe> keyframes;
  std::vector<FrameFate> frames;
  // Per stage; the first is the whole frame.
  std::vector<std::pair<std::string, std::vector<double>>> milliseconds;
  Curve error;         // distance to the ground truth, meters over seconds; empty: unknown
  double seconds = 0;  // duration of the recording
  std::vector<std::pair<std::string, std::string>> settings;
};

std::string RenderReport(const RunReport& report);

// A report with what a later command made of the result: `html` replaces the section `name`, or is
// added. Returns `page` as it is if it has no place for it (written by an older version).
std::string WithSection(const std::string& page, const std::string& name, const std::string& html);

std::string Base64(const std::string& bytes);  // RFC 4648, §4

}  // namespace alidade
