// Parts of a saved map, checked one by one. For map_decode.cc, and for map_encode.cc to write only
// what can be read.
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

// What is read has passed the verifier of FlatBuffers: every offset points inside. Whether it makes
// sense is looked at here. Throws Error (input).
void Require(bool holds, const char* what);

// Lists in a FlatBuffer may overlap, so that a small file could ask for all memory: together they
// may not be larger than the file.
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

// Nothing is farther away; so that products and squares stay numbers too.
inline constexpr double kFarthest = 1e12;  // metres

template <typename Vector>
size_t SizeOf(const Vector* vector) {
  return vector ? vector->size() : 0;
}

Eigen::Vector3d PointOf(const fb::Vec3& from);  // whatever it says
Se3 DecodePose(const fb::Pose* from);
double DecodeScale(double from);
// What is wrong with its numbers; null when nothing is.
const char* ComplaintOf(const Landmark& landmark);
Descriptor DecodeDescriptor(const fb::Descriptor& from);
Camera DecodeCamera(const fb::Camera& from);
std::shared_ptr<const Frame> DecodeFrame(const fb::KeyFrame& from, const Camera& camera,
                                         ByteBudget& budget);
SavedPlaces DecodePlaces(const fb::Places* from, ByteBudget& budget);

}  // namespace alidade
