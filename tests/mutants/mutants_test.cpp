// The quick part of the mutation suite: bugs that small pictures show, and clean runs that must stay silent. All of it,
// and what needs long runs: tools/mutants.sh.
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <set>

#include "laboratory.h"
#include "support/device.h"

namespace weir::test {
namespace {

TEST(Mutants, HaveNumbersOfTheirOwnAndSituationsThatExist) {
  std::set<int> numbers;
  size_t shader = 0;
  for (const Mutant& m : mutants()) {
    EXPECT_TRUE(numbers.insert(m.number).second) << m.number;
    EXPECT_EQ(m.number > 100, m.host != nullptr) << m.number;
    EXPECT_NO_THROW(situationNamed(m.situation)) << m.number;
    shader += m.host == nullptr ? 1 : 0;
  }
  EXPECT_GE(numbers.size(), 30u);
  EXPECT_GT(shader, numbers.size() / 2);
}

class Quick : public testing::TestWithParam<std::string> {};

// A clean run is silent, and the situation's bugs that a quick run can show are all seen. Chance of a false alarm:
// kAlpha for the clean run.
TEST_P(Quick, CleanIsSilentAndBugsAreSeen) {
  const std::shared_ptr<gpu::Device> device = validatedDevice();
  const ExpectNoValidationMessages guard(*device);
  Laboratory laboratory(*device, situationNamed(GetParam()), 1.0, kAlpha);
  const Finding clean = laboratory.examine(nullptr, 7);
  EXPECT_FALSE(clean.caught) << "bias " << clean.low << " to " << clean.high << ", worst tile " << clean.worstT
                             << " of " << clean.bound;
  for (const Mutant& m : mutants()) {
    if (m.situation != GetParam() || !m.quick) continue;
    const Finding f = laboratory.examine(&m, 7);
    EXPECT_TRUE(f.caught) << m.number << ", " << m.bug << ": bias " << f.low << " to " << f.high << ", worst tile "
                          << f.worstT << " of " << f.bound;
  }
}

std::string nameOf(const testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::erase(name, '-');
  return name;
}
INSTANTIATE_TEST_SUITE_P(Mutants, Quick, testing::Values("room-pairwise", "room-initial", "moving", "tiles", "place"),
                         nameOf);

}  // namespace
}  // namespace weir::test
