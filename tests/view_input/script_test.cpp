// Scripts: what they may say, and that their input is what a user's would be.
#include <gtest/gtest.h>
#include <weir/core/error.h>

#include <fstream>
#include <sstream>

#include "support/device.h"
#include "view/input/script.h"

namespace weir::view {
namespace {

std::string errorOf(const std::string& text) {
  try {
    parseScript(text, "s.script");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Script, ReadsWordsQuotesAndComments) {
  const std::vector<ScriptStep> steps =
      parseScript("# nothing\n\nclick a/b # here\nset x \"1 \\\"2\\\" \\\\ \\n\"\r\n\tquit", "s");
  ASSERT_EQ(steps.size(), 3u);
  EXPECT_EQ(steps[0].command, "click");
  EXPECT_EQ(steps[0].words, std::vector<std::string>{"a/b"});
  EXPECT_EQ(steps[0].line, 3);
  EXPECT_EQ(steps[1].words[1], "1 \"2\" \\ \n");
  EXPECT_EQ(steps[2].line, 5);
}

TEST(Script, SaysWhereAndWhatIsWrong) {
  EXPECT_NE(errorOf("click a\nclck b").find("s.script:2: 'clck' is not known; nearest is 'click'"), std::string::npos)
      << errorOf("click a\nclck b");
  EXPECT_NE(errorOf("click").find("s.script:1: 'click' takes 1 words, not 0"), std::string::npos);
  EXPECT_NE(errorOf("wait soon").find("'soon' is no number"), std::string::npos);
  EXPECT_NE(errorOf("text \"open").find("not closed"), std::string::npos);
  EXPECT_NE(errorOf("look up 1 2").find("'up' is none of"), std::string::npos);
  EXPECT_THROW(readScript("/nowhere/there.script"), InputError);
}

/// A window without one: widgets where the test says.
struct Stand {
  Marks marks{true};
  uint32_t frames = 0;
  bool quit = false, idle = true, shooting = false;
  glm::ivec2 size{0};
  std::vector<std::string> messages;
  ScriptHost host() {
    return {.setWindowSize = [this](glm::ivec2 s) { size = s; },
            .minimise = [](bool) {},
            .framesRendered = [this] { return frames; },
            .idle = [this] { return idle; },
            .messages = [this](bool) { return messages; },
            .shoot = [this](const std::string&) { shooting = true; },
            .shooting = [this] { return shooting; },
            .measure = [](const std::string&) {},
            .quit = [this] { quit = true; }};
  }
};

TEST(Script, AClickIsAMoveAPressAndARelease) {
  Stand stand;
  stand.marks.place("a/b", {{10.0f, 20.0f}, {30.0f, 40.0f}});
  ScriptPlayer player(parseScript("click a/b\nquit", "s"), "s", stand.marks, stand.host());
  std::vector<Event> all;
  for (int i = 0; i < 20 && !player.done(); ++i)
    for (const Event& event : player.next()) all.push_back(event);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].kind, Event::Kind::MouseMove);
  EXPECT_EQ(all[0].position, glm::vec2(20.0f, 30.0f));
  EXPECT_TRUE(all[1].kind == Event::Kind::MouseButton && all[1].down);
  EXPECT_TRUE(all[2].kind == Event::Kind::MouseButton && !all[2].down);
  EXPECT_TRUE(stand.quit);
}

TEST(Script, WaitsForWhatComesAndGivesUpOnWhatDoesNot) {
  Stand stand;
  ScriptPlayer player(parseScript("until-frames 2\nexpect there\nclick nowhere", "s"), "s", stand.marks, stand.host());
  for (int i = 0; i < 5; ++i) player.next();
  EXPECT_FALSE(player.done());
  stand.frames = 2;
  stand.marks.place("there", {{0.0f, 0.0f}, {1.0f, 1.0f}});
  stand.marks.place("somewhere", {{0.0f, 0.0f}, {1.0f, 1.0f}});
  std::string error;
  try {
    for (int i = 0; i < 1000; ++i) player.next();
  } catch (const RuntimeError& e) {
    error = e.what();
  }
  EXPECT_NE(error.find("s:3: click nowhere: no widget 'nowhere'; nearest is 'somewhere'"), std::string::npos) << error;
}

TEST(Script, MessagesAreExpectedByAPartOfTheirText) {
  Stand stand;
  stand.messages = {"shader: shade.glsl:3: syntax error"};
  ScriptPlayer player(parseScript("expect-message shade.glsl\nexpect-no-messages", "s"), "s", stand.marks,
                      stand.host());
  EXPECT_THROW(
      {
        for (int i = 0; i < 1000; ++i) player.next();
      },
      RuntimeError);
  stand.messages.clear();
  ScriptPlayer quiet(parseScript("expect-no-messages\nsize 640 480", "s"), "s", stand.marks, stand.host());
  for (int i = 0; i < 20; ++i) quiet.next();
  EXPECT_TRUE(quiet.done());
  EXPECT_EQ(stand.size, glm::ivec2(640, 480));
}

TEST(Script, EditsFilesAsAnEditorWould) {
  const test::TemporaryFolder folder;
  const std::string file = folder.write("a.glsl", "void run() {}");
  Stand stand;
  ScriptPlayer player(parseScript("edit " + file + " run() \"stop( )\"", "s"), "s", stand.marks, stand.host());
  player.next();
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  EXPECT_EQ(text.str(), "void stop( ) {}");
  ScriptPlayer again(parseScript("edit " + file + " run() x", "s"), "s", stand.marks, stand.host());
  EXPECT_THROW(again.next(), RuntimeError);
}

TEST(Events, CharactersOfAnyText) {
  EXPECT_EQ(charactersOf("aé→😀"), (std::vector<char32_t>{U'a', U'é', U'→', U'😀'}));
  EXPECT_EQ(charactersOf("a\xff\xc3"), (std::vector<char32_t>{U'a'}));
}

TEST(Events, KeysHaveNames) {
  EXPECT_EQ(keyNamed("F1"), Key::F1);
  EXPECT_EQ(keyNamed("f12"), Key::F12);
  EXPECT_EQ(keyNamed("Z"), Key::Z);
  EXPECT_EQ(keyNamed("7"), Key::Digit7);
  EXPECT_EQ(keyNamed("ctrl"), Key::Control);
  EXPECT_EQ(keyNamed("nothing"), Key::None);
}

}  // namespace
}  // namespace weir::view
