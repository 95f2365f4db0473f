// The kernels of bundle adjustment on random blocks, compared with Eigen.
#include "alidade/optimize/bundle_kernels.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "alidade/base/random.h"
#include "alidade/geometry/se3.h"
#include "alidade/optimize/schur_row.h"
#include "alidade/optimize/sighting_terms.h"

namespace alidade::bundle_kernels_test {
namespace {

using Matrix63 = Eigen::Matrix<double, 6, 3>;

// Rounding of a dozen operations on numbers near 1. Factors of H additionally lose precision by its
// condition number, which is below 1000 here.
constexpr double kRounding = 1e-14, kFactored = 1e-11;
constexpr int kTimes = 200;

Eigen::Matrix3d Full(const Symmetric3& s) {
  return (Eigen::Matrix3d() << s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5]).finished();
}

Eigen::Matrix3d Lower(const PointFactor& L) {
  return (Eigen::Matrix3d() << 1 / L.l00, 0, 0, L.l10, 1 / L.l11, 0, L.l20, L.l21, 1 / L.l22)
      .finished();
}

Eigen::Vector3d Of(const std::array<double, 3>& v) { return Eigen::Vector3d(v.data()); }

Matrix63 Full(const CouplingFactor& E) {
  return Eigen::Map<const Matrix63>(&E.column[0][0]);  // both column-major
}

// G N of one camera and one point: G = [I; [Y]x].
Matrix63 Mixed(const Coupling& c) {
  Matrix63 mixed;
  mixed << Full(c.N), Skew(Of(c.Y)) * Full(c.N);
  return mixed;
}

class BundleKernels : public testing::Test {
 protected:
  std::array<double, 3> Vector() {
    return {random_.Gaussian(), random_.Gaussian(), random_.Gaussian()};
  }
  Vector6d Step() {
    Vector6d d;
    for (double& value : d) value = random_.Gaussian();
    return d;
  }
  Symmetric3 Symmetric() {
    Symmetric3 s;
    for (double& value : s) value = random_.Gaussian();
    return s;
  }
  Symmetric3 Definite() {  // J'J of a random J plus a multiple of the identity
    Eigen::Matrix3d J;
    for (int i = 0; i < 9; ++i) J.data()[i] = random_.Gaussian();
    const Eigen::Matrix3d H = J.transpose() * J + 0.05 * Eigen::Matrix3d::Identity();
    return {H(0, 0), H(0, 1), H(0, 2), H(1, 1), H(1, 2), H(2, 2)};
  }
  PointFactor Factor() { return FactorOf(Definite(), {0, 0, 0}); }
  Coupling Coupled() { return {Symmetric(), Vector(), 0}; }
  CouplingFactor CoupledFactor() {
    CouplingFactor factor;
    for (auto& column : factor.column) {
      for (double& value : column) value = random_.Gaussian();
    }
    return factor;
  }

