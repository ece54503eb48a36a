// Independent pieces of work on all cores, with results and errors as if they had been done in order.
#pragma once

#include <cstddef>
#include <functional>

namespace weir {

/// Calls work(0) … work(count - 1), each once, on at most as many threads as the machine has cores (the caller is one
/// of them), and returns when all are done. If calls throw, the exception of the lowest number is thrown again: the one
/// that a plain loop would have ended in. Pieces with higher numbers may then have been left out.
void parallelFor(size_t count, const std::function<void(size_t)>& work);

}  // namespace weir
