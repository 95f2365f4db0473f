#include "alidade/io/files/media.h"

#include <cstdlib>

#include "alidade/base/error.h"
#include "alidade/base/module/load_module.h"
#include "alidade/geometry/picture_size.h"

namespace alidade {
namespace {

struct Module {
  MediaDecodeFunction* decode = nullptr;
  MediaOpenFunction* open = nullptr;
  MediaFocalFunction* focal = nullptr;
  MediaPacketsFunction* packets = nullptr;
  std::string problem;
};

Module LoadMediaModule() {
  // OpenCV's default limit is 2^30 pixels. It reads this variable when it is loaded.
  setenv("OPENCV_IO_MAX_IMAGE_PIXELS", std::to_string(kMostPixels).c_str(), 0);
  const LoadedModule loaded =
      LoadModule(kMediaModuleFile, {"alidade_media_decode", "alidade_media_open",
                                    "alidade_media_focal", "alidade_media_packets"});
  if (loaded.symbols.empty()) return {nullptr, nullptr, nullptr, nullptr, loaded.problem};
  return {reinterpret_cast<MediaDecodeFunction*>(loaded.symbols[0]),
          reinterpret_cast<MediaOpenFunction*>(loaded.symbols[1]),
          reinterpret_cast<MediaFocalFunction*>(loaded.symbols[2]),
          reinterpret_cast<MediaPacketsFunction*>(loaded.symbols[3]),
          {}};
}

const Module& TheModule() {
  static const Module module = LoadMediaModule();
  return module;
}

std::unique_ptr<MediaStream> Open(const std::string& path, bool live, const std::string& name,
                                  const std::string& advice) {
  const Module& module = TheModule();
  if (module.open == nullptr)
    ThrowInput(name + " needs " + kMediaModuleFile + ": " + module.problem);
  std::unique_ptr<MediaStream> stream(module.open(path.c_str(), live));
  if (!stream) ThrowInput(name + " cannot be opened: " + advice);
  return stream;
}

}  // namespace

double FocalLength35OfImage(std::string_view bytes) {
  const Module& module = TheModule();
  return module.focal == nullptr ? 0 : module.focal(bytes.data(), bytes.size());
}

DecodedImage DecodeByMediaModule(std::string_view bytes, ImageUse use) {
  const Module& module = TheModule();
  if (module.decode == nullptr) {
    return {{},
            std::string("is neither a JPEG nor a PNG, and other images need ") + kMediaModuleFile +
                ": " + module.problem};
  }
  DecodedImage decoded;
  if (!module.decode(bytes.data(), bytes.size(), static_cast<int>(use), &decoded.image)) {
    return {{}, "is not an image, or damaged"};
  }
  if (use == ImageUse::kDepth && decoded.image.type() == CV_8UC1) return {{}, kDepthOf8Bits};
  if (use == ImageUse::kDepth && decoded.image.type() != CV_16UC1 &&
      decoded.image.type() != CV_32FC1) {
    return {{}, "is a color image: depth images have one channel"};
  }
  return decoded;
}

std::unique_ptr<MediaStream> OpenVideo(const std::string& path) {
  return Open(path, false, path, "it is not a known video or image folder");
}

std::unique_ptr<MediaStream> OpenLiveVideo(const std::string& address, const std::string& name) {
  return Open(address, true, name, "nothing answers there, or it is not a video");
}

std::unique_ptr<PacketDecoder> OpenPacketDecoder(PacketCodec codec) {
  const Module& module = TheModule();
  if (module.packets == nullptr)
    ThrowInput(std::string("needs ") + kMediaModuleFile + ": " + module.problem);
  std::unique_ptr<PacketDecoder> decoder(module.packets(codec));
  if (!decoder) {
    ThrowInput(std::string("is ") + (codec == PacketCodec::kH264 ? "H.264" : "H.265") +
               ", which this system's FFmpeg does not decode");
  }
  return decoder;
}

}  // namespace alidade
