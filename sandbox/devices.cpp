// `weir devices`: the Vulkan devices of this machine and what each lacks for which pass.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <weir/gpu/device.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.h"

namespace {

using weir::gpu::Capabilities;
using weir::gpu::DeviceInfo;

std::string versionText(uint32_t version) {
  return fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(version), VK_API_VERSION_MINOR(version),
                     VK_API_VERSION_PATCH(version));
}

std::vector<std::string> rayBackEnds(const Capabilities& has) {
  std::vector<std::string> names;
  if (has.rayPipeline) names.push_back("pipeline");
  if (has.rayQuery) names.push_back("query");
  return names;
}

/// What the device can't run although it has Weir's minimum.
std::vector<std::string> shortcomings(const Capabilities& has) {
  std::vector<std::string> lines;
  if (!has.rayPipeline && !has.rayQuery) {
    lines.push_back("ray tracing: passes that trace (gbuffer.RayTraced, visibility, shadows) can't run");
  } else if (!has.rayPipeline) {
    lines.push_back("ray-tracing pipelines: passes trace with ray queries (--trace pipeline can't be asked for)");
  } else if (!has.rayQuery) {
    lines.push_back("ray queries: passes trace with ray-tracing pipelines (--trace query can't be asked for)");
  }
  if (!has.graphics) lines.push_back("rasterising: gbuffer.Raster and the window can't run");
  if (has.timestampPeriod == 0.0f) lines.push_back("timestamps: pass times are not measured");
  return lines;
}

nlohmann::ordered_json toJson(const DeviceInfo& device) {
  const Capabilities& has = device.capabilities;
  const bool usable = device.missing.empty();
  return {{"index", device.index},
          {"name", device.name},
          {"kind", device.kind},
          {"driver", device.driver},
          {"api", versionText(device.apiVersion)},
          {"usable", usable},
          {"missing", device.missing},
          {"graphics", has.graphics},
          {"ray_back_ends", rayBackEnds(has)},
          {"lacks", usable ? shortcomings(has) : std::vector<std::string>()},
          {"limits",
           {{"subgroup_size", has.subgroupSize},
            {"timestamp_period_ns", has.timestampPeriod},
            {"max_storage_buffer_bytes", has.maxStorageBufferRange},
            {"max_textures", has.maxTextures}}}};
}

void print(const DeviceInfo& device) {
  fmt::print("{}: {}\n", device.index, device.name);
  fmt::print("   {}, Vulkan {}, {}\n", device.kind, versionText(device.apiVersion), device.driver);
  if (!device.missing.empty()) {
    fmt::print("   cannot run Weir: lacks {}\n", fmt::join(device.missing, ", "));
    return;
  }
  const std::vector<std::string> backEnds = rayBackEnds(device.capabilities);
  fmt::print("   traces rays by: {}\n", backEnds.empty() ? "nothing" : fmt::format("{}", fmt::join(backEnds, ", ")));
  for (const std::string& line : shortcomings(device.capabilities)) fmt::print("   lacks {}\n", line);
}

}  // namespace

void addDevicesCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("devices", "Vulkan devices and what each lacks for which pass");
  const auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "machine-readable");
  command->callback([json] {
    const std::vector<DeviceInfo> devices = weir::gpu::listDevices();
    if (*json) {
      nlohmann::ordered_json list = nlohmann::ordered_json::array();
      for (const DeviceInfo& device : devices) list.push_back(toJson(device));
      fmt::print("{}\n", list.dump(2));
      return;
    }
    for (const DeviceInfo& device : devices) print(device);
    if (devices.empty()) fmt::print("No Vulkan device.\n");
  });
}
