// alidade_frames SOURCE COUNT WIDTH FILE: the first pictures of a recording, or of a rendered one,
// scaled to a width, as one file (frames_file.h).
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <opencv2/imgproc.hpp>

#include "alidade/base/error.h"
#include "alidade/run/sources/any_source.h"

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: alidade_frames SOURCE COUNT WIDTH FILE\n");
    return 2;
  }
  try {
    const auto source = alidade::OpenAnySource(argv[1]);
    const int count = std::atoi(argv[2]);
    const alidade::Camera camera = source->Info().camera.ScaledToWidth(std::atoi(argv[3]));
    std::ofstream file(argv[4], std::ios::binary);
    file.precision(17);
    file << "alidade-frames " << camera.width << ' ' << camera.height << ' ' << count << ' '
         << camera.fx << ' ' << camera.fy << ' ' << camera.cx << ' ' << camera.cy << '\n';
    for (int i = 0; i < count; ++i) {
      const auto frame = source->Next();
      if (!frame || frame->image.empty()) alidade::ThrowInput("there are too few pictures");
      cv::Mat image;
      cv::resize(frame->image, image, {camera.width, camera.height}, 0, 0, cv::INTER_AREA);
      file.write(reinterpret_cast<const char*>(&frame->time), sizeof(frame->time));
      file.write(image.ptr<char>(), static_cast<std::streamsize>(image.total()));
    }
    if (!file.flush()) alidade::ThrowInput("it cannot be written");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "alidade_frames: %s: %s\n", argv[1], error.what());
    return 1;
  }
  return 0;
}
