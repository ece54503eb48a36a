// What the words of a reservoir say by themselves, without scene or surface: for whoever looks at reservoirs and merges none.
#ifndef WEIR_RESERVOIR_BITS
#define WEIR_RESERVOIR_BITS

// Set when a shadow ray from the reservoir's own pixel found its sample wholly visible.
const uint kSeen = 0x80000000u;

// Set by Shade when the final ray found it wholly hidden: a hint for the next frame, which no weight may depend on.
const uint kHidden = 0x40000000u;

uint lightOf(Reservoir r) { return r.light & ~(kSeen | kHidden); }
bool wasHidden(Reservoir r) { return (r.light & kHidden) != 0u; }
bool isSeen(Reservoir r) { return (r.light & kSeen) != 0u; }
bool isNull(Reservoir r) { return !(r.weight > 0.0); }

#endif
