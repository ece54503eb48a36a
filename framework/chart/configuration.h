// One configuration of a bench file, checked. Only this room includes it: JSON is in it.
#pragma once

#include <weir/chart/bench_file.h>
#include <weir/chart/place.h>

namespace weir::chart {

/// `folder`: where the bench file lies, canonical. Throws InputError as readBench does.
Configuration readConfiguration(const Place& place, const std::string& folder, std::vector<std::string>& warnings);

}  // namespace weir::chart
