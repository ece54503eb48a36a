// Elements of arrays in a JSON tree: kept where they are asked for, with their lines, and no more than agreed.
#include <gtest/gtest.h>
#include <weir/graph/json_tree.h>

namespace weir::graph {
namespace {

TEST(JsonElements, AreKeptInOrderWithTheirLinesWhereAskedFor) {
  const std::string text = "{\"a\": [1,\n \"x\",\n {\"b\": [true]}]}";
  JsonValue root;
  std::vector<Diagnostic> found;
  ASSERT_TRUE(readJson(text, "f", root, found, 4));
  const JsonValue& a = root.members.at(0).value;
  ASSERT_EQ(a.elements.size(), 3u);
  EXPECT_EQ(std::get<int64_t>(a.elements[0].scalar), 1);
  EXPECT_EQ(a.elements[1].line, 2);
  EXPECT_EQ(a.elements[2].line, 3);
  EXPECT_TRUE(std::get<bool>(a.elements[2].members.at(0).value.elements.at(0).scalar));
  EXPECT_TRUE(found.empty());
  // As graphs are read: checked and dropped.
  JsonValue dropped;
  ASSERT_TRUE(readJson(text, "f", dropped, found));
  EXPECT_TRUE(dropped.members.at(0).value.elements.empty());
}

TEST(JsonElements, BeyondTheMostAreRefused) {
  JsonValue root;
  std::vector<Diagnostic> found;
  EXPECT_FALSE(readJson("[[1, 2],\n [3]]", "f", root, found, 4));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NE(found[0].message.find("more than 4 elements"), std::string::npos);
  EXPECT_EQ(found[0].line, 2);
}

}  // namespace
}  // namespace weir::graph
