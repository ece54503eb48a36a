// Pages and still pictures: everything is in them, nothing can break out of its place, and a file appears whole or not
// at all.
#include <algorithm>
#include <filesystem>

#include "chart/bench_text.h"

namespace weir::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTemplate =
    "<title><!--weir:title--></title><noscript><!--weir:svg--></noscript>"
    "<script type=\"application/json\" id=\"data\"><!--weir:data--></script><script>run()</script>";
const std::string kHostile = "</script></noscript></title><script>alert(1)</script><!--weir:data--><!--\"&'\n";

size_t count(const std::string& text, const std::string& words) {
  size_t n = 0;
  for (size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) ++n;
  return n;
}

chart::View view(const chart::Bench& b, const std::string& title) {
  return {title, chart::chooseTime(b, ""), chart::chooseError(b, "")};
}

std::string page(const chart::Bench& b, const std::string& title) {
  std::vector<std::string> warnings;
  return chart::fillPage(kTemplate, b, view(b, title), chart::embedPictures(b, {}, 0, warnings));
}

Json dataOf(const std::string& page) {
  const std::string start = "id=\"data\">";
  const size_t from = page.find(start) + start.size();
  return Json::parse(page.substr(from, page.find("</script>", from) - from));
}

/// Every text of a configuration that may be any text.
Json hostile() {
  Json c = configuration(kHostile, 4, 0.5);
  for (const char* key : {"graph", "name", "command"}) c[key] = kHostile;
  for (const char* key : {"file", "digest", "lights", "camera"}) c["scene"][key] = kHostile;
  c["settings"] = c["parameters"] = {{kHostile, kHostile}};
  c["passes"][0]["name"] = c["passes"][0]["type"] = kHostile;
  c["error"]["reference"] = {{"what", kHostile}, {"exact", true}};
  c["floor"] = {{"multiple", 1.5}, {"parts", {{{"name", kHostile}, {"gpu_ms", 1}}}}};
  return c;
}

TEST_F(BenchText, ThePageHoldsWhatTheFileSays) {
  const chart::Bench b = chart::readBench({write(bench({configuration("a", 4, 0.5), configuration("b", 2, 1)}))});
  const Json data = dataOf(page(b, "T"));
  EXPECT_EQ(data.at("title"), "T");
  EXPECT_EQ(data.at("time"), "frame");
  EXPECT_EQ(data.at("error"), "relmse.median");
  EXPECT_EQ(data.at("groups").at(0).at("configurations"), (Json{0, 1}));
  const Json& c = data.at("configurations").at(1);
  EXPECT_EQ(c.at("times").at(0), (Json{2.0, 2.0, 2.5}));
  EXPECT_EQ(c.at("errors").at(0), (Json{1.0, 0.5, 2.0}));
  EXPECT_TRUE(c.at("errors").at(1).is_null());
  EXPECT_EQ(c.at("pictures"), (Json{-1, -1, -1}));
  EXPECT_EQ(c.at("data").at("id"), "b");
}

TEST_F(BenchText, NothingBreaksOutOfThePage) {
  Json json = bench({hostile()});
  for (const char* key : {"device", "driver", "trace", "weir"}) json[key] = kHostile;
  const chart::Bench b = chart::readBench({write(json)});
  const std::string html = page(b, kHostile);
  EXPECT_EQ(count(html, "</script"), 2u);
  EXPECT_EQ(count(html, "<script"), 2u);
  EXPECT_EQ(count(html, "</noscript"), 1u);
  EXPECT_EQ(count(html, "</title"), 3u);  // of the page, of its still picture and of the one point in it
  EXPECT_EQ(count(html, "<!--"), 0u);
  const Json data = dataOf(html);  // and all of it still means the same
  EXPECT_EQ(data.at("configurations").at(0).at("data").at("id"), kHostile);
  EXPECT_EQ(data.at("configurations").at(0).at("data").at("settings").at(kHostile), kHostile);
  EXPECT_EQ(data.at("files").at(0).at("device"), kHostile);
}

TEST_F(BenchText, ATemplateWithoutASlotIsRefused) {
  const chart::Bench b = chart::readBench({write(bench({configuration("a", 4, 0.5)}))});
  EXPECT_THROW(chart::fillPage("<!--weir:title--><!--weir:data-->", b, view(b, ""), {{}, {{-1, -1, -1}}}),
               RuntimeError);
}

TEST_F(BenchText, TheStillPictureShowsPointsBarsAndFront) {
  std::vector<Json> all;
  for (const auto& [ms, error] : {std::pair{1.0, 4.0}, {2.0, 2.0}, {4.0, 1.0}, {4.0, 3.0}})
    all.push_back(configuration(std::to_string(all.size()), ms, error));
  Json none = configuration("none", 1, 1), other = configuration("other", 1, 1);
  none.erase("error");
  other["scene"]["file"] = "other.glb";
  other["graph"] = "second.json";
  other.erase("error");
  all.push_back(none);
  all.push_back(other);
  const chart::Bench b = chart::readBench({write(bench(all))});
  const std::string svg = chart::drawSvg(b, view(b, "T & <U>"));
  EXPECT_EQ(count(svg, "class=\"point\""), 4u + 2u);  // and two in the legend
  EXPECT_EQ(count(svg, "class=\"bar\""), 4u);
  EXPECT_EQ(count(svg, "class=\"front\""), 1u);
  expectHas(svg, "4 configurations, 3 on the front");
  expectHas(svg, "<title>T &amp; &lt;U&gt;</title>");
  expectHas(svg, "no configuration has both of these figures");  // of other.glb
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
}

