#include <gtest/gtest.h>
#include <weir/core/parallel.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <vector>

namespace weir {
namespace {

TEST(ParallelFor, DoesEachPieceOnce) {
  for (const size_t count : {size_t{0}, size_t{1}, size_t{1000}}) {
    std::vector<std::atomic<int>> done(count);
    parallelFor(count, [&](size_t i) { ++done[i]; });
    for (const auto& n : done) EXPECT_EQ(n, 1);
  }
}

TEST(ParallelFor, EndsInTheErrorThatALoopWouldEndIn) {
  for (int round = 0; round < 50; ++round) {
    std::vector<std::atomic<int>> done(200);
    try {
      parallelFor(done.size(), [&](size_t i) {
        ++done[i];
        if (i % 20 == 7) throw std::runtime_error(std::to_string(i));
      });
      FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& e) {
      EXPECT_STREQ(e.what(), "7");
    }
    for (size_t i = 0; i <= 7; ++i) EXPECT_EQ(done[i], 1);
  }
}

}  // namespace
}  // namespace weir
