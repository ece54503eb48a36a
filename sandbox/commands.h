// Every command of `weir` adds itself to the command line; one file a command.
#pragma once

namespace CLI {
class App;
}

void addDevicesCommand(CLI::App& app);
