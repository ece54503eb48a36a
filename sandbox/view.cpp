// `weir view`: becomes weir-view, which lies beside this program, so that this one needs no window system.
#include "commands.h"

#include <fmt/format.h>
#include <unistd.h>
#include <weir/core/error.h>

#include <CLI/CLI.hpp>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

void addViewCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("view", "Open the window (weir view --help has its options)");
  command->prefix_command();  // all of the options are the window's own
  command->set_help_flag();
  command->callback([command] {
    std::error_code error;
    const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
    const std::string program = (self.parent_path() / "weir-view").string();
    std::vector<std::string> words = command->remaining();
    std::vector<char*> arguments;
    std::string name = "weir view";
    arguments.push_back(name.data());
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    execv(program.c_str(), arguments.data());
    throw weir::RuntimeError(fmt::format("{} can't be started: {}", program, std::strerror(errno)));
  });
}
