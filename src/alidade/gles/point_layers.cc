#include "alidade/gles/point_layers.h"

#include <cstddef>
#include <cstring>
#include <string>

#include "alidade/gles/eye.h"

namespace alidade::gles {
namespace {

constexpr const char* kLandmarkGlsl = R"(
layout(location = 0) in vec3 place;
layout(location = 1) in uint slot;
uniform float size;
uniform vec3 ink;
uniform vec3 ground;
out vec3 color;
void main() {
  float strength;
  vec3 p = Eye(Place(slot, place, strength));
  gl_Position = strength > 0.0 && p.z > nearest ? Clip(p) : kHidden;
  gl_PointSize = size;
  color = mix(ground, ink, strength);
}
)";

// K maps image positions, in 65536ths, to normalized coordinates: p = (place * K.xy + K.zw, 1) /
// inverse depth.
constexpr const char* kCloudGlsl = R"(
layout(location = 0) in uvec4 told;
layout(location = 1) in uint slot;
uniform float size;
uniform vec4 K;
uniform vec3 ground;
out vec3 color;
void main() {
  vec4 range = Range(slot);
  float z = exp(-range.x - range.y * float(told.z) / 65535.0);
  float strength;
  vec3 p = Eye(Place(slot, z * vec3(vec2(told.xy) * K.xy + K.zw, 1.0), strength));
  gl_Position = strength > 0.0 && p.z > nearest ? Clip(p) : kHidden;
  gl_PointSize = size;
  vec3 rgb = vec3(uvec3(told.w >> 11, told.w >> 5 & 63u, told.w & 31u)) / vec3(31.0, 63.0, 31.0);
  color = mix(ground, rgb, strength);
}
)";

constexpr const char* kPointGlsl = R"(
in vec3 color;
out vec4 result;
void main() { result = vec4(color, 1.0); }
)";

}  // namespace

LandmarkLayer::LandmarkLayer()
    : program_(std::string(kAnchorsGlsl) + kEyeGlsl + kLandmarkGlsl, kPointGlsl) {}

void LandmarkLayer::Update(const StreamScene& scene, const Anchors& anchors) {
  // Both lists are sorted by id, so one pass finds added, changed and removed landmarks.
  std::vector<std::pair<LandmarkId, uint32_t>> ids;
  ids.reserve(scene.landmarks.size());
  auto known = ids_.begin();
  const auto drop_before = [&](LandmarkId id) {
    for (; known != ids_.end() && known->first < id; ++known) {
      vertices_.Set(known->second, {0, 0, 0, kNowhere});
      unused_.push_back(known->second);
    }
  };
  for (const auto& [id, landmark] : scene.landmarks) {
    drop_before(id);
    uint32_t at = 0;
    if (known != ids_.end() && known->first == id) {
      at = known++->second;
    } else if (unused_.empty()) {
      at = static_cast<uint32_t>(vertices_.size());
    } else {
      at = unused_.back();
      unused_.pop_back();
    }
    ids.emplace_back(id, at);
    vertices_.Set(
        at, {landmark.p.x(), landmark.p.y(), landmark.p.z(), anchors.SlotOf(landmark.keyframe)});
  }
  drop_before({});  // the invalid id is the largest
  ids_ = std::move(ids);
}

size_t LandmarkLayer::Draw(const ViewSettings& view, int width, int height) {
  if (ids_.empty()) return 0;
  const size_t uploaded = vertices_.Upload();
  if (layout_ == 0) {
    glGenVertexArrays(1, &layout_);
    glBindVertexArray(layout_);
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(Vertex), nullptr);
    glEnableVertexAttribArray(1);
    glVertexAttribIPointer(1, 1, GL_UNSIGNED_INT, sizeof(Vertex),
                           reinterpret_cast<const void*>(offsetof(Vertex, slot)));
  }
  glBindVertexArray(layout_);
  program_.Use();
  SetEye(program_, view, width, height);
  SetColor(program_, "ink", view.colors.landmarks);
  SetColor(program_, "ground", view.colors.background);
  glUniform1f(program_.At("size"), static_cast<GLfloat>(view.landmark_size));
  glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(vertices_.size()));
  return uploaded;
}

