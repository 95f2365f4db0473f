// alidade_replay FRAMES TRAJECTORY MAP: the core over the pictures of a file (frames_file.h), in
// the order of one thread: what it writes is compared between processors.
#include <cstdio>
#include <fstream>

#include "alidade/phone/phone_slam.h"
#include "frames_file.h"

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: alidade_replay FRAMES TRAJECTORY MAP\n");
    return 2;
  }
  try {
    const alidade::FramesFile file = alidade::ReadFrames(argv[1]);
    alidade::PhoneSlam slam(file.camera, alidade::PhoneSettings::Default(false));
    alidade::PhoneFrame last;
    int tracked = 0;
    for (const alidade::GreyFrame& frame : file.frames) {
      last = slam.Track(frame.time, frame.pixels.data(), 1);
      if (last.result.state == alidade::TrackState::kTracking) ++tracked;
    }
    slam.Finish();
    std::ofstream(argv[2]) << slam.Trajectory();
    std::ofstream(argv[3], std::ios::binary) << slam.slam().SaveMap();
    std::printf("%zu frames, %d tracked, %d keyframes, %d landmarks\n", file.frames.size(), tracked,
                last.keyframes, last.landmarks);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "alidade_replay: %s\n", error.what());
    return 1;
  }
  return 0;
}
