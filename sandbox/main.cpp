// `weir`: picks the command and turns what it throws into an exit status: 0 done, 1 failed while running, 2 bad input.
// `verify` adds its verdict: 1 biased, 3 undecided.
#include "commands.h"

#include <weir/core/error.h>
#include <weir/core/text.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>
#include <string>
#include <vector>

namespace {

enum Status { kDone = 0, kFailed = 1, kBadInput = 2 };

/// The innermost subcommand that was named.
const CLI::App& innermost(const CLI::App& app) {
  const std::vector<CLI::App*> parsed = app.get_subcommands();
  return parsed.empty() ? app : innermost(*parsed.back());
}

/// What could have been meant: the subcommands and long flags of the innermost command.
std::vector<std::string> validNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(sub->get_name());
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

int sayParseError(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App& command = innermost(app);
  const std::vector<std::string> unknown = app.remaining(true);
  std::string text = error.what();
  // "A subcommand is required" is no help to somebody who gave one.
  if (!unknown.empty() && dynamic_cast<const CLI::RequiredError*>(&error))
    text = fmt::format("'{}' is not known here", unknown.front());
  for (const std::string& argument : unknown) {
    const std::string nearest = weir::nearestName(argument.substr(0, argument.find('=')), validNames(command));
    if (!nearest.empty()) text += fmt::format(" ('{}': nearest is '{}')", argument, nearest);
  }
  std::string called = "weir";
  if (&command != &app) {
    for (const CLI::App* at = &command; at != &app; at = at->get_parent()) called.insert(4, " " + at->get_name());
  }
  fmt::print(stderr, "weir: {}\nsee: {} --help\n", text, called);
  return kBadInput;
}

void sayError(const char* text) {
  fmt::print(stderr, "weir: {}\n", text);
}

}  // namespace

// What throws while an error is being said may end the program.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
  CLI::App app("Weir: a declarative Vulkan render graph with ReSTIR passes.", "weir");
  app.set_version_flag("--version", "weir " WEIR_VERSION);
  app.set_help_all_flag("--help-all", "help on every command");
  app.require_subcommand(1);
  addRenderCommand(app);
  addViewCommand(app);
  addCompareCommand(app);
  addVerifyCommand(app);
  addBenchCommand(app);
  addChartCommand(app);
  addGraphCommand(app);
  addPassesCommand(app);
  addSceneCommand(app);
  addDevicesCommand(app);
  try {
    app.parse(argc, argv);
    return std::fflush(stdout) == 0 ? kDone : kFailed;
  } catch (const CommandStatus& verdict) {
    return std::fflush(stdout) == 0 ? verdict.status : kFailed;
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    return sayParseError(app, error);
  } catch (const weir::InputError& error) {
    sayError(error.what());
    return kBadInput;
  } catch (const std::exception& error) {
    sayError(error.what());
    return kFailed;
  }
}
