#include "alidade/features/smooth.h"

#include <algorithm>
#include <cstdint>
#include <opencv2/core/hal/intrin.hpp>
#include <utility>
#include <vector>

#include "alidade/features/simd/smooth_row.h"

namespace alidade {
namespace {

constexpr int kColumns = 16;

// Calls block(x) for overlapping blocks of 16 columns that cover [0, width) without exceeding it,
// or one(x) per column if the row is shorter than a block.
template <typename Block, typename One>
void ForEachBlock(int width, const Block& block, const One& one) {
  if (width < kColumns) {
    for (int x = 0; x < width; ++x) one(x);
    return;
  }
  for (int x = 0; x < width - kColumns; x += kColumns) block(x);
  block(width - kColumns);
}

struct Wide {  // sixteen 16-bit numbers
  cv::v_uint16x8 low, high;
};

Wide Load(const uint8_t* p) {
  Wide w;
  cv::v_expand(cv::v_load(p), w.low, w.high);
  return w;
}
Wide Load(const uint16_t* p) { return {cv::v_load(p), cv::v_load(p + 8)}; }
void Store(uint16_t* p, const Wide& w) {
  cv::v_store(p, w.low);
  cv::v_store(p + 8, w.high);
}
Wide operator+(const Wide& a, const Wide& b) { return {a.low + b.low, a.high + b.high}; }
template <int n>
Wide Times2To(const Wide& a) {
  return {cv::v_shl<n>(a.low), cv::v_shl<n>(a.high)};
}

// Column sums of one output row, with `rim` replicated columns on both sides.
class SumRow {
 public:
  SumRow(int width, int rim) : width_(width), rim_(rim), sums_(width + 2 * rim) {}
  uint16_t* begin() { return sums_.data() + rim_; }
  void RepeatRim() {
    std::fill_n(sums_.begin(), rim_, sums_[rim_]);
    std::fill_n(sums_.end() - rim_, rim_, sums_[rim_ + width_ - 1]);
  }

 private:
  int width_, rim_;
  std::vector<uint16_t> sums_;
};

const uint8_t* RowOf(const cv::Mat& image, int y) {
  return image.ptr<uint8_t>(std::clamp(y, 0, image.rows - 1));
}

#ifdef ALIDADE_AVX2
bool UsesAvx2(int width) {
  constexpr int kLeast = 32;
  return width >= kLeast && HasAvx2();
}

void SmoothBinomialAvx2(const cv::Mat& level, int first_row, cv::Mat& out) {
  SumRow sums(level.cols, kSumRim);
  for (int i = 0; i < out.rows; ++i) {
    const int y = first_row + i;
    BinomialRowAvx2(RowOf(level, y - 1), RowOf(level, y), RowOf(level, y + 1), level.cols,
                    sums.begin(), out.ptr<uint8_t>(i));
  }
}

// The column sums of a row are those of the row before, with one row more and one less.
void SmoothBoxAvx2(const cv::Mat& image, int first_row, cv::Mat& out) {
  SumRow sums(image.cols, kSumRim), before(image.cols, kSumRim);
  const std::vector<uint8_t> nothing(image.cols);
  const auto move = [&](const uint8_t* comes, const uint8_t* goes) {
    std::swap(sums, before);
    BoxColumnsAvx2(before.begin(), comes, goes, image.cols, sums.begin());
  };
  for (int k = -3; k <= 1; ++k) move(RowOf(image, first_row + k), nothing.data());
  for (int i = 0; i < out.rows; ++i) {
    const int y = first_row + i;
    move(RowOf(image, y + 2), RowOf(image, y - 3));
    BoxRowAvx2(sums.begin(), image.cols, out.ptr<uint8_t>(i));
  }
}
#endif

}  // namespace

void SmoothBinomial(const cv::Mat& level, int first_row, cv::Mat out) {
#ifdef ALIDADE_AVX2
  if (UsesAvx2(level.cols)) return SmoothBinomialAvx2(level, first_row, out);
#endif
  SumRow sums(level.cols, 1);
  uint16_t* sum = sums.begin();
  for (int i = 0; i < out.rows; ++i) {
    const uint8_t* a = RowOf(level, first_row + i - 1);
    const uint8_t* b = RowOf(level, first_row + i);
    const uint8_t* c = RowOf(level, first_row + i + 1);
    ForEachBlock(
        level.cols,
        [&](int x) { Store(sum + x, Load(a + x) + Times2To<1>(Load(b + x)) + Load(c + x)); },
        [&](int x) { sum[x] = static_cast<uint16_t>(a[x] + 2 * b[x] + c[x]); });
    sums.RepeatRim();
    uint8_t* row = out.ptr<uint8_t>(i);
    ForEachBlock(
        level.cols,
        [&](int x) {
          const Wide s = Load(sum + x - 1) + Times2To<1>(Load(sum + x)) + Load(sum + x + 1);
          cv::v_store(row + x, cv::v_rshr_pack<4>(s.low, s.high));
        },
        [&](int x) {
          row[x] = static_cast<uint8_t>((sum[x - 1] + 2 * sum[x] + sum[x + 1] + 8) >> 4);
        });
  }
}

void SmoothBox(const cv::Mat& image, int first_row, cv::Mat out) {
#ifdef ALIDADE_AVX2
  if (UsesAvx2(image.cols)) return SmoothBoxAvx2(image, first_row, out);
#endif
  SumRow sums(image.cols, 2);
  uint16_t* sum = sums.begin();
  for (int i = 0; i < out.rows; ++i) {
    const uint8_t* rows[5];
    for (int k = 0; k < 5; ++k) rows[k] = RowOf(image, first_row + i + k - 2);
    ForEachBlock(
        image.cols,
        [&](int x) {
          Store(sum + x, Load(rows[0] + x) + Load(rows[1] + x) + Load(rows[2] + x) +
                             Load(rows[3] + x) + Load(rows[4] + x));
        },
        [&](int x) {
          sum[x] =
              static_cast<uint16_t>(rows[0][x] + rows[1][x] + rows[2][x] + rows[3][x] + rows[4][x]);
        });
    sums.RepeatRim();
    uint8_t* row = out.ptr<uint8_t>(i);
    // The sum is at most 25 * 255 = 6375, so ten times it fits in 16 bits.
    ForEachBlock(
        image.cols,
        [&](int x) {
          const Wide s = Load(sum + x - 2) + Load(sum + x - 1) + Load(sum + x) + Load(sum + x + 1) +
                         Load(sum + x + 2);
          const Wide ten = Times2To<3>(s) + Times2To<1>(s);
          cv::v_store(row + x, cv::v_pack(cv::v_shr<8>(ten.low), cv::v_shr<8>(ten.high)));
        },
        [&](int x) {
          row[x] = static_cast<uint8_t>(
              (sum[x - 2] + sum[x - 1] + sum[x] + sum[x + 1] + sum[x + 2]) * 10 >> 8);
        });
  }
}

}  // namespace alidade
