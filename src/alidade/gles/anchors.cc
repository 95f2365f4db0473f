#include "alidade/gles/anchors.h"

#include <algorithm>
#include <cmath>

namespace alidade::gles {
namespace {

constexpr size_t kTexels = 4;  // texels per slot
constexpr size_t kRow = 512;   // slots per row: 2048 texels, supported by every context

Anchor AnchorOf(const Se3& T_world_camera, double scale, float strength) {
  Anchor anchor;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c)
      anchor.rows[r][c] = static_cast<float>(scale * T_world_camera.R(r, c));
    anchor.rows[r][3] = static_cast<float>(T_world_camera.t(r));
  }
  anchor.strength = strength;
  anchor.per_scale = static_cast<float>(1 / scale);
  return anchor;
}

}  // namespace

const char* const kAnchorsGlsl = R"(
uniform sampler2D anchors;
uniform float other_maps;
vec4 AnchorTexel(uint slot, uint k) {
  uint at = slot * 4u + k;
  return texelFetch(anchors, ivec2(int(at % 2048u), int(at / 2048u)), 0);
}
vec4 Range(uint slot) { return AnchorTexel(slot, 3u); }
vec3 Place(uint slot, vec3 p, out float strength) {
  vec4 q = vec4(p, 1.0);
  strength = Range(slot).z;
  if (strength > 1.5) strength = other_maps;
  return vec3(dot(AnchorTexel(slot, 0u), q), dot(AnchorTexel(slot, 1u), q), dot(AnchorTexel(slot, 2u), q));
}
)";

Anchors::Anchors() {
  Put(kNowhere, {});
  Put(kCameraSlot, {});
}

uint32_t Anchors::SlotOf(KeyFrameId id) const {
  const auto found = slots_.find(id.value);
  return found == slots_.end() ? kNowhere : found->second;
}

void Anchors::Put(uint32_t slot, const Anchor& anchor) {
  if (slot >= anchors_.size()) {
    anchors_.resize(slot + 1);
  } else if (std::memcmp(&anchors_[slot], &anchor, sizeof anchor) == 0) {
    return;
  }
  anchors_[slot] = anchor;
  changed_.Add(slot);
}

void Anchors::Update(const StreamScene& scene, MapId active) {
  for (auto slot = slots_.begin(); slot != slots_.end();) {
    if (scene.keyframes.count({slot->first}) != 0) {
      ++slot;
      continue;
    }
    Put(slot->second, {});
    unused_.push_back(slot->second);
    slot = slots_.erase(slot);
  }
  // The iteration order of an unordered map affects only which free slot is reused.
  for (const auto& [id, keyframe] : scene.keyframes) {
    auto [place, is_new] = slots_.try_emplace(id.value, static_cast<uint32_t>(anchors_.size()));
    if (is_new && !unused_.empty()) {
      place->second = unused_.back();
      unused_.pop_back();
    }
    Anchor anchor =
        AnchorOf(keyframe.T_world_camera, keyframe.scale, keyframe.map == active ? 1.f : 2.f);
    if (!keyframe.depth.empty()) {
      anchor.depth_least = std::log(keyframe.depth_least);
      anchor.depth_span = std::log(keyframe.depth_most / keyframe.depth_least);
    }
    Put(place->second, anchor);
  }
}

void Anchors::SetCamera(const Se3& T_world_camera, bool shown) {
  Put(kCameraSlot, AnchorOf(T_world_camera, 1, shown ? 1.f : 0.f));
}

size_t Anchors::Bind() {
  size_t bytes = 0;
  if (texture_ == 0) {
    glGenTextures(1, &texture_);
    rows_ = 0;
  }
  glBindTexture(GL_TEXTURE_2D, texture_);
  const size_t needed = (anchors_.size() + kRow - 1) / kRow;
  if (needed > rows_) {
    rows_ = needed + needed / 2;
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, kRow * kTexels, static_cast<GLsizei>(rows_), 0,
                 GL_RGBA, GL_FLOAT, nullptr);
    changed_.AddAll(anchors_.size());
  }
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  changed_.Take(anchors_.size(), [&](size_t first, size_t count) {
    bytes += count * sizeof(Anchor);
    while (count > 0) {  // one partial row, or all consecutive full rows
      const size_t column = first % kRow;
      const bool whole = column == 0 && count >= kRow;
      const size_t width = whole ? kRow : std::min(count, kRow - column);
      const size_t height = whole ? count / kRow : 1;
      glTexSubImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(column * kTexels),
                      static_cast<GLint>(first / kRow), static_cast<GLsizei>(width * kTexels),
                      static_cast<GLsizei>(height), GL_RGBA, GL_FLOAT, &anchors_[first]);
      first += width * height;
      count -= width * height;
    }
  });
  return bytes;
}

void Anchors::Release() {
  glDeleteTextures(1, &texture_);
  Forget();
}

}  // namespace alidade::gles