TEST_F(BenchText, ExtremeFiguresAreDrawnToo) {
  Json wide = configuration("b", 1e300, 1e-300);
  wide["error"]["relmse"]["median"] = {{"value", 1e-300}, {"low", -1e300}, {"high", 1e300}};
  for (const Json& c : {wide, configuration("c", 5e-324, 5e-324), configuration("d", 1, 1)}) {
    const chart::Bench b = chart::readBench({write(bench({c, configuration("a", 1e-12, 1e12)}))});
    const std::string svg = chart::drawSvg(b, view(b, "T"));
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("inf"), std::string::npos);
    EXPECT_LT(svg.size(), 40000u);
    dataOf(page(b, "T"));
  }
}

TEST(Xml, HoldsNothingButText) {
  EXPECT_EQ(chart::escapeXml("<a href=\"x\">'&"), "&lt;a href=&quot;x&quot;&gt;&#39;&amp;");
  EXPECT_EQ(chart::escapeXml(std::string("a\0b\x1b\n", 5)),
            "a\xef\xbf\xbd"
            "b\xef\xbf\xbd\n");
  EXPECT_EQ(chart::escapeXml("\xef\xbf\xbf\xc3\xa4"), "\xef\xbf\xbd\xc3\xa4");
}

TEST(Base64, AsInRfc4648) {
  EXPECT_EQ(chart::base64(""), "");
  EXPECT_EQ(chart::base64("f"), "Zg==");
  EXPECT_EQ(chart::base64("fo"), "Zm8=");
  EXPECT_EQ(chart::base64("foo"), "Zm9v");
  EXPECT_EQ(chart::base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(chart::base64("\xff\xfe\xfd"), "//79");
}

class Pictures : public BenchText {
 protected:
  chart::Bench withPictures(size_t configurations) const {
    const std::string head = "\x89PNG\r\n\x1a\n";
    std::vector<Json> all;
    for (size_t i = 0; i < configurations; ++i) {
      Json c = configuration(std::to_string(i), 1, 1);
      const std::string n = std::to_string(i) + ".png";
      write(head + std::string(992, static_cast<char>('a' + i)), n);
      write(head + "reference", "r" + n);  // another file, the same content
      c["pictures"] = {{"crop", {0, 0, 1, 1}}, {"frame", n}, {"reference", "r" + n}};
      all.push_back(c);
    }
    return chart::readBench({write(bench(all))});
  }
  std::vector<std::string> warnings;
};

TEST_F(Pictures, EachContentIsEmbeddedOnce) {
  const chart::EmbeddedPictures p = chart::embedPictures(withPictures(3), {0, 1, 2}, 1u << 20u, warnings);
  EXPECT_EQ(p.base64.size(), 4u);
  EXPECT_EQ(p.of[0][1], p.of[2][1]);
  EXPECT_NE(p.of[0][0], p.of[2][0]);
  EXPECT_EQ(p.of[0][2], -1);
  EXPECT_EQ(p.leftOut, 0u);
  EXPECT_TRUE(warnings.empty());
}

// 1000 bytes a frame and 17 for the reference that they share: two of three have room, in the order that was asked for.
TEST_F(Pictures, TheFirstOnesComeFirstWhereThereIsALimit) {
  const chart::EmbeddedPictures p = chart::embedPictures(withPictures(3), {2, 0, 1}, 2017, warnings);
  EXPECT_EQ(p.base64.size(), 3u);
  EXPECT_EQ(p.leftOut, 1u);
  EXPECT_GE(p.of[2][0], 0);
  EXPECT_GE(p.of[0][0], 0);
  EXPECT_EQ(p.of[1][0], -1);
}

TEST_F(Pictures, WhatIsNoPictureIsLeftOutWithAWarning) {
  const chart::Bench b = withPictures(3);
  write(std::string("GIF89a"), "0.png");
  write(std::string("\x89PNG\r\n\x1a\n") + std::string(9u << 20u, 'x'), "1.png");
  fs::remove(path("2.png"));
  const chart::EmbeddedPictures p = chart::embedPictures(b, {0, 1, 2}, 64u << 20u, warnings);
  ASSERT_EQ(warnings.size(), 3u);
  expectHas(warnings[0], "0.png is left out: no PNG");
  expectHas(warnings[1], "1.png is left out: larger than 8 MiB");
  expectHas(warnings[2], "2.png is left out: empty or not readable");
  for (const auto& of : p.of) EXPECT_EQ(of[0], -1);
  EXPECT_GE(p.of[0][1], 0);  // the reference is shown all the same
}

}  // namespace
}  // namespace weir::test
