#include <weir/scene/specular_albedo.h>

#include <array>
#include <cstddef>

namespace weir::scene {
namespace {

// unorm16, written by tools/specular_albedo.py.
constexpr std::array<uint16_t, std::size_t{kSpecularAlbedoColumns}* kSpecularAlbedoRows> kTable = {
#include "specular_albedo_table.inc"
};

}  // namespace

std::vector<float> specularAlbedoTable() {
  std::vector<float> table;
  table.reserve(kTable.size());
  for (const uint16_t value : kTable) table.push_back(static_cast<float>(value) / 65535.0f);
  return table;
}

}  // namespace weir::scene
