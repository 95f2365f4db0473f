// build/bin/fuzz_make_corpus FOLDER: writes the binary files of tests/fuzz/corpus: small maps,
// networks, ROS recordings, and a rendered room in all kinds of PNG and JPEG.
#include <png.h>

#include <filesystem>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "alidade/io/files/file.h"
#include "alidade/io/files/image_codec.h"
#include "alidade/synth/recording.h"
#include "bags.h"
#include "detect/tiny_network.h"
#include "support/map_bytes.h"
#include "support/saved_map.h"

namespace alidade {
namespace {

std::string folder;

void Write(const std::string& target, const std::string& name, const std::string& bytes) {
  std::filesystem::create_directories(folder + "/" + target);
  AtomicWriteFile(folder + "/" + target + "/" + name, bytes);
}

// A few kilobytes, so that mutations hit offsets and counts rather than descriptors.
SavedMap SmallMap(int points, int maps, bool extras) {
  const SyntheticWorld world =
      MakeSyntheticWorld({.points = points, .cameras = 3, .depth = extras});
  MapStore store;
  SavedMap saved;
  for (int i = 0; i < maps; ++i) FillMap(world, {.keyframes = 3}, store);
  saved.map = store.Commit([&](MapCommit& commit) {
    if (!extras) return;
    commit.AddLoop(KeyFrameId{0}, KeyFrameId{2});
    commit.Edit(KeyFrameId{2})->scale = 1.01;
  });
  saved.camera = world.camera;
  saved.sensor = extras ? "rgbd" : "mono";
  saved.settings = {{"seed", "1"}};
  if (extras) {
    std::vector<Descriptor> sample;
    for (KeyFrameId id : saved.map.KeyFrames()) {
      const auto& descriptors = saved.map.Find(id)->frame->descriptors;
      sample.insert(sample.end(), descriptors.begin(), descriptors.end());
    }
    saved.places.nodes =
        Vocabulary::Grow(sample, {.branching = 3, .levels = 2, .min_split = 3}, 1).nodes();
    saved.places.grown_at = 3;
  }
  return saved;
}

void WriteMaps() {
  for (const char* target : {"map", "map_again"}) {
    const std::string plain = EncodeMap(SmallMap(12, 1, false));
    Write(target, "good-plain", plain);
    Write(target, "good-two-maps", EncodeMap(SmallMap(12, 2, true)));
    Write(target, "good-empty", EncodeMap(SmallMap(0, 0, false)));
    std::string first = plain;
    SetMapVersion(first, 1);
    RepairChecksum(first);
    Write(target, "good-version-1", first);
  }
}

void WriteNetworks() {
  TinyNetwork network({1, 2, 3}, 0);
  network.names = "{0: 'person', 1: \"dog's bed\"}";
  network.scales_input = true;
  Write("onnx", "good-tiny", network.Bytes());
  network.input = {-1, 3, 0, -1};
  network.scales_input = false;
  Write("onnx", "good-open-sides", network.Bytes());
  OnnxFile file;
  file.Input("x", {1, 3, 32, 32})
      .Input("w", {1})
      .Constant("w", {1}, {9})
      .ExternalConstant("e", {2});
  Write("onnx", "good-old-exporter", file.Node("Sub", {"x", "w"}, "y").Bytes());
}

// Kinds of PNG that EncodePng() does not write: palettes, transparency, interlacing, few bits,
// text.
std::string OddPng(const cv::Mat& gray, int bits, int color_type, bool transparent,
                   bool interlaced) {
  std::string bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &bytes,
      [](png_structp to, png_bytep data, size_t size) {
        static_cast<std::string*>(png_get_io_ptr(to))
            ->append(reinterpret_cast<const char*>(data), size);
      },
      nullptr);
  png_set_IHDR(png, info, static_cast<png_uint_32>(gray.cols), static_cast<png_uint_32>(gray.rows),
               bits, color_type, interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  const int levels = 1 << std::min(bits, 8);
  if (color_type == PNG_COLOR_TYPE_PALETTE) {
    std::vector<png_color> palette;
    for (int i = 0; i < levels; ++i) {
      const auto v = static_cast<png_byte>(255 * i / (levels - 1));
      palette.push_back({v, static_cast<png_byte>(255 - v), v});
    }
    png_set_PLTE(png, info, palette.data(), levels);
  }
  png_byte clear[2] = {0, 128};
  png_color_16 clear_color{};
  if (transparent) png_set_tRNS(png, info, clear, 2, &clear_color);
  png_text text{};
  text.compression = PNG_TEXT_COMPRESSION_zTXt;
  char key[] = "Comment", words[] = "nobody reads this, nobody reads this, nobody reads this";
  text.key = key;
  text.text = words;
  png_set_text(png, info, &text, 1);
  png_write_info(png, info);
  const size_t samples = color_type == PNG_COLOR_TYPE_RGB_ALPHA    ? 4
                         : color_type == PNG_COLOR_TYPE_GRAY_ALPHA ? 2
                                                                   : 1;
  std::vector<std::vector<png_byte>> rows;
  std::vector<png_bytep> pointers;
  const size_t per_row = static_cast<size_t>(gray.cols) * samples * 2;  // enough for any depth
  for (int y = 0; y < gray.rows; ++y) {
    std::vector<png_byte> row(per_row);
    for (size_t i = 0; i < per_row; ++i)
      row[i] = gray.at<uchar>(y, static_cast<int>(i) % gray.cols);
    rows.push_back(std::move(row));
  }
  for (auto& row : rows) pointers.push_back(row.data());
  png_write_image(png, pointers.data());
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

std::string Jpeg(const cv::Mat& image, const std::vector<int>& options) {
  std::vector<uchar> bytes;
  cv::imencode(".jpg", image, bytes, options);
  return {bytes.begin(), bytes.end()};
}

void WritePictures() {
  const RenderedFrame frame = SynthRecording({.scene = "room", .frames = 1}).Render(0);
  cv::Mat gray, color, depth;
  cv::resize(frame.image, gray, {20, 15}, 0, 0, cv::INTER_AREA);
  cv::applyColorMap(gray, color, cv::COLORMAP_JET);
  cv::resize(frame.depth, depth, {20, 15}, 0, 0, cv::INTER_NEAREST);
  Write("png", "good-gray", EncodePng(gray));
  Write("png", "good-color", EncodePng(color));
  Write("png", "good-depth", EncodePng(depth));
  Write("png", "good-palette", OddPng(gray & 15, 8, PNG_COLOR_TYPE_PALETTE, false, false));
  Write("png", "good-palette-transparent",
        OddPng(gray & 15, 8, PNG_COLOR_TYPE_PALETTE, true, false));
  Write("png", "good-palette-2-bits", OddPng(gray, 2, PNG_COLOR_TYPE_PALETTE, true, true));
  Write("png", "good-gray-1-bit", OddPng(gray, 1, PNG_COLOR_TYPE_GRAY, true, true));
  Write("png", "good-gray-alpha-16", OddPng(gray, 16, PNG_COLOR_TYPE_GRAY_ALPHA, false, true));
  Write("png", "good-alpha", OddPng(gray, 8, PNG_COLOR_TYPE_RGB_ALPHA, false, false));
  Write("jpeg", "good-gray", EncodeJpeg(gray, 60));
  Write("jpeg", "good-color", EncodeJpeg(color, 60));
  Write("jpeg", "good-progressive",
        Jpeg(color, {cv::IMWRITE_JPEG_PROGRESSIVE, 1, cv::IMWRITE_JPEG_QUALITY, 60}));
  Write("jpeg", "good-restarts",
        Jpeg(color, {cv::IMWRITE_JPEG_RST_INTERVAL, 1, cv::IMWRITE_JPEG_QUALITY, 60}));
}

}  // namespace
}  // namespace alidade

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: fuzz_make_corpus FOLDER\n";
    return 2;
  }
  alidade::folder = argv[1];
  alidade::WriteMaps();
  alidade::WriteNetworks();
  alidade::WritePictures();
  alidade::WriteBags(alidade::Write);
}
