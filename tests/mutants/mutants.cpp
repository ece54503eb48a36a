// The bugs. What a number does is written where it is, as MUTANT(number, wrong, right); host bugs are here.
#include <weir/scene/lights.h>

#include "laboratory.h"

namespace weir::test {
namespace {

std::vector<Mutant> makeMutants() {
  std::vector<Mutant> m = {
      {1, "the final shadow ray is forgotten for samples that were not seen", "room-unshadowed"},
  };
  // In what the host prepares.
  m.push_back({101, "light pdfs add up to 1.01", "room-initial", [](scene::PreparedScene& p) {
                 for (scene::GpuLight& light : p.lights) light.pdf *= 1.01f;
               }});
  m.push_back({102, "the alias table's thresholds are those of the next cell", "points", [](scene::PreparedScene& p) {
                 const float first = p.aliasTable.front().threshold;
                 for (size_t i = 0; i + 1 < p.aliasTable.size(); ++i)
                   p.aliasTable[i].threshold = p.aliasTable[i + 1].threshold;
                 p.aliasTable.back().threshold = first;
               }});
  m.push_back({103, "areas of triangle lights are 1 % too small", "room-initial", [](scene::PreparedScene& p) {
                 for (scene::GpuLight& light : p.lights) light.area *= 0.99f;
               }});
  m.push_back({104, "aliases of the table are off by one", "points", [](scene::PreparedScene& p) {
                 for (scene::AliasCell& cell : p.aliasTable) cell.alias = (cell.alias + 1) % p.aliasTable.size();
               }});
  m.push_back({105, "densities of the environment's cells are 1 % too large", "sky", [](scene::PreparedScene& p) {
                 for (auto& cell : p.environment.cells) cell.spread *= 0.99f;
               }});
  return m;
}

}  // namespace

const std::vector<Mutant>& mutants() {
  static const std::vector<Mutant> all = makeMutants();
  return all;
}

}  // namespace weir::test
