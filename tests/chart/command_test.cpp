// `weir chart` as a process.
#include "chart/bench_text.h"
#include "cli/program.h"

namespace weir::test {
namespace {

class ChartCommand : public Program {
 protected:
  std::string input(const Json& json, const std::string& name = "bench.json") const {
    return inputs.write(name, json.dump());
  }
  const TemporaryFolder inputs;
};

TEST_F(ChartCommand, WritesPageAndPicture) {
  if (!TEST_HAS_PAGE) GTEST_SKIP() << "built without the page: no node or no npm";
  const std::string b = input(bench({configuration("a", 4, 0.5)}));
  const Ran r =
      weir("chart " + b + " --out " + file("r.html") + " --svg " + file("r.svg") + " --title 'A title' --time wall");
  EXPECT_EQ(r.status, 0) << r.err;
  EXPECT_EQ(r.err, "");
  expectHas(r.out, "1 configurations, 1 scenes");
  expectHas(read(file("r.html")), "<title>A title</title>");
  expectHas(read(file("r.svg")), "wall time of a frame");
}

TEST_F(ChartCommand, BadInputWritesNothing) {
  const std::string good = input(bench({configuration("a", 4, 0.5)})), out = " --svg " + file("r.svg");
  Json wrong = configuration("a", 4, 0.5);
  wrong["frame"] = 3;
  const std::string bad = input(bench({wrong}), "bad.json");
  expectRefused("chart " + good + " " + bad + out, "bad.json: configurations[0].frame: 3; expected an object");
  expectRefused("chart " + good + out + " --out " + file("r.svg"), "which --out writes too");
  expectRefused("chart " + good + " --out " + good, "--out would write");
  expectRefused("chart " + good + out + " --time fame", "nearest is 'frame'");
  expectRefused("chart " + good + out + " --error relmse_mean65", "nearest is 'relmse_mean64'");
  expectRefused("chart " + good + " --svg /nowhere/r.svg", "no folder /nowhere");
  expectRefused("chart " + good + " --svg /dev/null", "no regular file");
  expectRefused("chart " + good, "neither --out nor --svg");
  expectRefused("chart" + out, "files is required");
  expectRefused("chart " + good + out + " --titel x", "nearest is '--title'");
  expectRefused("chart " + good + out + " --picture-limit=-1", "--picture-limit");
  expectRefused("chart " + inputs.path() + "/none.json" + out, "no bench file at");
  EXPECT_EQ(Json::parse(read(good)), bench({configuration("a", 4, 0.5)}));
}

TEST_F(ChartCommand, TitlesAreAnyBytes) {
  const std::string b = input(bench({configuration("a", 4, 0.5)}));
  const Ran r = weir("chart " + b + " --svg " + file("r.svg") + " --title \"$(printf '\\377</title>')\"");
  EXPECT_EQ(r.status, 0) << r.err;
  expectHas(read(file("r.svg")), "<title>\xef\xbf\xbd&lt;/title&gt;</title>");
}

}  // namespace
}  // namespace weir::test
