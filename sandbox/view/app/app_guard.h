// App::guard, for the files that the class is spread over.
#pragma once

#include "view/app/app.h"

#include <exception>

namespace weir::view {

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
