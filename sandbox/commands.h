// The commands of `weir`, one file each. Commands throw; main() turns exceptions into exit statuses.
#pragma once

namespace CLI {
class App;
}

/// An exit status that is neither done nor an error: a verdict. Everything has been said already.
struct CommandStatus {
  int status;
};

void addRenderCommand(CLI::App& app);
void addVerifyCommand(CLI::App& app);
void addBenchCommand(CLI::App& app);
void addCompareCommand(CLI::App& app);
void addPassesCommand(CLI::App& app);
void addSceneCommand(CLI::App& app);
void addDevicesCommand(CLI::App& app);
void addGraphCommand(CLI::App& app);
void addChartCommand(CLI::App& app);
void addViewCommand(CLI::App& app);
