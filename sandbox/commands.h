// One function a command: adds it, its options and what it does to the command line.
#pragma once

#include <CLI/CLI.hpp>

void addCompareCommand(CLI::App& app);
