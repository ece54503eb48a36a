// The commands of `weir`, one file each. Each function adds its subcommand; the work runs in its callback, which throws
// InputError or RuntimeError (main.cpp turns them into exit statuses) and prints results on stdout.
#pragma once

namespace CLI {
class App;
}

void addGraphCommand(CLI::App& app);
void addPassesCommand(CLI::App& app);