  Random random_{77};
};

TEST_F(BundleKernels, FactorOfAPointIsCholeskysOfItsDampedBlock) {
  for (int n = 0; n < kTimes; ++n) {
    const Symmetric3 H = Definite();
    const std::array<double, 3> damping = {random_.Uniform(), random_.Uniform(), random_.Uniform()};
    Eigen::Matrix3d damped = Full(H);
    damped.diagonal() += Of(damping);
    const Eigen::Matrix3d expected = damped.llt().matrixL();
    EXPECT_LT((Lower(FactorOf(H, damping)) - expected).norm(), kFactored * expected.norm());
  }
}

TEST_F(BundleKernels, AFactorOfWhatIsNotDefiniteIsNotFinite) {
  EXPECT_FALSE(std::isfinite(FactorOf({-1, 0, 0, 1, 0, 1}, {0, 0, 0}).l00));
  EXPECT_FALSE(std::isfinite(FactorOf({1, 2, 0, 1, 0, 1}, {0, 0, 0}).l11));
  EXPECT_FALSE(std::isfinite(FactorOf({1, 0, 2, 1, 0, 1}, {0, 0, 0}).l22));
}

TEST_F(BundleKernels, TriangularSolvesAreEigens) {
  for (int n = 0; n < kTimes; ++n) {
    const PointFactor L = Factor();
    const std::array<double, 3> b = Vector();
    const Eigen::Vector3d lower = Lower(L).triangularView<Eigen::Lower>().solve(Of(b));
    EXPECT_LT((Of(SolveLower(L, b)) - lower).norm(), kFactored * (1 + lower.norm()));
    const Eigen::Vector3d upper = Lower(L).transpose().triangularView<Eigen::Upper>().solve(Of(b));
    EXPECT_LT((SolveUpper(L, b) - upper).norm(), kFactored * (1 + upper.norm()));
  }
}

TEST_F(BundleKernels, FactorOfACouplingTimesThatOfThePointIsTheCoupling) {
  for (int n = 0; n < kTimes; ++n) {
    const PointFactor L = Factor();
    const Coupling c = Coupled();
    CouplingFactor E;
    MakeFactor(c, L, E);
    const Matrix63 expected = Mixed(c) * Lower(L).transpose().inverse();
    EXPECT_LT((Full(E) - expected).norm(), kFactored * (1 + expected.norm()));
    EXPECT_LT((Full(E) * Lower(L).transpose() - Mixed(c)).norm(),
              kFactored * (1 + Mixed(c).norm()));
  }
}

TEST_F(BundleKernels, RowsOfAFactorAreTwoOfAColumn) {
  const CouplingFactor E = CoupledFactor();
  for (int pair = 0; pair < 3; ++pair) {
    for (int j = 0; j < 3; ++j) {
      EXPECT_EQ(E.Rows(pair, j)[0], E.column[j][2 * pair]);
      EXPECT_EQ(E.Rows(pair, j)[1], E.column[j][2 * pair + 1]);
    }
  }
}

TEST_F(BundleKernels, ProductsAreAddedAndSubtractedAsEigenDoes) {
  for (int n = 0; n < kTimes; ++n) {
    const CouplingFactor A = CoupledFactor(), B = CoupledFactor();
    SquareBlock<6> S;
    Matrix6d expected;
    for (int j = 0; j < 6; ++j) {
      for (int i = 0; i < 6; ++i) S.Set(i, j, expected(i, j) = random_.Gaussian());
    }
    SubtractProduct(A, B, S);
    expected -= Full(A) * Full(B).transpose();
    for (int j = 0; j < 6; ++j) {
      for (int i = 0; i < 6; ++i) EXPECT_NEAR(S(i, j), expected(i, j), 10 * kRounding);
    }
    const std::array<double, 3> y = Vector();
    const Vector6d start = Step();
    Vector6d right = start;
    AddProduct(A, y, right);
    EXPECT_LT((right - start - Full(A) * Of(y)).norm(), 10 * kRounding);
  }
}

TEST_F(BundleKernels, AStepOfACameraMovesTheGradientOfItsPoints) {
  for (int n = 0; n < kTimes; ++n) {
    const Coupling c = Coupled();
    const Vector6d d = Step();
    const std::array<double, 3> start = Vector();
    std::array<double, 3> r = start;
    SubtractStep(c, d, r);
    const Eigen::Vector3d expected = Of(start) - Mixed(c).transpose() * d;
    EXPECT_LT((Of(r) - expected).norm(), kRounding * (10 + 10 * expected.norm()));
  }
}

// All kernels together: eliminating a point from the equations of two cameras gives the Schur
// complement.
TEST_F(BundleKernels, EliminateAPointAsTheSchurComplementDoes) {
  for (int n = 0; n < kTimes; ++n) {
    const Symmetric3 H = Definite();
    const std::array<double, 3> g = Vector();
    const Coupling a = Coupled(), b = Coupled();
    const PointFactor L = FactorOf(H, {0, 0, 0});
    CouplingFactor Ea, Eb;
    MakeFactor(a, L, Ea);
    MakeFactor(b, L, Eb);
    SquareBlock<6> S{};
    SubtractProduct(Ea, Eb, S);
    Vector6d r = Vector6d::Zero();
    AddProduct(Ea, SolveLower(L, g), r);
    const Eigen::Matrix3d inverse = Full(H).inverse();
    const Matrix6d expected = -Mixed(a) * inverse * Mixed(b).transpose();
    double off = 0;
    for (int j = 0; j < 6; ++j) {
      for (int i = 0; i < 6; ++i) off = std::max(off, std::abs(S(i, j) - expected(i, j)));
    }
    EXPECT_LT(off, kFactored * (1 + expected.norm()));
    const Vector6d right = Mixed(a) * inverse * Of(g);
    EXPECT_LT((r - right).norm(), kFactored * (1 + right.norm()));
  }
}

TEST_F(BundleKernels, DampingIsAShareOfTheDiagonalWithAFloorByTheLargest) {
  EXPECT_DOUBLE_EQ(DampingOfEntry(1e-3, 4, 10), 4e-3);
  EXPECT_DOUBLE_EQ(DampingOfEntry(1e-3, 0, 10),
                   // Unobserved: a millionth of the largest entry counts.
                   1e-8);
  EXPECT_DOUBLE_EQ(DampingOfEntry(1e-9, 0, 10), 1e-11);  // the lower limit that keeps it invertible
  const std::array<double, 3> damping = DampingOf(Symmetric3{2, 9, 9, 0, 9, 8}, 0.5);
  EXPECT_DOUBLE_EQ(damping[0], 1);
  EXPECT_DOUBLE_EQ(damping[1], 4e-6);
  EXPECT_DOUBLE_EQ(damping[2], 4);
  CameraBlock block{};
  const auto set = [&](int i, double value) { block.sums[i / 2][i % 2] = value; };
  set(CameraBlock::kTt, 2);
  set(CameraBlock::kTt + 5, 8);
  set(CameraBlock::kRr + 3, 600);
  Vector6d expected;  // translations and rotations have separate scales
  expected << 1, 4e-6, 4, 3e-4, 300, 3e-4;
  EXPECT_LT((DampingOf(block, 0.5) - expected).norm(), 1e-12);
}

TEST_F(BundleKernels, EveryVersionOfARowOfProductsGivesTheSameBits) {
  constexpr int kCount = 5, kBlocks = 9;
  std::vector<double> A(18), B(18 * kCount), blocks(36 * kBlocks);
  for (auto* values : {&A, &B, &blocks}) {
    for (double& value : *values) value = random_.Gaussian();
  }
  const std::array<int, kCount> places{0, 2, 3, 7, 8};
  std::vector<double> two = blocks, fastest = blocks;
  SubtractRow2(A.data(), B.data(), places.data(), kCount, two.data());
  FastestSubtractRow()(A.data(), B.data(), places.data(), kCount, fastest.data());
  EXPECT_EQ(two, fastest);
  const Eigen::Map<const Matrix63> a(A.data());
  for (int n = 0; n < kCount; ++n) {
    const Eigen::Map<const Matrix63> b(B.data() + static_cast<ptrdiff_t>(18) * n);
    const Eigen::Map<const Matrix6d> before(blocks.data() + static_cast<ptrdiff_t>(36) * places[n]);
    const Eigen::Map<const Matrix6d> after(two.data() + static_cast<ptrdiff_t>(36) * places[n]);
    EXPECT_LT((before - a * b.transpose() - after).norm(), 10 * kRounding);
  }
}

// Thirteen sightings, one of them behind its camera.
TEST(EvaluateSightings, TwoAndFourAtOnceGiveTheSameBits) {
  if (FastestEvaluateSightings() == EvaluateSightings2) GTEST_SKIP() << "no AVX2";
  constexpr int kCount = 13, kRoom = 16;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> between(-1, 1);
  std::vector<std::array<double, 8>> seen(kRoom);
  std::vector<std::array<double, 12>> cameras(kRoom);
  std::vector<std::array<double, 3>> points(kRoom);
  std::vector<SightingPlace> places;
  for (int i = 0; i < kRoom; ++i) {
    const double bound = i % 2 ? std::numeric_limits<double>::infinity() : 2.4;
    seen[i] = {320 + 90 * between(random), 240 + 90 * between(random),
               310 + 90 * between(random), 1.5,
               i % 3 ? 0.0 : 2.5,          bound,
               i % 2 ? 0.2 : 0.0,          i % 5 ? 1.0 : 0.4};
    const Eigen::Matrix3d R = ExpSo3(0.2 * Eigen::Vector3d(between(random), between(random), 1));
    std::copy_n(R.data(), 9, cameras[i].begin());
    for (int n = 0; n < 3; ++n) {
      cameras[i][9 + n] = between(random);
      points[i][n] = between(random) + (n == 2 ? 4 : 0);
    }
  }
  points[6][2] = -4;
  for (int i = 0; i < kRoom; ++i)
    places.push_back({seen[i].data(), cameras[i].data(), points[i].data()});
  const SightingLens lens{500, 510, 320, 240, 40};
  for (const bool derivatives : {true, false}) {
    std::vector<SightingTerms> two(kRoom), fastest(kRoom);
    EvaluateSightings2(lens, places.data(), kCount, derivatives, two.data());
    FastestEvaluateSightings()(lens, places.data(), kCount, derivatives, fastest.data());
    for (int i = 0; i < kCount; ++i) {
      EXPECT_EQ(two[i].cost, fastest[i].cost);
      EXPECT_EQ(std::isinf(two[i].cost), i == 6);
      if (!derivatives) continue;
      EXPECT_TRUE(std::equal(two[i].camera, two[i].camera + 28, fastest[i].camera));
      EXPECT_TRUE(std::equal(two[i].Y, two[i].Y + 3, fastest[i].Y));
    }
  }
}

}  // namespace
}  // namespace alidade::bundle_kernels_test
