// The images of a recording without distortion, with poses and colored points: what trainers of
// radiance fields and Gaussian splats take.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "alidade/io/cloud.h"
#include "alidade/io/colmap.h"
#include "alidade/run/export/export_folder.h"
#include "alidade/run/export/frame_choice.h"
#include "alidade/run/export/own_recording.h"

namespace alidade {

// Called as frames are read; `total` is -1 if unknown. Returns false to stop.
using ExportProgress = std::function<bool(int frames, int total)>;
struct ExportStopped {};  // thrown then; nothing was written

struct TrainingSettings {
  FrameChoice choice;
  int min_observations = 2;  // of points, by exported keyframes
  bool centered = false;     // see PinholeSettings
  bool masks = false;        // of the result folder's mask.txt, as masks/NAME.png
};

struct TrainingSet {
  // Images in order of time. Keypoints and tracks are those of keyframes, in pixels of the exported
  // images. Colors are the mean of those of all observations.
  ColmapModel model;
  bool masks = false;
  int other = 0;        // keyframes of other recordings, which are not exported
  cv::Mat shown;        // the written image of the keyframe with most landmarks
  int shown_image = 0;  // its index in the model
  int missing = 0;      // keyframes whose frames were not found or could not be read
};

// Reads the recording once and writes images/NAME (and masks/NAME.png) to `folder`. Throws Error:
// usage if frames besides keyframes are wanted and the result has no trajectory; input if no image
// shows what the map was made of, or an image cannot be written.
TrainingSet WriteTrainingImages(const SavedMap& saved, const MapPart& part, OwnRecording& recording,
                                const TrainingSettings& settings, const ExportProgress& progress,
                                ExportFolder& folder);

// The landmarks in the colors of the recording's images, gray where no image is there. Throws as
// above.
Cloud ColoredCloud(const SavedMap& saved, const MapPart& part, OwnRecording& recording,
                   const ExportProgress& progress);

}  // namespace alidade
