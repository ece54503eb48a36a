// The commands of `weir`, one file each. Commands throw; main() turns exceptions into exit statuses.
#pragma once

namespace CLI {
class App;
}

void addRenderCommand(CLI::App& app);
void addCompareCommand(CLI::App& app);
void addPassesCommand(CLI::App& app);
void addSceneCommand(CLI::App& app);
void addDevicesCommand(CLI::App& app);
void addGraphCommand(CLI::App& app);
