// The bugs. What a number does is written where it is, as MUTANT(number, wrong, right); host bugs are here.
#include <weir/scene/lights.h>

#include <algorithm>

#include "laboratory.h"

namespace weir::test {
namespace {

std::vector<Mutant> makeMutants() {
  std::vector<Mutant> m = {
      {1, "the final shadow ray is forgotten for samples that were not seen", "room-unshadowed", {}, true},
      {2, "last frame's target with this frame's lights", "moving", {}, true},
      {3, "last frame's target with this frame's acceleration structure", "moving", {}, true},
      {5, "W does not follow the area of a light that grows", "moving", {}, true},
      {6, "visibility is left out of the neighbours' targets", "room-pairwise", {}, true},
      {7, "1/Z without any test of what survives", "room-z", {}, true},
      {8, "pairwise: the neighbour in the canonical weight has the centre's view", "shiny-pairwise"},
      {9, "pairwise: the neighbour in the canonical weight has the centre's normal", "room-pairwise"},
      {10, "a neighbour's target with the centre's position", "room-balance"},
      {11, "pairwise: the neighbour in the canonical weight has the centre's albedo", "room-pairwise"},
      {12, "null samples lose their confidence in spatial reuse", "room-pairwise", {}, true},
      {13, "neighbours whose sample is dark here lose their confidence", "room-pairwise", {}, true},
      {14, "last frame's surface is unpacked with this frame's camera", "sliding", {}, true},
      {15, "null samples lose their confidence in temporal reuse", "room-temporal", {}, true},
      {16, "temporal reuse throws no dice", "room-temporal", {}, true},
      {17, "pairwise: the canonical sample gets its defensive share alone", "room-pairwise", {}, true},
      {18, "pairwise: a neighbour's own confidence in place of all neighbours'", "room-pairwise", {}, true},
      {19, "the resampling weight takes the neighbour's target for the pixel's", "room-pairwise"},
      {20, "a sample that was seen from a neighbour counts as seen here", "room-pairwise", {}, true},
      {21, "pairwise: neighbours weigh by confidence alone", "room-pairwise", {}, true},
      {22, "balance: only two domains stand in a denominator", "room-balance", {}, true},
      {23, "balance: the own sample's weight without its confidence", "room-balance", {}, true},
      {24, "Z counts every domain (1/M)", "room-z", {}, true},
      {25, "Z: a sample that is hidden where it comes from is used", "room-z-untested", {}, true},
      {26, "reservoirs take new samples too readily", "room-pairwise"},
      {27, "W is 0.4 % too small", "room-initial"},
      {28, "half hidden counts as hidden", "pane", {}, true},
      {29, "a pixel's light is clamped", "room-initial"},
      {30, "the sum of candidates is divided by one too many", "room-many"},
      {31, "directions by the BSDF are forgotten in the heuristic's sum", "sky", {}, true},
      {32, "a ray's density is left per steradian", "rays", {}, true},
      {33, "lamps that rays find keep all their weight", "rays", {}, true},
      {34, "tiles hold the first half of the table alone", "tiles", {}, true},
      {35, "what is chosen from a tile is looked up as the light beside it", "tiles", {}, true},
      {36, "pixels read the same place of every tile", "tiles", {}, true},
      {37, "W forgets the uniform share of what a tile was drawn with", "tiles", {}, true},
      {81, "nodes of the light tree's cut claim to be equally likely", "place", {}, true},
      {82, "lights of a leaf claim to be equally likely", "place", {}, true},
      {83, "the density of a light without a place forgets their share of the picks", "place", {}, true},
      {84, "a tile's horizons are taken from directions to the viewer", "place", {}, true},
      {85, "what a tile spans is taken from its first rows alone", "place", {}, true},
      {86, "whether lights can stand above surfaces is asked of the middles of boxes", "place", {}, true},
      {70, "with all merged light, half of what is hidden stays", "room-unshadowed", {}, true},
      {71, "the light of a hidden survivor stays in the merged light", "room-pairwise", {}, true},
      {72, "pairwise: the one neighbour that is asked stands for itself alone", "room-pairwise", {}, true},
      {40, "points on triangles are not uniform in area", "room-area"},
      {41, "a spot falls off linearly", "points", {}, true},
      {42, "a point light's window without its second square", "points", {}, true},
      {43, "the density of a pick forgets the uniform share", "points", {}, true},
      {44, "Fresnel's angle is taken from the normal", "room-gloss"},
      {45, "shadowing and masking are taken as independent", "rough"},
      {46, "the diffuse lobe gets what the specular one has reflected", "room-initial", {}, true},
      {47, "shadow rays end half-way", "room-initial"},
      {48, "shadow rays start off the surface", "room-initial"},
      {49, "directions are uneven within a cell of the sky", "sky"},
      {51, "the lobe's share is missing in the density of points on lamps", "gloss", {}, true},
      {52, "the density of points forgets that some go along the lobe", "gloss", {}, true},
      {53, "points by solid angle claim the density of points by area", "room-initial", {}, true},
      {60, "light samples keep all their weight beside the BSDF's", "paths", {}, true},
      {61, "paths that survive the roulette stand for themselves alone", "paths", {}, true},
      {62, "the light's density at a hit is left per m²", "paths"},
      {63, "the BSDF's density takes its lobes as equally likely", "paths", {}, true},
      {64, "paths end a vertex early", "paths", {}, true},
      {65, "lamps that rays meet keep all their weight", "paths", {}, true},
      {66, "the sky's density at a miss forgets the uniform share", "sky-paths"},
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
  m.push_back(
      {103, "the brightest light claims a hundredth more than its share", "points",
       [](scene::PreparedScene& p) { std::ranges::max_element(p.lights, {}, &scene::GpuLight::pdf)->pdf *= 1.01f; }});
  m.push_back({104, "aliases of the table are off by one", "points", [](scene::PreparedScene& p) {
                 for (scene::AliasCell& cell : p.aliasTable) cell.alias = (cell.alias + 1) % p.aliasTable.size();
               }});
  m.push_back({105, "densities of the environment's cells are 1 % too large", "sky", [](scene::PreparedScene& p) {
                 for (auto& cell : p.environment.cells) cell.spread *= 0.99f;
               }});
  std::ranges::sort(m, {}, &Mutant::number);
  return m;
}

}  // namespace

const std::vector<Mutant>& mutants() {
  static const std::vector<Mutant> all = makeMutants();
  return all;
}

}  // namespace weir::test
