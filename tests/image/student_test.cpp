#include <gtest/gtest.h>
#include <weir/image/student.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace weir::image {
namespace {

TEST(Student, IncompleteBetaClosedForms) {
  for (const double x : {0.0, 1e-6, 0.1, 0.5, 0.77, 1.0}) {
    EXPECT_NEAR(incompleteBeta(1, 1, x), x, 1e-14);
    EXPECT_NEAR(incompleteBeta(3, 1, x), x * x * x, 1e-14);
    EXPECT_NEAR(incompleteBeta(1, 4, x), 1 - std::pow(1 - x, 4), 1e-13);
    EXPECT_NEAR(incompleteBeta(0.5, 0.5, x), 2 / std::numbers::pi * std::asin(std::sqrt(x)), 1e-13);
  }
}

TEST(Student, ClosedFormsForOneAndTwoDegrees) {
  for (const double t : {-30.0, -2.0, -0.1, 0.0, 0.5, 1.0, 7.0}) {
    EXPECT_NEAR(studentTCdf(t, 1), 0.5 + std::atan(t) / std::numbers::pi, 1e-13);
    EXPECT_NEAR(studentTCdf(t, 2), 0.5 + t / (2 * std::sqrt(2 + t * t)), 1e-13);
  }
}

TEST(Student, QuantilesOfPrintedTables) {
  // P(T <= t), degrees of freedom, t to three decimals, as every table has them.
  const struct {
    double p;
    int freedom;
    double t;
  } table[] = {{0.975, 1, 12.706}, {0.975, 2, 4.303},   {0.975, 5, 2.571},   {0.975, 10, 2.228}, {0.975, 30, 2.042},
               {0.975, 60, 2.000}, {0.975, 120, 1.980}, {0.95, 10, 1.812},   {0.995, 10, 3.169}, {0.995, 60, 2.660},
               {0.999, 20, 3.552}, {0.9995, 5, 6.869},  {0.9995, 30, 3.646}, {0.75, 7, 0.711}};
  for (const auto& row : table) {
    EXPECT_NEAR(studentTQuantile(row.p, row.freedom), row.t, 5.1e-4) << row.p << ' ' << row.freedom;
    EXPECT_NEAR(studentTQuantile(1 - row.p, row.freedom), -row.t, 5.1e-4);
  }
  EXPECT_NEAR(studentTQuantile(0.975, 1000000), 1.959964, 1e-5);
  EXPECT_EQ(studentTQuantile(0.5, 3), 0.0);
}

TEST(Student, QuantileInvertsTheTailFarOut) {
  for (const int freedom : {1, 3, 63, 1000}) {
    for (const double p : {0.3, 1e-3, 1e-6, 1e-12}) {
      EXPECT_NEAR(studentTTwoSided(studentTQuantile(p / 2, freedom) * -1, freedom) / p, 1.0, 1e-10)
          << freedom << ' ' << p;
    }
  }
}

TEST(Student, BoundsForATestOfAWholePicture) {
  EXPECT_NEAR(studentTBound(63, 0.01, 510), 4.62, 0.005);   // 1920x1080 in tiles of 64²
  EXPECT_NEAR(studentTBound(63, 0.01, 8160), 5.37, 0.005);  // and of 16²
  EXPECT_NEAR(studentTBound(63, 0.05, 1), studentTQuantile(0.975, 63), 1e-12);
}

TEST(Student, NonsenseIsRefused) {
  EXPECT_THROW(studentTBound(63, 0.0, 1), std::invalid_argument);
  EXPECT_THROW(studentTBound(63, 0.01, 0), std::invalid_argument);
  EXPECT_THROW(studentTBound(0, 0.01, 1), std::invalid_argument);
  EXPECT_THROW(studentTQuantile(1.0, 5), std::invalid_argument);
}

}  // namespace
}  // namespace weir::image
