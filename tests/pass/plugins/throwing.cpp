// Passes that throw each kind of thing from each of their functions.
#include "test_pass.h"

#include <stdexcept>

namespace {

enum class What { Input, Runtime, Other, Int };
enum class Where { Constructor, Prepare, Record };

class NoText final : public std::exception {
 public:
  const char* what() const noexcept override { return nullptr; }
};

template <Where kPlace, What kWhat>
class Throwing final : public TestPass {
 public:
  Throwing() { at(Where::Constructor); }
  void prepare(weir::PrepareContext&) override { at(Where::Prepare); }
  void record(weir::RecordContext&) override { at(Where::Record); }

 private:
  static void at(Where place) {
    if (place != kPlace) return;
    switch (kWhat) {
      case What::Input:
        throw weir::InputError("the aspect must not be zero");
      case What::Runtime:
        throw weir::RuntimeError("the disk is full");
      case What::Other:
        throw std::out_of_range("index 7 of 3");
      case What::Int:
        throw 42;
    }
  }
};

/// Throws nothing itself; what it calls does.
class Asks final : public TestPass {
 public:
  void prepare(weir::PrepareContext& context) override { context.kernel("asks.glsl"); }
  void record(weir::RecordContext& context) override { context.launch({}, context.integer("undeclared")); }
};

class WithoutText final : public TestPass {
 public:
  void prepare(weir::PrepareContext&) override { throw NoText(); }
};

}  // namespace

WEIR_PLUGIN("throwing", weir::passEntry<Asks>("Asks"), weir::passEntry<WithoutText>("WithoutText"),
            weir::passEntry<Throwing<Where::Constructor, What::Input>>("ConstructorInput"),
            weir::passEntry<Throwing<Where::Constructor, What::Runtime>>("ConstructorRuntime"),
            weir::passEntry<Throwing<Where::Constructor, What::Other>>("ConstructorOther"),
            weir::passEntry<Throwing<Where::Constructor, What::Int>>("ConstructorInt"),
            weir::passEntry<Throwing<Where::Prepare, What::Input>>("PrepareInput"),
            weir::passEntry<Throwing<Where::Prepare, What::Runtime>>("PrepareRuntime"),
            weir::passEntry<Throwing<Where::Prepare, What::Other>>("PrepareOther"),
            weir::passEntry<Throwing<Where::Prepare, What::Int>>("PrepareInt"),
            weir::passEntry<Throwing<Where::Record, What::Input>>("RecordInput"),
            weir::passEntry<Throwing<Where::Record, What::Runtime>>("RecordRuntime"),
            weir::passEntry<Throwing<Where::Record, What::Other>>("RecordOther"),
            weir::passEntry<Throwing<Where::Record, What::Int>>("RecordInt"))
