// Settings of what keeps moving things out of pose and map.
#pragma once

#include <cstdint>
#include <string>

#include "alidade/base/api.h"
#include "alidade/detect/settings.h"

namespace ALIDADE_API alidade {

enum class DynamicsMode {
  kOff,       // everything is taken to stand still
  kGeometry,  // what moves against the rest is left out
  kFull       // and so is what a detector knows to move by itself, even while it rests
};

const char* NameOf(DynamicsMode mode);  // off, geometry, full
// Throws Error (usage) for a word that names none; `what` is whose word it is.
DynamicsMode DynamicsModeNamed(const std::string& what, const std::string& word);

struct DynamicsSettings {
  DynamicsMode mode = DynamicsMode::kOff;

  // Names as the detector has them, with commas between.
  std::string moving_classes =
      "person,cat,dog,horse,sheep,cow,elephant,bear,zebra,giraffe,bird,bicycle,motorcycle,car,bus,"
      "truck,train,boat,airplane";
  std::string carried_classes =  // things that move when someone moves them
      "chair,backpack,umbrella,handbag,suitcase,sports ball,skateboard,bottle,cup,bowl,laptop,"
      "book,cell phone,teddy bear";

  DetectorSettings detector;

  // Inline schedule: every so many frames one is given to the detector, whose answer is there so
  // many frames later, as a network that takes 0.2 s would have it.
  int detector_every_frames = 6;
  int detector_latency_frames = 6;
  // Threaded: the detector rests after each frame this share of the time that it took, so that
  // tracking and mapping have the processor.
  double detector_rest = 0.5;
  double drop_detections = 0;   // share of its answers that are thrown away, for studies
  double bridge_seconds = 1.0;  // a thing that is no longer detected is kept for as long

  // What each part is worth can be tried by leaving it out.
  bool foreground = true;  // of a box only the mover's own pixels; false: all of it
  bool geometry = true;    // flow, epipolar lines and depth against the predicted pose
  bool propagate = true;   // detections are carried to the present frame; false: used as they come
  bool weigh = true;       // belief weighs residuals; false: a feature counts fully or not at all

  uint64_t seed = 1;  // of random samples; the system's

  void Check() const;  // throws Error (usage) naming the field that cannot be
};

}  // namespace alidade
