// App::guard and what else is shared by the files that the class is spread over.
#pragma once

#include "view/app/app.h"

#include <exception>

namespace weir::view {

/// One function of a case for each thing that a variant can be.
template <typename... Cases>
struct Each : Cases... {
  using Cases::operator()...;
};
// The guide is the language's own from C++20 on; clang 14, which lints, has not learnt it.
template <typename... Cases>
Each(Cases...) -> Each<Cases...>;

template <typename Work>
bool App::guard(const std::string& topic, Work work) {
  try {
    work();
    return true;
  } catch (const std::exception& error) {
    messages_.add(Severity::Error, topic, error.what());
    return false;
  }
}

}  // namespace weir::view
