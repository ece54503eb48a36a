// What of a port can be shown: the list that a user chooses from, worked out once when a port is picked.
#pragma once

#include <weir/graph/compile.h>

#include <cstdint>
#include <string>
#include <vector>

namespace weir::view {

/// How the bytes of a port are read on the device: which of shaders/view/read_*.glsl does it.
enum class Reading : uint8_t { Image, Integers, Words, Surface, Reservoir };
inline constexpr size_t kReadings = 5;

/// What a channel's values are, and so how they are shown.
enum class Shows : uint8_t {
  Number,     ///< grey by the range, or in false colour
  Color,      ///< three numbers as red, green and blue
  Direction,  ///< a vector in the picture: its hue says where it goes, its brightness how far against the range's end
  Label,      ///< a number that names something: each its own colour
  State,      ///< one of a few, in the colours that Channel::doc names
};

struct Channel {
  std::string name, doc;  ///< doc: one line
  std::string unit;       ///< of its numbers; may be empty
  Shows shows = Shows::Number;
  float low = 0.0f, high = 1.0f;  ///< the range to begin with
  bool guessed = false;           ///< nobody can know the range beforehand: measure it (picture/range_meter.h)
  bool logarithmic = false;       ///< its values spread over orders of magnitude: better so to begin with
  bool exposed = false;           ///< exposure applies: radiance
  bool encoded = false;           ///< linear light, which the sRGB curve takes to the screen, as when a PNG is written
  Reading reading = Reading::Image;
  uint32_t code = 0, word = 0;  ///< as the shader counts: which value, and where in the element it starts
  uint64_t layout = 0;          ///< hash of the layout that it is of; 0: an image
};

/// Columns and rows of a port as a picture. A buffer of a fixed number of elements has no pixels: its elements fill
/// rows of a square, first one top left.
struct Extent {
  uint32_t width = 0, height = 0;
  bool operator==(const Extent&) const = default;
};
Extent extentOf(const graph::Resource& resource);

/// How the numbers of a port are meant, by the pass that makes it: Data where none says.
Meaning meaningOf(const graph::CompiledGraph& graph, const graph::Resource& resource);

/// Every channel of a port; the first one is the one to begin with. Layouts that Weir knows (PackedSurface, Reservoir)
/// in the field's terms, others by their fields. `f90`: the scene has that trait, and surfaces a value more.
std::vector<Channel> channelsOf(const graph::Resource& resource, Meaning meaning, bool f90 = false);

/// Whether a channel is one of a resource of this type: not so when the graph changed since the channels were listed.
bool belongs(const Channel& channel, const graph::Resource& resource);

/// The channel of that name, or nullptr.
const Channel* findChannel(const std::vector<Channel>& channels, const std::string& name);

/// Where a layout's fields start, in bytes, by std430's rules; ends before the first type that is unknown.
std::vector<uint32_t> fieldOffsets(const Layout& layout);
/// Components of a field: 1 to 4; 0: an unknown type.
uint32_t componentsOf(const std::string& type);

/// Whether a layout is that of passes/common/layouts.h.
bool isPackedSurface(const Layout& layout);
bool isReservoir(const Layout& layout);

}  // namespace weir::view
