// The two ways in which a command fails; everything else is a defect.
#pragma once

#include <stdexcept>
#include <string>

namespace weir {

/// What the user gave is wrong: JSON, glTF, a plugin, a flag. The program says so and exits with status 2.
/// The message names the place and, where one exists, the nearest valid name.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The input was fine and the work failed: device lost, disk full. Exit status 1.
class RuntimeError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace weir
