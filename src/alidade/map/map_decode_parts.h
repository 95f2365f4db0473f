// Decoding and validation of the parts of a saved map. Used by map_decode.cc, and by map_encode.cc
// to write only what can be read.
#pragma once

#include <memory>
#include <string>

#include "alidade/features/frame.h"
#include "alidade/geometry/se3.h"
#include "alidade/map/landmark.h"
#include "alidade/place/place_index.h"

namespace alidade {

namespace fb {
struct Camera;
struct Descriptor;
struct KeyFrame;
struct Places;
struct Pose;
struct Vec3;
}  // namespace fb

// Throws Error (input) unless `holds`. The FlatBuffers verifier has already checked that all
// offsets are inside the buffer; this checks the contents.
void Require(bool holds, const char* what);

// Limits the total size of lists to the file size. FlatBuffer lists may overlap, so a small file
// could otherwise request unlimited memory.
class ByteBudget {
 public:
  explicit ByteBudget(size_t file_size) : left_(file_size) {}
  void Take(size_t count, size_t size) {
    Require(count <= left_ / size, "its lists are larger than the file");
    left_ -= count * size;
  }

 private:
  size_t left_;
};

// Largest coordinate, meters; products and squares stay finite.
inline constexpr double kFarthest = 1e12;

template <typename Vector>
size_t SizeOf(const Vector* vector) {
  return vector ? vector->size() : 0;
}

Eigen::Vector3d PointOf(const fb::Vec3& from);  // not validated
Se3 DecodePose(const fb::Pose* from);
double DecodeScale(double from);
// Returns what is wrong with its values; null if nothing is.
const char* ComplaintOf(const Landmark& landmark);
Descriptor DecodeDescriptor(const fb::Descriptor& from);
Camera DecodeCamera(const fb::Camera& from);
std::shared_ptr<const Frame> DecodeFrame(const fb::KeyFrame& from, const Camera& camera,
                                         ByteBudget& budget);
SavedPlaces DecodePlaces(const fb::Places* from, ByteBudget& budget);

}  // namespace alidade
