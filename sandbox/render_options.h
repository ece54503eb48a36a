// The options that say what is rendered and on what: shared by every command that renders.
#pragma once

#include <weir/graph/description.h>
#include <weir/render/stage.h>

#include <cstdint>
#include <string>

namespace CLI {
class App;
}

/// Throws InputError unless `text` reads "WIDTHxHEIGHT".
void parseSize(const std::string& text, uint32_t& width, uint32_t& height);

/// --set, --enable, --disable
void addOverrideOptions(CLI::App& command, weir::graph::Overrides& overrides);
/// --scene, --lights, --camera, --environment, --energy-compensation, --animate and what belongs to them
void addStageOptions(CLI::App& command, weir::render::StageOptions& stage);
/// --trace, --device, --validate
void addDeviceOptions(CLI::App& command, std::string& device, std::string& trace, bool& validation);