void LandmarkLayer::Forget() {
  program_.Forget();
  vertices_.Forget();
  layout_ = 0;
}

void LandmarkLayer::Release() {
  program_.Release();
  vertices_.Release();
  glDeleteVertexArrays(1, &layout_);
  layout_ = 0;
}

CloudLayer::CloudLayer()
    : program_(std::string(kAnchorsGlsl) + kEyeGlsl + kCloudGlsl, kPointGlsl) {}

void CloudLayer::Hide(Cloud& cloud) {
  for (size_t block : cloud.blocks) {
    for (size_t i = 0; i < kBlock; ++i) vertices_.Set(block * kBlock + i, {0, 0, 0, 0, kNowhere});
    unused_.push_back(block);
  }
  count_ -= cloud.points;
  cloud = {};
}

void CloudLayer::Show(const SceneKeyFrame& keyframe, uint32_t slot, Cloud& cloud) {
  constexpr size_t kTold = 8;  // bytes per point
  cloud.told = keyframe.depth_told;
  cloud.points = keyframe.depth.size() / kTold;
  count_ += cloud.points;
  for (size_t begin = 0; begin < cloud.points; begin += kBlock) {
    size_t block = vertices_.size() / kBlock;
    if (!unused_.empty()) {
      block = unused_.back();
      unused_.pop_back();
    }
    cloud.blocks.push_back(block);
    for (size_t i = 0; i < kBlock; ++i) {
      Vertex vertex{0, 0, 0, 0, kNowhere};
      if (begin + i < cloud.points) {
        std::memcpy(&vertex, &keyframe.depth[kTold * (begin + i)], kTold);
        vertex.slot = slot;
      }
      vertices_.Set(block * kBlock + i, vertex);
    }
  }
}

void CloudLayer::Update(const StreamScene& scene, const Anchors& anchors) {
  camera_ = scene.camera;
  for (auto cloud = clouds_.begin(); cloud != clouds_.end();) {
    const auto keyframe = scene.keyframes.find({cloud->first});
    if (keyframe != scene.keyframes.end() && keyframe->second.depth_told == cloud->second.told) {
      ++cloud;
    } else {
      Hide(cloud->second);
      cloud = clouds_.erase(cloud);
    }
  }
  for (const auto& [id, keyframe] : scene.keyframes) {
    if (keyframe.depth.empty()) continue;
    const auto [cloud, is_new] = clouds_.try_emplace(id.value);
    if (is_new) Show(keyframe, anchors.SlotOf(id), cloud->second);
  }
}

size_t CloudLayer::Draw(const ViewSettings& view, int width, int height) {
  if (count_ == 0) return 0;
  const size_t uploaded = vertices_.Upload();
  if (layout_ == 0) {
    glGenVertexArrays(1, &layout_);
    glBindVertexArray(layout_);
    glEnableVertexAttribArray(0);
    glVertexAttribIPointer(0, 4, GL_UNSIGNED_SHORT, sizeof(Vertex), nullptr);
    glEnableVertexAttribArray(1);
    glVertexAttribIPointer(1, 1, GL_UNSIGNED_INT, sizeof(Vertex),
                           reinterpret_cast<const void*>(offsetof(Vertex, slot)));
  }
  glBindVertexArray(layout_);
  program_.Use();
  SetEye(program_, view, width, height);
  SetColor(program_, "ground", view.colors.background);
  const Camera& c = camera_;
  glUniform4f(program_.At("K"), static_cast<GLfloat>(c.width / 65536.0 / c.fx),
              static_cast<GLfloat>(c.height / 65536.0 / c.fy),
              static_cast<GLfloat>((-0.5 - c.cx) / c.fx),
              static_cast<GLfloat>((-0.5 - c.cy) / c.fy));
  glUniform1f(program_.At("size"), static_cast<GLfloat>(view.point_size));
  glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(vertices_.size()));
  return uploaded;
}

void CloudLayer::Forget() {
  program_.Forget();
  vertices_.Forget();
  layout_ = 0;
}

void CloudLayer::Release() {
  program_.Release();
  vertices_.Release();
  glDeleteVertexArrays(1, &layout_);
  layout_ = 0;
}

}  // namespace alidade::gles
