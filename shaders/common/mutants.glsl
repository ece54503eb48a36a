// Known bugs, for tests that show that the tests would notice (tests/mutants). MUTANT(number, wrong, right) is `right`, always, unless
// the shader is compiled with WEIR_MUTANT, which only those tests do; then the one bug of that number is there.
#ifndef WEIR_MUTANTS
#define WEIR_MUTANTS

#ifdef WEIR_MUTANT
#define MUTANT(number, wrong, right) (WEIR_MUTANT == number ? (wrong) : (right))
#else
#define MUTANT(number, wrong, right) (right)
#endif

#endif
