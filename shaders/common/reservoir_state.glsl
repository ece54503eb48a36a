// What a reservoir says of itself, without surface or light.
#ifndef WEIR_RESERVOIR_STATE
#define WEIR_RESERVOIR_STATE

// Set when a shadow ray from the reservoir's own pixel found its sample wholly visible; of null samples, wholly hidden.
const uint kSeen = 0x80000000u;

uint lightOf(Reservoir r) { return r.light & ~kSeen; }
bool isSeen(Reservoir r) { return (r.light & kSeen) != 0u; }
bool isNull(Reservoir r) { return !(r.weight > 0.0); }
bool isHidden(Reservoir r) { return isNull(r) && isSeen(r); }  // a null sample because its light was found hidden

Reservoir emptyReservoir() { return Reservoir(0u, 0u, 0.0, 0.0); }
Reservoir nullReservoir(float confidence) { return Reservoir(0u, 0u, 0.0, confidence); }

#endif
