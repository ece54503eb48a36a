// The commands of `weir`, one file each; main() adds them to the parser.
#pragma once

namespace CLI {
class App;
}

void addSceneCommand(CLI::App& app);
