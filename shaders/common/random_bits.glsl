// Choices from uniform 32-bit numbers, where the 24 bits of a float in [0, 1) would be too few.
#ifndef WEIR_RANDOM_BITS
#define WEIR_RANDOM_BITS

// An index below n: of a million each has its share to within a part in four thousand, where 24 bits would miss by a sixteenth.
uint scaleBits(uint bits, uint n) {
  uint high, low;
  umulExtended(bits, n, high, low);
  return high;
}

// A number in one of `strata` equal parts of the 32 bits' range; fewer than `strata` numbers at its end are never reached.
uint stratumBits(uint bits, uint stratum, uint strata) {
  const uint width = 0xffffffffu / strata;
  return stratum * width + scaleBits(bits, width);
}

// In [0, 1]; small numbers keep all their bits, so that comparing with a small probability is right.
float unitFromBits(uint bits) { return float(bits) * (1.0 / 4294967296.0); }

#endif
