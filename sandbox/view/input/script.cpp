#include "view/input/script.h"

#include <weir/core/error.h>
#include <weir/core/text.h>

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <fstream>
#include <sstream>
#include <string_view>

namespace weir::view {
namespace {

/// A command and how many words it takes; `kMany`: one or more.
constexpr int kMany = -1;
struct Command {
  std::string_view name;
  int fewest, most;
};
constexpr std::array<Command, 26> kCommands = {{{"click", 1, 1},          {"click-right", 1, 1},
                                                {"double-click", 1, 1},   {"drag", 3, 3},
                                                {"look", 2, 3},           {"point", 1, 1},
                                                {"scroll", 2, 2},         {"set", 2, 2},
                                                {"text", 1, 1},           {"key", 1, 1},
                                                {"hold", 2, 2},           {"drop", 1, kMany},
                                                {"size", 2, 2},           {"minimise", 0, 0},
                                                {"restore", 0, 0},        {"wait", 1, 1},
                                                {"until-frames", 1, 1},   {"until-idle", 0, 0},
                                                {"expect", 1, 1},         {"expect-no", 1, 1},
                                                {"expect-message", 1, 1}, {"expect-no-messages", 0, 0},
                                                {"edit", 3, 3},           {"shoot", 1, 1},
                                                {"measure", 1, 1},        {"quit", 0, 0}}};

[[noreturn]] void refuse(const std::string& file, int line, const std::string& what) {
  throw InputError(fmt::format("{}:{}: {}", file, line, what));
}

std::vector<std::string> wordsOf(const std::string& text, const std::string& file, int line) {
  std::vector<std::string> words;
  for (size_t i = 0; i < text.size();) {
    if (text[i] == ' ' || text[i] == '\t' || text[i] == '\r') {
      ++i;
      continue;
    }
    if (text[i] == '#') break;
    std::string word;
    if (text[i] != '"') {
      while (i < text.size() && text[i] != ' ' && text[i] != '\t' && text[i] != '\r') word += text[i++];
      words.push_back(word);
      continue;
    }
    for (++i;; ++i) {
      if (i >= text.size()) refuse(file, line, "the quotes are not closed");
      if (text[i] == '"') break;
      if (text[i] == '\\' && i + 1 < text.size()) {
        ++i;
        word += text[i] == 'n' ? '\n' : text[i];
      } else {
        word += text[i];
      }
    }
    ++i;
    words.push_back(word);
  }
  return words;
}

bool isNumber(const std::string& text) {
  double value = 0.0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  return end.ec == std::errc() && end.ptr == text.data() + text.size();
}

/// Which of a command's words are numbers, from the first one on.
std::vector<size_t> numbersOf(const ScriptStep& step) {
  if (step.command == "drag") return {1, 2};
  if (step.command == "look") return step.words.size() == 3 ? std::vector<size_t>{1, 2} : std::vector<size_t>{0, 1};
  if (step.command == "scroll" || step.command == "hold") return {1};
  if (step.command == "size") return {0, 1};
  if (step.command == "wait" || step.command == "until-frames") return {0};
  return {};
}

}  // namespace

std::vector<ScriptStep> parseScript(const std::string& text, const std::string& file) {
  std::vector<ScriptStep> steps;
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    std::vector<std::string> words = wordsOf(line, file, number);
    if (words.empty()) continue;
    ScriptStep step{number, words.front(), {words.begin() + 1, words.end()}};
    const Command* known = nullptr;
    std::vector<std::string> names;
    for (const Command& command : kCommands) {
      names.emplace_back(command.name);
      if (command.name == step.command) known = &command;
    }
    if (known == nullptr) {
      const std::string nearest = nearestName(step.command, names);
      refuse(file, number,
             fmt::format("'{}' is not known{}", step.command, nearest.empty() ? "" : "; nearest is '" + nearest + "'"));
    }
    const auto count = static_cast<int>(step.words.size());
    if (count < known->fewest || (known->most != kMany && count > known->most))
      refuse(file, number, fmt::format("'{}' takes {} words, not {}", step.command, known->fewest, count));
    for (const size_t at : numbersOf(step))
      if (!isNumber(step.words[at])) refuse(file, number, fmt::format("'{}' is no number", step.words[at]));
    if (step.command == "look" && count == 3 && step.words[0] != "left" && step.words[0] != "right" &&
        step.words[0] != "middle")
      refuse(file, number, fmt::format("'{}' is none of left, right, middle", step.words[0]));
    steps.push_back(std::move(step));
  }
  return steps;
}

std::vector<ScriptStep> readScript(const std::string& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) throw InputError(fmt::format("--script {}: can't be read", file));
  return parseScript(text.str(), file);
}

}  // namespace weir::view
