#include "alidade/features/patch.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>
#ifdef __wasm_simd128__
#include <wasm_simd128.h>
#endif

namespace alidade {
namespace {

// Four floats in one register; compilers for SSE2, NEON and WebAssembly give the same bits.
typedef float Float4 __attribute__((vector_size(16)));
#ifndef __wasm_simd128__
typedef uint8_t Bytes4 __attribute__((vector_size(4)));
#endif

Float4 Load(const float* at) {
  Float4 v;
  std::memcpy(&v, at, sizeof v);
  return v;
}

Float4 LoadBytes(const uint8_t* at) {
#ifdef __wasm_simd128__  // where clang converts one number after another
  const v128_t words = wasm_u16x8_extend_low_u8x16(wasm_v128_load32_zero(at));
  return reinterpret_cast<Float4>(wasm_f32x4_convert_i32x4(wasm_u32x4_extend_low_u16x8(words)));
#else
  Bytes4 bytes;
  std::memcpy(&bytes, at, sizeof bytes);
  return __builtin_convertvector(bytes, Float4);
#endif
}

float Sum(Float4 v) { return (v[0] + v[1]) + (v[2] + v[3]); }

constexpr int kPatchSide = Patch::kSide;
constexpr int kRim = kPatchSide + 2;  // of the samples from which gradients are taken
// Of Patch::information: with noise of 4 gray levels a shift is told to half a pixel.
constexpr float kMinDeterminant = 4 / 0.5f * (4 / 0.5f) * (4 / 0.5f) * (4 / 0.5f);

float Bilinear(const cv::Mat& image, float x, float y) {
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  const float fx = x - static_cast<float>(column), fy = y - static_cast<float>(row);
  const uint8_t* a = image.ptr<uint8_t>(row) + column;
  const uint8_t* b = a + image.step[0];
  const float above = static_cast<float>(a[0]) + fx * static_cast<float>(a[1] - a[0]);
  const float below = static_cast<float>(b[0]) + fx * static_cast<float>(b[1] - b[0]);
  return above + fy * (below - above);
}

// The pixels around a place, interpolated.
void SamplePatch(const cv::Mat& image, float x, float y,
                 std::array<Float4, Patch::kPixels / 4>& out) {
  const float left = x - 0.5f * (kPatchSide - 1), top = y - 0.5f * (kPatchSide - 1);
  const int column = static_cast<int>(left), row = static_cast<int>(top);
  const float fx = left - static_cast<float>(column), fy = top - static_cast<float>(row);
  Float4 above[2];
  for (int r = 0; r <= kPatchSide; ++r) {
    const uint8_t* pixels = image.ptr<uint8_t>(row + r) + column;
    for (int half = 0; half < 2; ++half) {
      const Float4 here = LoadBytes(pixels + 4 * half), next = LoadBytes(pixels + 4 * half + 1);
      const Float4 between = here + fx * (next - here);
      if (r > 0) out[2 * (r - 1) + half] = above[half] + fy * (between - above[half]);
      above[half] = between;
    }
  }
}

}  // namespace

std::vector<cv::Mat> HalvedImages(const cv::Mat& image, int count) {
  constexpr int kShortest = 16;
  std::vector<cv::Mat> images = {image};
  while (static_cast<int>(images.size()) < count) {
    const cv::Mat& last = images.back();
    const cv::Size half(last.cols / 2, last.rows / 2);
    if (std::min(half.width, half.height) < kShortest) break;
    cv::Mat next;
    cv::resize(last(cv::Rect(0, 0, 2 * half.width, 2 * half.height)), next, half, 0, 0,
               cv::INTER_AREA);
    images.push_back(next);
  }
  return images;
}

bool CutPatch(const cv::Mat& image, const Eigen::Vector2f& center, const Eigen::Matrix2f& warp,
              Patch& patch) {
  constexpr float kHalf = 0.5f * (kRim - 1);
  const Eigen::Array2f reach = kHalf * warp.cwiseAbs().rowwise().sum().array() + 1;
  if (!(center.x() >= reach.x()) || !(center.y() >= reach.y()) ||
      !(center.x() < static_cast<float>(image.cols - 1) - reach.x()) ||
      !(center.y() < static_cast<float>(image.rows - 1) - reach.y()))
    return false;
  float samples[kRim][kRim];
  for (int r = 0; r < kRim; ++r) {
    for (int c = 0; c < kRim; ++c) {
      const float u = static_cast<float>(c) - kHalf, v = static_cast<float>(r) - kHalf;
      samples[r][c] = Bilinear(image, center.x() + warp(0, 0) * u + warp(0, 1) * v,
                               center.y() + warp(1, 0) * u + warp(1, 1) * v);
    }
  }
  float mean = 0;
  for (int r = 0; r < kPatchSide; ++r) {
    for (int c = 0; c < kPatchSide; ++c) mean += samples[r + 1][c + 1];
  }
  mean /= Patch::kPixels;
  for (int r = 0, i = 0; r < kPatchSide; ++r) {
    for (int c = 0; c < kPatchSide; ++c, ++i) {
      patch.value[i] = samples[r + 1][c + 1] - mean;
      patch.dx[i] = 0.5f * (samples[r + 1][c + 2] - samples[r + 1][c]);
      patch.dy[i] = 0.5f * (samples[r + 2][c + 1] - samples[r][c + 1]);
    }
  }
  Float4 xx{}, xy{}, xv{}, x1{}, yy{}, yv{}, y1{}, vv{}, v1{};
  for (int i = 0; i < Patch::kPixels; i += 4) {
    const Float4 dx = Load(&patch.dx[i]), dy = Load(&patch.dy[i]), value = Load(&patch.value[i]);
    xx += dx * dx;
    xy += dx * dy;
    xv += dx * value;
    x1 += dx;
    yy += dy * dy;
    yv += dy * value;
    y1 += dy;
    vv += value * value;
    v1 += value;
  }
  // Gain and offset are eliminated from the shift by the Schur complement.
  Eigen::Matrix2f A, B, C;
  A << Sum(xx), Sum(xy), Sum(xy), Sum(yy);
  B << Sum(xv), Sum(x1), Sum(yv), Sum(y1);
  C << Sum(vv), Sum(v1), Sum(v1), Patch::kPixels;
  if (!(C.determinant() > 0)) return false;
  const Eigen::Matrix2f C_inverse = C.inverse();
  const Eigen::Matrix2f BC = B * C_inverse;
  patch.information = A - BC * B.transpose();
  if (!(patch.information.determinant() > kMinDeterminant)) return false;
  const Eigen::Matrix2f covariance = patch.information.inverse();
  patch.inverse.topLeftCorner<2, 2>() = covariance;
  patch.inverse.topRightCorner<2, 2>() = -covariance * BC;
  patch.inverse.bottomLeftCorner<2, 2>() = patch.inverse.topRightCorner<2, 2>().transpose();
  patch.inverse.bottomRightCorner<2, 2>() = C_inverse + BC.transpose() * covariance * BC;
  return true;
}

bool HoldsPatch(const cv::Mat& image, const Eigen::Vector2f& place) {
  constexpr float kRimWidth = Patch::kReach;
  return place.x() >= kRimWidth && place.y() >= kRimWidth &&
         place.x() < static_cast<float>(image.cols - 1) - kRimWidth &&
         place.y() < static_cast<float>(image.rows - 1) - kRimWidth;
}

PatchStep StepOf(const Patch& patch, const cv::Mat& image, const Eigen::Vector2f& place) {
  PatchStep step;
  if (!HoldsPatch(image, place)) return step;
  step.inside = true;
  std::array<Float4, Patch::kPixels / 4> pixels;
  SamplePatch(image, place.x(), place.y(), pixels);
  Float4 x{}, y{}, v{}, one{}, square{};
  for (int i = 0; i < Patch::kPixels / 4; ++i) {
    x += Load(&patch.dx[4 * i]) * pixels[i];
    y += Load(&patch.dy[4 * i]) * pixels[i];
    v += Load(&patch.value[4 * i]) * pixels[i];
    one += pixels[i];
    square += pixels[i] * pixels[i];
  }
  // Least squares of pixels = gain (value + (dx, dy) s) + offset. The patch is at place - s.
  const Eigen::Vector4f b(Sum(x), Sum(y), Sum(v), Sum(one));
  const Eigen::Vector4f z = patch.inverse * b;
  step.gain = z[2];
  if (!(step.gain > 0)) return step;
  step.shift = -z.head<2>() / step.gain;
  constexpr float kCount = Patch::kPixels;
  const float variance = Sum(square) - b[3] * b[3] / kCount;
  const float explained = z.dot(b) - b[3] * b[3] / kCount;
  step.residual2 = std::max(0.0f, variance - explained) / kCount;
  if (variance > 0) step.correlation = std::sqrt(std::clamp(explained / variance, 0.0f, 1.0f));
  return step;
}

bool AlignPatch(const Patch& patch, const cv::Mat& image, float reach, float min_correlation,
                Eigen::Vector2f& place) {
  const Eigen::Vector2f start = place;
  for (int i = 0; i < kPatchSteps; ++i) {
    const PatchStep step = StepOf(patch, image, place);
    if (!step.inside || !(step.gain > 0)) return false;
    place += step.shift;
    if (!((place - start).squaredNorm() <= reach * reach)) return false;
    if (step.shift.squaredNorm() < kAligned * kAligned) return step.correlation >= min_correlation;
  }
  return false;
}

}  // namespace alidade
